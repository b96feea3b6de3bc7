; learned
(define (domain kitchen)
  (:requirements :strips :typing)
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
    ; where lid-on-pan is false for every lid
    (none-lid-on-pan ?pan - pan)
  )

  ; learned from 5 episodes
  ; maintain: (gripper-open)
  ; (:action evil)
  (:action pick-lid
    :parameters (?lid - lid ?pan - pan)
    :precondition (and
      (gripper-open)
      (lid-on-pan ?lid ?pan))
    :effect (and
      (gripper-holds-lid ?lid)
      (none-lid-on-pan ?pan)
      (not (gripper-open))
      (not (lid-on-pan ?lid ?pan))))

  (:action place-lid
    :parameters (?lid - lid ?pan - pan)
    :precondition (and
      (gripper-holds-lid ?lid)
      (none-lid-on-pan ?pan))
    :effect (and
      (gripper-open)
      (lid-on-pan ?lid ?pan)
      (not (gripper-holds-lid ?lid))
      (not (none-lid-on-pan ?pan))))

  (:action pick-food
    :parameters (?food - food ?pan - pan)
    :precondition (and
      (food-in-pan ?food ?pan)
      (gripper-open)
      (none-lid-on-pan ?pan))
    :effect (and
      (gripper-holds-food ?food)
      (not (food-in-pan ?food ?pan))
      (not (gripper-open))))

  (:action place-food
    :parameters (?food - food ?pan - pan)
    :precondition (and
      (gripper-holds-food ?food)
      (none-lid-on-pan ?pan))
    :effect (and
      (food-in-pan ?food ?pan)
      (gripper-open)
      (not (gripper-holds-food ?food))))
)
