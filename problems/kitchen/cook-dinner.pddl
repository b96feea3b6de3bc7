; symskill a9b63b17c3e7: checksum of the other lines, by which an edited file is not overwritten unasked
; task CookDinner, seed 0
; assumed (food-in-cookware can pan): can is in no known relation, this is the nearest (margin -0.02)
(define (problem cookdinner-0)
  (:domain kitchen)
  (:objects
    cabinet-1 - cabinet
    drawer-unit-1 - drawer-unit
    stove-1 - stove
    sink-1 - sink
    stove-2 - stove
    door-1 - door
    drawer-1 - drawer
    knob-1 - knob
    lever-1 - lever
    knob-2 - knob
    counter-1 - counter
    cheese - food
    bread - food
    can - food
    pan - cookware
    plate - container
    butter - food
    pan-2 - cookware
    plate-2 - container
  )
  (:init
    (door-closed door-1 cabinet-1)
    (drawer-closed drawer-1 drawer-unit-1)
    (food-in-cabinet cheese cabinet-1)
    (food-in-cookware can pan)
    (food-on-container butter plate-2)
    (food-on-counter bread counter-1)
    (gripper-open)
    (knob-unturned knob-1 stove-1)
    (knob-unturned knob-2 stove-2)
    (lever-unturned lever-1 sink-1)
  )
  (:goal (and
    (door-closed door-1 cabinet-1)
    (drawer-open drawer-1 drawer-unit-1)
    (food-in-cookware bread pan-2)
    (food-in-cookware butter pan)
    (food-on-container can plate)
    (food-on-counter cheese counter-1)
    (knob-turned knob-1 stove-1)
    (knob-turned knob-2 stove-2)
    (lever-turned lever-1 sink-1)))
)
