(define (problem plates-08)
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
    (lid-in-cabinet lid-1 dishrack)
    (thing-in-container banana white-plate)
    (thing-in-drawer block red-plate)
  )
  (:goal (and
    (thing-in-cookware banana pan)
    (thing-in-drawer block red-plate)))
)
