; symskill 800f115becc9: checksum of the other lines, by which an edited file is not overwritten unasked
; Learned from demonstrations by symskill. What a predicate means geometrically stands above it.
; This file may be edited by hand; `symskill check` says what an edit means.
; costs are in 1/100 of the unit that they were learned in
(define (domain kitchen)
  (:requirements :strips :typing :action-costs)
  (:types
    ; fits a box of 30 x 38 x 50 cm
    cabinet - object
    ; fits a box of 15 x 15 x 1.5 cm
    container - object
    ; fits a box of 19 x 19 x 3.6 cm
    cookware - object
    ; fits a box of 72 x 180 x 4.0 cm
    counter - object
    ; fits a box of 1.8 x 38 x 50 cm
    door - object
    ; fits a box of 1.8 x 26 x 17 cm
    drawer - object
    ; fits a box of 32 x 27 x 20 cm
    drawer-unit - object
    ; fits a box of 6.0 x 5.0 x 4.8 cm
    food - object
    ; fits a box of 4.5 x 1.2 x 2.8 cm
    knob - object
    ; fits a box of 9.0 x 1.4 x 1.4 cm
    lever - object
    ; fits a box of 30 x 26 x 8.0 cm
    sink - object
    ; fits a box of 40 x 18 x 0.6 cm
    stove - object
  )
  (:predicates
    ; built in: the fingers are told to open and are further apart than 6.1 cm; false again below 4.9 cm
    (gripper-open)
    ; gripper at x -4.8, y 14.4, z -13.7 cm in the door's frame, give or take 1.8 x 1.9 x 2.6 cm
    ; turned 132 deg about (-0.05, 1.00, 0.02), give or take 21 x 17 x 21 deg
    ; false again beyond 1.3 times that
    (gripper-at-door-to-close ?door - door)
    ; gripper at x 3.7, y 12.9, z -11.8 cm in the door's frame, give or take 3.1 x 2.4 x 3.5 cm
    ; turned 175 deg about (-0.08, -0.88, 0.46), give or take 16 x 29 x 23 deg
    ; false again beyond 1.3 times that
    (gripper-at-door-to-open ?door - door)
    ; gripper at x -3.2, y 2.8, z 0.0 cm in the lever's frame, give or take 3.1 x 2.7 x 2.4 cm
    ; turned 164 deg about (-0.14, 0.99, 0.02), give or take 19 x 18 x 39 deg
    ; false again beyond 1.3 times that
    (gripper-at-lever-to-turn ?lever - lever)
    ; gripper at x -3.5, y -3.5, z 0.1 cm in the lever's frame, give or take 4.2 x 3.1 x 3.1 cm
    ; turned 165 deg about (-0.13, 0.99, 0.02), give or take 18 x 20 x 35 deg
    ; false again beyond 1.3 times that
    (gripper-at-lever-to-turn-back ?lever - lever)
    ; gripper at x -5.3, y 14.5, z -12.3 cm in the door's frame, give or take 1.8 x 1.8 x 3.2 cm
    ; turned 131 deg about y, give or take 22 x 17 x 20 deg
    ; false again beyond 1.3 times that
    (gripper-holds-door-from-closed ?door - door)
    ; gripper at x 0.1, y 18.8, z -10.1 cm in the door's frame, give or take 2.4 x 2.4 x 5.5 cm
    ; turned 157 deg about (0.67, 0.72, -0.19), give or take 17 x 17 x 19 deg
    ; false again beyond 1.3 times that
    (gripper-holds-door-from-open ?door - door)
    ; gripper at x -6.8, y -0.3, z 3.0 cm in the drawer's frame, give or take 1.8 x 3.9 x 1.8 cm
    ; turned 160 deg about (-0.70, 0.70, -0.18), give or take 18 x 16 x 16 deg
    ; false again beyond 1.3 times that
    (gripper-holds-drawer-to-close ?drawer - drawer)
    ; gripper at x -7.0, y -0.3, z 2.9 cm in the drawer's frame, give or take 1.8 x 3.9 x 1.8 cm
    ; turned 160 deg about (-0.70, 0.69, -0.18), give or take 17 x 16 x 16 deg
    ; false again beyond 1.3 times that
    (gripper-holds-drawer-to-open ?drawer - drawer)
    ; gripper at x -0.1, y 0.0, z 0.1 cm in the food's frame, give or take 2.2 x 2.1 x 2.2 cm
    ; turned 167 deg about y, give or take 14 x 15 x 15 deg
    ; false again beyond 1.3 times that
    (gripper-holds-food ?food - food)
    ; gripper at x -0.1, y 0.1, z -0.2 cm in the knob's frame, give or take 1.9 x 1.8 x 1.8 cm
    ; turned 174 deg about y, give or take 16 x 16 x 16 deg
    ; false again beyond 1.3 times that
    (gripper-holds-knob-to-turn ?knob - knob)
    ; gripper at x -0.1, y 0.1, z -0.2 cm in the knob's frame, give or take 1.9 x 1.8 x 1.8 cm
    ; turned 174 deg about y, give or take 16 x 16 x 16 deg
    ; false again beyond 1.3 times that
    (gripper-holds-knob-to-turn-back ?knob - knob)
    ; door at x -30.3, y -7.7, z 0.0 cm in the cabinet's frame, give or take 1.3 x 1.4 x 1.1 cm
    ; turned 51 deg about z, give or take 2.5 x 2.5 x 4.3 deg
    ; false again beyond 1.3 times that
    (door-ajar ?door - door ?cabinet - cabinet)
    ; door at x -15.9, y 0.0, z 0.0 cm in the cabinet's frame, give or take 1.1 x 1.1 x 1.1 cm
    ; not turned, give or take 2.4 x 2.4 x 2.4 deg
    ; false again beyond 1.3 times that
    (door-closed ?door - door ?cabinet - cabinet)
    ; door at x -33.7, y -21.5, z 0.0 cm in the cabinet's frame, give or take 1.5 x 7.3 x 1.1 cm
    ; turned 95 deg about z, give or take 2.5 x 2.5 x 22 deg
    ; false again beyond 1.3 times that
    (door-open ?door - door ?cabinet - cabinet)
    ; drawer at x -17.0, y 0.0, z 0.0 cm in the drawer-unit's frame, give or take 1.1 x 1.1 x 1.1 cm
    ; not turned, give or take 2.3 x 2.3 x 2.3 deg
    ; false again beyond 1.3 times that
    (drawer-closed ?drawer - drawer ?drawer-unit - drawer-unit)
    ; drawer at x -33.4, y 0.0, z 0.0 cm in the drawer-unit's frame, give or take 4.3 x 1.2 x 1.2 cm
    ; not turned, give or take 2.8 x 2.8 x 2.8 deg
    ; false again beyond 1.3 times that
    (drawer-open ?drawer - drawer ?drawer-unit - drawer-unit)
    ; food at x -7.7, y 0.0, z -21.2 cm in the cabinet's frame, give or take 5.6 x 9.1 x 1.3 cm
    ; turned 1 deg about -z, give or take 6.8 x 6.8 x 33 deg
    ; false again beyond 1.3 times that
    (food-in-cabinet ?food - food ?cabinet - cabinet)
    ; food at x -0.8, y 0.2, z 1.0 cm in the cookware's frame, give or take 5.3 x 4.0 x 1.2 cm
    ; turned 3 deg about -z, give or take 6.8 x 6.8 x 26 deg
    ; false again beyond 1.3 times that
    (food-in-cookware ?food - food ?cookware - cookware)
    ; food at x 0.2, y 0.1, z 2.0 cm in the container's frame, give or take 3.3 x 3.4 x 1.2 cm
    ; turned 3 deg about -z, give or take 6.8 x 6.8 x 23 deg
    ; false again beyond 1.3 times that
    (food-on-container ?food - food ?container - container)
    ; food at x -9.9, y -28.4, z 4.2 cm in the counter's frame, give or take 19 x 63 x 1.3 cm
    ; turned 8 deg about -z, give or take 6.8 x 6.8 x 26 deg
    ; false again beyond 1.3 times that
    (food-on-counter ?food - food ?counter - counter)
    ; knob at x -13.0, y 0.0, z 2.7 cm in the stove's frame, give or take 1.2 x 1.2 x 1.2 cm
    ; turned 92 deg about z, give or take 2.8 x 2.8 x 18 deg
    ; false again beyond 1.3 times that
    (knob-turned ?knob - knob ?stove - stove)
    ; knob at x -13.0, y 0.0, z 2.7 cm in the stove's frame, give or take 1.1 x 1.1 x 1.1 cm
    ; not turned, give or take 3.2 x 3.2 x 4.3 deg
    ; false again beyond 1.3 times that
    (knob-unturned ?knob - knob ?stove - stove)
    ; lever at x 3.7, y 20.8, z 7.8 cm in the sink's frame, give or take 2.0 x 1.3 x 1.2 cm
    ; turned 73 deg about -z, give or take 2.8 x 2.8 x 22 deg
    ; false again beyond 1.3 times that
    (lever-turned ?lever - lever ?sink - sink)
    ; lever at x 0.5, y 16.5, z 7.8 cm in the sink's frame, give or take 1.1 x 1.1 x 1.1 cm
    ; not turned, give or take 2.3 x 2.3 x 2.4 deg
    ; false again beyond 1.3 times that
    (lever-unturned ?lever - lever ?sink - sink)
  )
  (:functions (total-cost) - number)

  ; reach, learned from 10 episodes in 10 demonstrations; took 1.7 s on average, 2.1 s at most
  ; skill reach-door-ajar-to-close
  ; maintains (door-ajar ?door ?cabinet) (gripper-open)
  ; dropped precondition (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action reach-door-ajar-to-close
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (door-ajar ?door ?cabinet)
      (gripper-open))
    :effect (and
      (gripper-at-door-to-close ?door)
      (not (door-ajar ?door ?cabinet))
      (increase (total-cost) 170)))

  ; reach, learned from 10 episodes in 10 demonstrations; took 5.4 s on average, 6.7 s at most
  ; skill reach-door-ajar-to-open
  ; maintains (door-ajar ?door ?cabinet) (gripper-open)
  ; dropped precondition (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action reach-door-ajar-to-open
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (door-ajar ?door ?cabinet)
      (gripper-open))
    :effect (and
      (gripper-at-door-to-open ?door)
      (not (door-ajar ?door ?cabinet))
      (increase (total-cost) 540)))

  ; reach, learned from 10 episodes in 10 demonstrations; took 6.2 s on average, 8.7 s at most
  ; skill reach-door-closed
  ; maintains (door-closed ?door ?cabinet)
  ; dropped precondition (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action reach-door-closed
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (door-closed ?door ?cabinet)
      (gripper-open))
    :effect (and
      (gripper-holds-door-from-closed ?door)
      (not (door-closed ?door ?cabinet))
      (not (gripper-open))
      (increase (total-cost) 620)))

  ; reach, learned from 10 episodes in 10 demonstrations; took 9.0 s on average, 11.1 s at most
  ; skill reach-door-open
  ; maintains (door-open ?door ?cabinet)
  ; dropped precondition (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action reach-door-open
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (door-open ?door ?cabinet)
      (gripper-open))
    :effect (and
      (gripper-holds-door-from-open ?door)
      (not (door-open ?door ?cabinet))
      (not (gripper-open))
      (increase (total-cost) 900)))

  ; move, learned from 10 episodes in 10 demonstrations; took 4.4 s on average, 5.6 s at most
  ; skill close-door
  ; maintains (gripper-at-door-to-close ?door) (gripper-open)
  ; dropped precondition (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action close-door
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (gripper-at-door-to-close ?door)
      (gripper-open))
    :effect (and
      (door-closed ?door ?cabinet)
      (not (gripper-at-door-to-close ?door))
      (increase (total-cost) 440)))

  ; move, learned from 10 episodes in 10 demonstrations; took 3.5 s on average, 4.4 s at most
  ; skill open-door
  ; maintains (gripper-at-door-to-open ?door) (gripper-open)
  ; dropped precondition (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action open-door
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (gripper-at-door-to-open ?door)
      (gripper-open))
    :effect (and
      (door-open ?door ?cabinet)
      (not (gripper-at-door-to-open ?door))
      (increase (total-cost) 350)))

  ; move, learned from 10 episodes in 10 demonstrations; took 4.6 s on average, 5.8 s at most
  ; skill move-door-ajar-from-closed
  ; maintains (gripper-holds-door-from-closed ?door)
  ; dropped precondition (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action move-door-ajar-from-closed
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (gripper-holds-door-from-closed ?door))
    :effect (and
      (door-ajar ?door ?cabinet)
      (gripper-open)
      (not (gripper-holds-door-from-closed ?door))
      (increase (total-cost) 460)))

  ; move, learned from 10 episodes in 10 demonstrations; took 3.6 s on average, 4.5 s at most
  ; skill move-door-ajar-from-open
  ; maintains (gripper-holds-door-from-open ?door)
  ; dropped precondition (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action move-door-ajar-from-open
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (gripper-holds-door-from-open ?door))
    :effect (and
      (door-ajar ?door ?cabinet)
      (gripper-open)
      (not (gripper-holds-door-from-open ?door))
      (increase (total-cost) 360)))

  ; reach, learned from 10 episodes in 10 demonstrations; took 7.2 s on average, 9.8 s at most
  ; skill reach-drawer-open
  ; maintains (drawer-open ?drawer ?drawer-unit)
  ; dropped effect: adds (gripper-holds-drawer-to-open ?drawer): one contact at a time
  ; dropped precondition (door-closed ?door ?cabinet) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action reach-drawer-open
    :parameters (?drawer - drawer ?drawer-unit - drawer-unit)
    :precondition (and
      (drawer-open ?drawer ?drawer-unit)
      (gripper-open))
    :effect (and
      (gripper-holds-drawer-to-close ?drawer)
      (not (drawer-open ?drawer ?drawer-unit))
      (not (gripper-open))
      (increase (total-cost) 720)))

  ; reach, learned from 10 episodes in 10 demonstrations; took 6.8 s on average, 9.7 s at most
  ; skill reach-drawer-closed
  ; maintains (drawer-closed ?drawer ?drawer-unit)
  ; dropped effect: adds (gripper-holds-drawer-to-close ?drawer): one contact at a time
  ; dropped precondition (door-closed ?door ?cabinet) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action reach-drawer-closed
    :parameters (?drawer - drawer ?drawer-unit - drawer-unit)
    :precondition (and
      (drawer-closed ?drawer ?drawer-unit)
      (gripper-open))
    :effect (and
      (gripper-holds-drawer-to-open ?drawer)
      (not (drawer-closed ?drawer ?drawer-unit))
      (not (gripper-open))
      (increase (total-cost) 680)))

  ; move, learned from 10 episodes in 10 demonstrations; took 2.9 s on average, 3.4 s at most
  ; skill close-drawer
  ; maintains (gripper-holds-drawer-to-close ?drawer)
  ; dropped effect: deletes (gripper-holds-drawer-to-open ?drawer): one contact at a time
  ; dropped precondition (door-closed ?door ?cabinet) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  ; dropped precondition (gripper-holds-drawer-to-open ?drawer): one contact at a time
  (:action close-drawer
    :parameters (?drawer - drawer ?drawer-unit - drawer-unit)
    :precondition (and
      (gripper-holds-drawer-to-close ?drawer))
    :effect (and
      (drawer-closed ?drawer ?drawer-unit)
      (gripper-open)
      (not (gripper-holds-drawer-to-close ?drawer))
      (increase (total-cost) 290)))

  ; move, learned from 10 episodes in 10 demonstrations; took 3.1 s on average, 3.7 s at most
  ; skill open-drawer
  ; maintains (gripper-holds-drawer-to-open ?drawer)
  ; dropped effect: deletes (gripper-holds-drawer-to-close ?drawer): one contact at a time
  ; dropped precondition (door-closed ?door ?cabinet) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  ; dropped precondition (gripper-holds-drawer-to-close ?drawer): one contact at a time
  (:action open-drawer
    :parameters (?drawer - drawer ?drawer-unit - drawer-unit)
    :precondition (and
      (gripper-holds-drawer-to-open ?drawer))
    :effect (and
      (drawer-open ?drawer ?drawer-unit)
      (gripper-open)
      (not (gripper-holds-drawer-to-open ?drawer))
      (increase (total-cost) 310)))

  ; pick, learned from 10 episodes in 10 demonstrations; took 6.9 s on average, 9.8 s at most
  ; skill pick-food-from-cabinet
  ; maintains (door-open ?door ?cabinet) (food-in-cabinet ?food ?cabinet)
  ; dropped precondition (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food-2 ?counter) (food-on-counter ?food-3 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action pick-food-from-cabinet
    :parameters (?food - food ?cabinet - cabinet ?door - door)
    :precondition (and
      (door-open ?door ?cabinet)
      (food-in-cabinet ?food ?cabinet)
      (gripper-open))
    :effect (and
      (gripper-holds-food ?food)
      (not (food-in-cabinet ?food ?cabinet))
      (not (gripper-open))
      (increase (total-cost) 690)))

  ; pick, learned from 10 episodes in 10 demonstrations; took 5.8 s on average, 7.5 s at most
  ; skill pick-food-from-cookware
  ; maintains (food-in-cookware ?food ?cookware)
  ; dropped precondition (door-closed ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food-2 ?counter) (food-on-counter ?food-3 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action pick-food-from-cookware
    :parameters (?food - food ?cookware - cookware)
    :precondition (and
      (food-in-cookware ?food ?cookware)
      (gripper-open))
    :effect (and
      (gripper-holds-food ?food)
      (not (food-in-cookware ?food ?cookware))
      (not (gripper-open))
      (increase (total-cost) 580)))

  ; pick, learned from 10 episodes in 10 demonstrations; took 5.7 s on average, 7.0 s at most
  ; skill pick-food-from-container
  ; maintains (food-on-container ?food ?container)
  ; dropped precondition (door-closed ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food-2 ?counter) (food-on-counter ?food-3 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action pick-food-from-container
    :parameters (?food - food ?container - container)
    :precondition (and
      (food-on-container ?food ?container)
      (gripper-open))
    :effect (and
      (gripper-holds-food ?food)
      (not (food-on-container ?food ?container))
      (not (gripper-open))
      (increase (total-cost) 570)))

  ; pick, learned from 10 episodes in 10 demonstrations; took 5.7 s on average, 7.2 s at most
  ; skill pick-food-from-counter
  ; maintains (food-on-counter ?food ?counter)
  ; dropped precondition (door-open ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-2 ?counter) (food-on-counter ?food-3 ?counter): that another food lies there enables nothing
  (:action pick-food-from-counter
    :parameters (?food - food ?counter - counter)
    :precondition (and
      (food-on-counter ?food ?counter)
      (gripper-open))
    :effect (and
      (gripper-holds-food ?food)
      (not (food-on-counter ?food ?counter))
      (not (gripper-open))
      (increase (total-cost) 570)))

  ; place, learned from 10 episodes in 10 demonstrations; took 7.4 s on average, 9.0 s at most
  ; skill place-food-in-cabinet
  ; maintains (door-open ?door ?cabinet) (gripper-holds-food ?food)
  ; dropped precondition (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food-2 ?counter) (food-on-counter ?food-3 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action place-food-in-cabinet
    :parameters (?food - food ?cabinet - cabinet ?door - door)
    :precondition (and
      (door-open ?door ?cabinet)
      (gripper-holds-food ?food))
    :effect (and
      (food-in-cabinet ?food ?cabinet)
      (gripper-open)
      (not (gripper-holds-food ?food))
      (increase (total-cost) 740)))

  ; place, learned from 10 episodes in 10 demonstrations; took 5.9 s on average, 7.4 s at most
  ; skill place-food-in-cookware
  ; maintains (gripper-holds-food ?food)
  ; dropped precondition (door-closed ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food-2 ?counter) (food-on-counter ?food-3 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action place-food-in-cookware
    :parameters (?food - food ?cookware - cookware)
    :precondition (and
      (gripper-holds-food ?food))
    :effect (and
      (food-in-cookware ?food ?cookware)
      (gripper-open)
      (not (gripper-holds-food ?food))
      (increase (total-cost) 590)))

  ; place, learned from 10 episodes in 10 demonstrations; took 6.1 s on average, 7.7 s at most
  ; skill place-food-on-container
  ; maintains (gripper-holds-food ?food)
  ; dropped precondition (door-closed ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food-2 ?counter) (food-on-counter ?food-3 ?counter) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action place-food-on-container
    :parameters (?food - food ?container - container)
    :precondition (and
      (gripper-holds-food ?food))
    :effect (and
      (food-on-container ?food ?container)
      (gripper-open)
      (not (gripper-holds-food ?food))
      (increase (total-cost) 610)))

  ; place, learned from 10 episodes in 10 demonstrations; took 7.5 s on average, 9.7 s at most
  ; skill place-food-on-counter
  ; maintains (gripper-holds-food ?food)
  ; dropped precondition (door-open ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (knob-unturned ?knob ?stove) (lever-unturned ?lever ?sink): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-2 ?counter) (food-on-counter ?food-3 ?counter): that another food lies there enables nothing
  (:action place-food-on-counter
    :parameters (?food - food ?counter - counter)
    :precondition (and
      (gripper-holds-food ?food))
    :effect (and
      (food-on-counter ?food ?counter)
      (gripper-open)
      (not (gripper-holds-food ?food))
      (increase (total-cost) 750)))

  ; reach, learned from 10 episodes in 10 demonstrations; took 5.4 s on average, 7.7 s at most
  ; skill reach-knob-unturned
  ; maintains (knob-unturned ?knob ?stove)
  ; dropped effect: adds (gripper-holds-knob-to-turn-back ?knob): one contact at a time
  ; dropped precondition (door-closed ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action reach-knob-unturned
    :parameters (?knob - knob ?stove - stove)
    :precondition (and
      (gripper-open)
      (knob-unturned ?knob ?stove))
    :effect (and
      (gripper-holds-knob-to-turn ?knob)
      (not (gripper-open))
      (not (knob-unturned ?knob ?stove))
      (increase (total-cost) 540)))

  ; reach, learned from 10 episodes in 10 demonstrations; took 5.8 s on average, 8.1 s at most
  ; skill reach-knob-turned
  ; maintains (knob-turned ?knob ?stove)
  ; dropped effect: adds (gripper-holds-knob-to-turn ?knob): one contact at a time
  ; dropped precondition (door-closed ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (lever-unturned ?lever ?sink): about nothing that the operator is about
  (:action reach-knob-turned
    :parameters (?knob - knob ?stove - stove)
    :precondition (and
      (gripper-open)
      (knob-turned ?knob ?stove))
    :effect (and
      (gripper-holds-knob-to-turn-back ?knob)
      (not (gripper-open))
      (not (knob-turned ?knob ?stove))
      (increase (total-cost) 580)))

  ; move, learned from 10 episodes in 10 demonstrations; took 3.6 s on average, 4.1 s at most
  ; skill turn-knob
  ; maintains (gripper-holds-knob-to-turn ?knob)
  ; dropped effect: deletes (gripper-holds-knob-to-turn-back ?knob): one contact at a time
  ; dropped precondition (door-closed ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (lever-unturned ?lever ?sink): about nothing that the operator is about
  ; dropped precondition (gripper-holds-knob-to-turn-back ?knob): one contact at a time
  (:action turn-knob
    :parameters (?knob - knob ?stove - stove)
    :precondition (and
      (gripper-holds-knob-to-turn ?knob))
    :effect (and
      (gripper-open)
      (knob-turned ?knob ?stove)
      (not (gripper-holds-knob-to-turn ?knob))
      (increase (total-cost) 360)))

  ; move, learned from 10 episodes in 10 demonstrations; took 3.2 s on average, 3.9 s at most
  ; skill turn-knob-back
  ; maintains (gripper-holds-knob-to-turn-back ?knob)
  ; dropped effect: deletes (gripper-holds-knob-to-turn ?knob): one contact at a time
  ; dropped precondition (door-closed ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (lever-unturned ?lever ?sink): about nothing that the operator is about
  ; dropped precondition (gripper-holds-knob-to-turn ?knob): one contact at a time
  (:action turn-knob-back
    :parameters (?knob - knob ?stove - stove)
    :precondition (and
      (gripper-holds-knob-to-turn-back ?knob))
    :effect (and
      (gripper-open)
      (knob-unturned ?knob ?stove)
      (not (gripper-holds-knob-to-turn-back ?knob))
      (increase (total-cost) 320)))

  ; reach, learned from 10 episodes in 10 demonstrations; took 6.4 s on average, 9.4 s at most
  ; skill reach-lever-unturned
  ; maintains (gripper-open) (lever-unturned ?lever ?sink)
  ; dropped precondition (door-closed ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove): about nothing that the operator is about
  (:action reach-lever-unturned
    :parameters (?lever - lever ?sink - sink)
    :precondition (and
      (gripper-open)
      (lever-unturned ?lever ?sink))
    :effect (and
      (gripper-at-lever-to-turn ?lever)
      (not (lever-unturned ?lever ?sink))
      (increase (total-cost) 640)))

  ; reach, learned from 10 episodes in 10 demonstrations; took 6.5 s on average, 9.2 s at most
  ; skill reach-lever-turned
  ; maintains (gripper-open) (lever-turned ?lever ?sink)
  ; dropped precondition (door-closed ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove): about nothing that the operator is about
  (:action reach-lever-turned
    :parameters (?lever - lever ?sink - sink)
    :precondition (and
      (gripper-open)
      (lever-turned ?lever ?sink))
    :effect (and
      (gripper-at-lever-to-turn-back ?lever)
      (not (lever-turned ?lever ?sink))
      (increase (total-cost) 650)))

  ; move, learned from 10 episodes in 10 demonstrations; took 1.9 s on average, 2.3 s at most
  ; skill turn-lever
  ; maintains (gripper-at-lever-to-turn ?lever) (gripper-open)
  ; dropped precondition (door-closed ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove): about nothing that the operator is about
  (:action turn-lever
    :parameters (?lever - lever ?sink - sink)
    :precondition (and
      (gripper-at-lever-to-turn ?lever)
      (gripper-open))
    :effect (and
      (lever-turned ?lever ?sink)
      (not (gripper-at-lever-to-turn ?lever))
      (increase (total-cost) 190)))

  ; move, learned from 10 episodes in 10 demonstrations; took 2.6 s on average, 3.8 s at most
  ; skill turn-lever-back
  ; maintains (gripper-at-lever-to-turn-back ?lever) (gripper-open)
  ; dropped precondition (door-closed ?door ?cabinet) (drawer-closed ?drawer ?drawer-unit) (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (knob-unturned ?knob ?stove): about nothing that the operator is about
  (:action turn-lever-back
    :parameters (?lever - lever ?sink - sink)
    :precondition (and
      (gripper-at-lever-to-turn-back ?lever)
      (gripper-open))
    :effect (and
      (lever-unturned ?lever ?sink)
      (not (gripper-at-lever-to-turn-back ?lever))
      (increase (total-cost) 260)))
)
