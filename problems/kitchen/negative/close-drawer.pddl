; symskill bc1d69291445: checksum of the other lines, by which an edited file is not overwritten unasked
; task CloseDrawer, seed 0
(define (problem closedrawer-0)
  (:domain kitchen)
  (:objects
    cabinet-1 - cabinet
    drawer-unit-1 - drawer-unit
    stove-1 - stove
    sink-1 - sink
    door-1 - door
    drawer-1 - drawer
    knob-1 - knob
    lever-1 - lever
    counter-1 - counter
    cheese - food
    bread - food
    can - food
    pan - cookware
    plate - container
  )
  (:init
    (door-closed door-1 cabinet-1)
    (drawer-open drawer-1 drawer-unit-1)
    (food-in-cabinet bread cabinet-1)
    (food-on-counter can counter-1)
    (food-on-counter cheese counter-1)
    (gripper-open)
    (knob-unturned knob-1 stove-1)
    (lever-unturned lever-1 sink-1)
  )
  (:goal (and
    (drawer-closed drawer-1 drawer-unit-1)))
)
