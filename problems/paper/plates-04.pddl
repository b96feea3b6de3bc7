(define (problem plates-04)
  (:domain paper)
  (:objects
    block - thing
    banana - thing
    lid-1 - lid
    dishrack - cabinet
    red-plate - drawer
    pan - cookware
    white-plate - container
  )
  (:init
    (gripper-open)
    (lid-in-cookware lid-1 pan)
    (thing-in-container banana white-plate)
    (thing-in-drawer block red-plate)
  )
  (:goal (and
    (thing-in-cookware banana pan)
    (thing-in-drawer block red-plate)))
)
