(define (problem plates-03)
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
    (thing-in-cookware banana pan)
  )
  (:goal (and
    (thing-in-container banana white-plate)
    (thing-in-cookware block pan)))
)
