; task OpenSingleDoor, seed 0
(define (problem opensingledoor-0)
  (:domain kitchen)
  (:objects
    cabinet-1 - cabinet
    door-1 - door
    counter-1 - counter
    cheese - food
    bread - food
    can - food
  )
  (:init
    (door-closed door-1 cabinet-1)
    (food-in-cabinet bread cabinet-1)
    (food-on-counter can counter-1)
    (food-on-counter cheese counter-1)
    (gripper-open)
  )
  (:goal (and
    (door-open door-1 cabinet-1)))
)
