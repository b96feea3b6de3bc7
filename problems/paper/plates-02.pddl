(define (problem plates-02)
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
    (thing-in-container block white-plate)
  )
  (:goal (and
    (thing-in-cookware banana pan)
    (thing-in-cookware block pan)))
)
