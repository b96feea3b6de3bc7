; Learned from demonstrations by symskill. What a predicate means geometrically stands above it.
; This file may be edited by hand; `symskill check` says what an edit means.
(define (domain kitchen)
  (:requirements :strips :typing)
  (:types
    ; fits a box of 30 x 38 x 50 cm
    cabinet - object
    ; fits a box of 72 x 180 x 4.0 cm
    counter - object
    ; fits a box of 1.8 x 38 x 50 cm
    door - object
    ; fits a box of 6.0 x 5.0 x 4.8 cm
    food - object
  )
  (:predicates
    ; built in: the fingers are told to open and are further apart than 6.0 cm; false again below 4.8 cm
    (gripper-open)
    ; gripper at x -4.8, y 14.4, z -13.7 cm in the door's frame, give or take 1.8 x 1.8 x 2.6 cm
    ; turned 132 deg about (-0.05, 1.00, 0.02), give or take 22 x 17 x 22 deg
    ; false again beyond 1.3 times that
    (gripper-at-door-to-close ?door - door)
    ; gripper at x 3.8, y 12.9, z -11.8 cm in the door's frame, give or take 3.2 x 2.4 x 3.5 cm
    ; turned 175 deg about (-0.08, -0.88, 0.46), give or take 16 x 31 x 25 deg
    ; false again beyond 1.3 times that
    (gripper-at-door-to-open ?door - door)
    ; gripper at x -5.3, y 14.5, z -12.3 cm in the door's frame, give or take 1.8 x 1.8 x 3.2 cm
    ; turned 131 deg about y, give or take 22 x 17 x 21 deg
    ; false again beyond 1.3 times that
    (gripper-holds-door-from-closed ?door - door)
    ; gripper at x 0.1, y 18.8, z -10.1 cm in the door's frame, give or take 2.4 x 2.4 x 5.5 cm
    ; turned 157 deg about (0.67, 0.72, -0.19), give or take 18 x 17 x 19 deg
    ; false again beyond 1.3 times that
    (gripper-holds-door-from-open ?door - door)
    ; gripper at x -0.1, y 0.0, z 0.1 cm in the food's frame, give or take 2.2 x 2.2 x 2.2 cm
    ; turned 168 deg about y, give or take 15 x 15 x 16 deg
    ; false again beyond 1.3 times that
    (gripper-holds-food ?food - food)
    ; door at x -30.3, y -7.7, z 0.0 cm in the cabinet's frame, give or take 1.3 x 1.4 x 1.1 cm
    ; turned 51 deg about z, give or take 2.7 x 2.7 x 4.4 deg
    ; false again beyond 1.3 times that
    (door-ajar ?door - door ?cabinet - cabinet)
    ; door at x -15.9, y 0.0, z 0.0 cm in the cabinet's frame, give or take 1.2 x 1.2 x 1.2 cm
    ; not turned, give or take 2.9 x 2.9 x 2.9 deg
    ; false again beyond 1.3 times that
    (door-closed ?door - door ?cabinet - cabinet)
    ; door at x -33.7, y -21.5, z 0.0 cm in the cabinet's frame, give or take 1.5 x 7.4 x 1.1 cm
    ; turned 95 deg about z, give or take 2.7 x 2.7 x 22 deg
    ; false again beyond 1.3 times that
    (door-open ?door - door ?cabinet - cabinet)
    ; food at x -7.8, y -0.3, z -21.2 cm in the cabinet's frame, give or take 5.2 x 8.5 x 1.2 cm
    ; turned 1 deg about -z, give or take 5.3 x 5.3 x 30 deg
    ; false again beyond 1.3 times that
    (food-in-cabinet ?food - food ?cabinet - cabinet)
    ; food at x -7.3, y -23.1, z 4.3 cm in the counter's frame, give or take 19 x 70 x 1.2 cm
    ; turned 8 deg about -z, give or take 3.6 x 3.6 x 24 deg
    ; false again beyond 1.3 times that
    (food-on-counter ?food - food ?counter - counter)
  )

  ; reach, learned from 10 episodes in 10 demonstrations; took 3.8 s on average, 4.6 s at most
  ; skill reach-door-ajar-to-close
  ; maintains (door-ajar ?door ?cabinet) (gripper-open)
  ; also true in every demonstration at the start: (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter)
  ; dropped effect: adds (gripper-holds-door-from-closed ?door): one contact at a time
  ; dropped precondition (food-on-counter ?food ?counter): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-2 ?counter): about nothing that the operator is about
  (:action reach-door-ajar-to-close
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (door-ajar ?door ?cabinet)
      (gripper-open))
    :effect (and
      (gripper-at-door-to-close ?door)
      (not (door-ajar ?door ?cabinet))))

  ; reach, learned from 10 episodes in 10 demonstrations; took 5.3 s on average, 6.8 s at most
  ; skill reach-door-ajar-to-open
  ; maintains (door-ajar ?door ?cabinet) (gripper-open)
  ; also true in every demonstration at the start: (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter)
  ; dropped precondition (food-on-counter ?food ?counter): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-2 ?counter): about nothing that the operator is about
  (:action reach-door-ajar-to-open
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (door-ajar ?door ?cabinet)
      (gripper-open))
    :effect (and
      (gripper-at-door-to-open ?door)
      (not (door-ajar ?door ?cabinet))))

  ; reach, learned from 10 episodes in 10 demonstrations; took 6.2 s on average, 8.8 s at most
  ; skill reach-door-closed
  ; maintains (door-closed ?door ?cabinet)
  ; also true in every demonstration at the start: (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter)
  ; dropped precondition (food-on-counter ?food ?counter): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-2 ?counter): about nothing that the operator is about
  (:action reach-door-closed
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (door-closed ?door ?cabinet)
      (gripper-open))
    :effect (and
      (gripper-holds-door-from-closed ?door)
      (not (door-closed ?door ?cabinet))
      (not (gripper-open))))

  ; reach, learned from 10 episodes in 10 demonstrations; took 9.0 s on average, 11.1 s at most
  ; skill reach-door-open
  ; maintains (door-open ?door ?cabinet)
  ; also true in every demonstration at the start: (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter)
  ; dropped precondition (food-on-counter ?food ?counter): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-2 ?counter): about nothing that the operator is about
  (:action reach-door-open
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (door-open ?door ?cabinet)
      (gripper-open))
    :effect (and
      (gripper-holds-door-from-open ?door)
      (not (door-open ?door ?cabinet))
      (not (gripper-open))))

  ; move, learned from 10 episodes in 10 demonstrations; took 4.4 s on average, 5.6 s at most
  ; skill close-door
  ; maintains (gripper-at-door-to-close ?door) (gripper-open)
  ; also true in every demonstration at the start: (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter) (gripper-holds-door-from-closed ?door)
  ; dropped precondition (food-on-counter ?food ?counter): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-2 ?counter): about nothing that the operator is about
  ; dropped precondition (gripper-holds-door-from-closed ?door): one contact at a time
  (:action close-door
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (gripper-at-door-to-close ?door)
      (gripper-open))
    :effect (and
      (door-closed ?door ?cabinet)
      (not (gripper-at-door-to-close ?door))))

  ; move, learned from 10 episodes in 10 demonstrations; took 3.5 s on average, 4.4 s at most
  ; skill open-door
  ; maintains (gripper-at-door-to-open ?door) (gripper-open)
  ; also true in every demonstration at the start: (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter)
  ; dropped precondition (food-on-counter ?food ?counter): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-2 ?counter): about nothing that the operator is about
  (:action open-door
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (gripper-at-door-to-open ?door)
      (gripper-open))
    :effect (and
      (door-open ?door ?cabinet)
      (not (gripper-at-door-to-open ?door))))

  ; move, learned from 10 episodes in 10 demonstrations; took 4.7 s on average, 5.9 s at most
  ; skill move-door-ajar-from-closed
  ; maintains (gripper-holds-door-from-closed ?door)
  ; also true in every demonstration at the start: (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter)
  ; dropped precondition (food-on-counter ?food ?counter): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-2 ?counter): about nothing that the operator is about
  (:action move-door-ajar-from-closed
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (gripper-holds-door-from-closed ?door))
    :effect (and
      (door-ajar ?door ?cabinet)
      (gripper-open)
      (not (gripper-holds-door-from-closed ?door))))

  ; move, learned from 10 episodes in 10 demonstrations; took 3.9 s on average, 4.9 s at most
  ; skill move-door-ajar-from-open
  ; maintains (gripper-holds-door-from-open ?door)
  ; also true in every demonstration at the start: (food-on-counter ?food ?counter) (food-on-counter ?food-2 ?counter)
  ; dropped precondition (food-on-counter ?food ?counter): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-2 ?counter): about nothing that the operator is about
  (:action move-door-ajar-from-open
    :parameters (?door - door ?cabinet - cabinet)
    :precondition (and
      (gripper-holds-door-from-open ?door))
    :effect (and
      (door-ajar ?door ?cabinet)
      (gripper-open)
      (not (gripper-holds-door-from-open ?door))))

  ; pick, learned from 10 episodes in 10 demonstrations; took 6.8 s on average, 9.8 s at most
  ; skill pick-food-from-cabinet
  ; maintains (door-open ?door ?cabinet) (food-in-cabinet ?food ?cabinet)
  ; also true in every demonstration at the start: (food-on-counter ?food-2 ?counter) (food-on-counter ?food-3 ?counter)
  ; dropped precondition (food-on-counter ?food-2 ?counter): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-3 ?counter): about nothing that the operator is about
  (:action pick-food-from-cabinet
    :parameters (?food - food ?cabinet - cabinet ?door - door)
    :precondition (and
      (door-open ?door ?cabinet)
      (food-in-cabinet ?food ?cabinet)
      (gripper-open))
    :effect (and
      (gripper-holds-food ?food)
      (not (food-in-cabinet ?food ?cabinet))
      (not (gripper-open))))

  ; pick, learned from 10 episodes in 10 demonstrations; took 5.7 s on average, 7.2 s at most
  ; skill pick-food-from-counter
  ; maintains (food-on-counter ?food ?counter)
  ; also true in every demonstration at the start: (door-open ?door ?cabinet) (food-on-counter ?food-2 ?counter) (food-on-counter ?food-3 ?counter)
  ; dropped precondition (door-open ?door ?cabinet): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-2 ?counter): that another food lies there enables nothing
  ; dropped precondition (food-on-counter ?food-3 ?counter): that another food lies there enables nothing
  (:action pick-food-from-counter
    :parameters (?food - food ?counter - counter)
    :precondition (and
      (food-on-counter ?food ?counter)
      (gripper-open))
    :effect (and
      (gripper-holds-food ?food)
      (not (food-on-counter ?food ?counter))
      (not (gripper-open))))

  ; place, learned from 10 episodes in 10 demonstrations; took 7.5 s on average, 9.2 s at most
  ; skill place-food-in-cabinet
  ; maintains (door-open ?door ?cabinet) (gripper-holds-food ?food)
  ; also true in every demonstration at the start: (food-on-counter ?food-2 ?counter) (food-on-counter ?food-3 ?counter)
  ; dropped precondition (food-on-counter ?food-2 ?counter): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-3 ?counter): about nothing that the operator is about
  (:action place-food-in-cabinet
    :parameters (?food - food ?cabinet - cabinet ?door - door)
    :precondition (and
      (door-open ?door ?cabinet)
      (gripper-holds-food ?food))
    :effect (and
      (food-in-cabinet ?food ?cabinet)
      (gripper-open)
      (not (gripper-holds-food ?food))))

  ; place, learned from 10 episodes in 10 demonstrations; took 7.6 s on average, 9.9 s at most
  ; skill place-food-on-counter
  ; maintains (gripper-holds-food ?food)
  ; also true in every demonstration at the start: (door-open ?door ?cabinet) (food-on-counter ?food-2 ?counter) (food-on-counter ?food-3 ?counter)
  ; dropped precondition (door-open ?door ?cabinet): about nothing that the operator is about
  ; dropped precondition (food-on-counter ?food-2 ?counter): that another food lies there enables nothing
  ; dropped precondition (food-on-counter ?food-3 ?counter): that another food lies there enables nothing
  (:action place-food-on-counter
    :parameters (?food - food ?counter - counter)
    :precondition (and
      (gripper-holds-food ?food))
    :effect (and
      (food-on-counter ?food ?counter)
      (gripper-open)
      (not (gripper-holds-food ?food))))
)
