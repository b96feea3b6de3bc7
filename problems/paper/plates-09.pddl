(define (problem plates-09)
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
    (thing-in-cookware banana pan)
    (thing-in-cookware block pan)
  )
  (:goal (and
    (thing-in-container block white-plate)
    (thing-in-cookware banana pan)))
)
