; learned
(define (domain kitchen)
  (:requirements :strips :typing :negative-preconditions :universal-preconditions :durative-actions)
  (:types
    food - object
    ; covers pans
    lid - object
    pan - object
  )
  (:predicates
    (food-in-pan ?food - food ?pan - pan)
    (gripper-holds-food ?food - food)
    (gripper-holds-lid ?lid - lid)
    (gripper-open)
    ; offset 0.0 0.1 3.2 cm, within 1.1 cm
    (lid-on-pan ?lid - lid ?pan - pan)
    ; the arm does one thing at a time
    (arm-free)
  )

  ; learned from 5 episodes
  ; maintain: (gripper-open)
  ; (:action evil)
  (:durative-action pick-lid
    :parameters (?lid - lid ?pan - pan)
    :duration (= ?duration 2.5)
    :condition (and
      (at start (arm-free))
      (at start (gripper-open))
      (at start (lid-on-pan ?lid ?pan)))
    :effect (and
      (at start (not (arm-free)))
      (at end (arm-free))
      (at end (gripper-holds-lid ?lid))
      (at end (not (gripper-open)))
      (at end (not (lid-on-pan ?lid ?pan)))))

  (:durative-action place-lid
    :parameters (?lid - lid ?pan - pan)
    :duration (= ?duration 3)
    :condition (and
      (at start (arm-free))
      (at start (gripper-holds-lid ?lid))
      (at start (forall (?other - lid) (not (lid-on-pan ?other ?pan)))))
    :effect (and
      (at start (not (arm-free)))
      (at end (arm-free))
      (at end (gripper-open))
      (at end (lid-on-pan ?lid ?pan))
      (at end (not (gripper-holds-lid ?lid)))))

  (:durative-action pick-food
    :parameters (?food - food ?pan - pan)
    :duration (= ?duration 1)
    :condition (and
      (at start (arm-free))
      (at start (food-in-pan ?food ?pan))
      (at start (gripper-open))
      (at start (forall (?other - lid) (not (lid-on-pan ?other ?pan)))))
    :effect (and
      (at start (not (arm-free)))
      (at end (arm-free))
      (at end (gripper-holds-food ?food))
      (at end (not (food-in-pan ?food ?pan)))
      (at end (not (gripper-open)))))

  (:durative-action place-food
    :parameters (?food - food ?pan - pan)
    :duration (= ?duration 1.25)
    :condition (and
      (at start (arm-free))
      (at start (gripper-holds-food ?food))
      (at start (forall (?other - lid) (not (lid-on-pan ?other ?pan)))))
    :effect (and
      (at start (not (arm-free)))
      (at end (arm-free))
      (at end (food-in-pan ?food ?pan))
      (at end (gripper-open))
      (at end (not (gripper-holds-food ?food)))))
)
