; learned
; costs are in 1/100 of the unit that they were learned in
(define (domain kitchen)
  (:requirements :strips :typing :negative-preconditions :universal-preconditions :action-costs)
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
  )
  (:functions (total-cost) - number)

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
      (not (gripper-open))
      (not (lid-on-pan ?lid ?pan))
      (increase (total-cost) 250)))

  (:action place-lid
    :parameters (?lid - lid ?pan - pan)
    :precondition (and
      (gripper-holds-lid ?lid)
      (forall (?other - lid) (not (lid-on-pan ?other ?pan))))
    :effect (and
      (gripper-open)
      (lid-on-pan ?lid ?pan)
      (not (gripper-holds-lid ?lid))
      (increase (total-cost) 300)))

  (:action pick-food
    :parameters (?food - food ?pan - pan)
    :precondition (and
      (food-in-pan ?food ?pan)
      (gripper-open)
      (forall (?other - lid) (not (lid-on-pan ?other ?pan))))
    :effect (and
      (gripper-holds-food ?food)
      (not (food-in-pan ?food ?pan))
      (not (gripper-open))
      (increase (total-cost) 100)))

  (:action place-food
    :parameters (?food - food ?pan - pan)
    :precondition (and
      (gripper-holds-food ?food)
      (forall (?other - lid) (not (lid-on-pan ?other ?pan))))
    :effect (and
      (food-in-pan ?food ?pan)
      (gripper-open)
      (not (gripper-holds-food ?food))
      (increase (total-cost) 125)))
)
