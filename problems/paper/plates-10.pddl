(define (problem plates-10)
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
    (thing-in-container block white-plate)
    (thing-in-drawer banana red-plate)
  )
  (:goal (and
    (thing-in-cookware block pan)
    (thing-in-drawer banana red-plate)))
)
