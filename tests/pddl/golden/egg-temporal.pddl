(define (problem egg)
  (:domain kitchen)
  (:objects
    egg - food
    lid-a - lid
    lid-b - lid
    pan-a - pan
    pan-b - pan
    pan-c - pan
    pan-d - pan
  )
  (:init
    (arm-free)
    (food-in-pan egg pan-a)
    (gripper-open)
    (lid-on-pan lid-a pan-a)
    (lid-on-pan lid-b pan-b)
  )
  (:goal (and
    (food-in-pan egg pan-b)
    (lid-on-pan lid-b pan-b)))
  (:metric minimize (total-time))
)
