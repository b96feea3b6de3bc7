; The paper's operators with the conditions that were coincidences of the play data left out, and with the reason in the place of
; its sign: a thing is out of reach while a lid is on the cookware, wherever the lid may be otherwise. Solves all 162 problems.
(define (domain paper)
  (:requirements :strips :typing :negative-preconditions :universal-preconditions)
  (:types
    thing - object
    lid - object
    cabinet - object
    drawer - object
    cookware - object
    container - object
  )
  (:predicates
    (gripper-in-lid ?lid - lid)
    (gripper-in-thing ?thing - thing)
    (gripper-open)
    (lid-in-cabinet ?lid - lid ?cabinet - cabinet)
    (lid-in-cookware ?lid - lid ?cookware - cookware)
    (thing-in-container ?thing - thing ?container - container)
    (thing-in-cookware ?thing - thing ?cookware - cookware)
    (thing-in-drawer ?thing - thing ?drawer - drawer)
  )

  ; maintains (gripper-open) (lid-in-cabinet ?lid ?cabinet)
  (:action pick-lid-from-cabinet
    :parameters (?lid - lid ?cabinet - cabinet)
    :precondition (and
      (gripper-open)
      (lid-in-cabinet ?lid ?cabinet))
    :effect (and
      (gripper-in-lid ?lid)
      (not (gripper-open))
      (not (lid-in-cabinet ?lid ?cabinet))))

  ; maintains (gripper-open) (lid-in-cookware ?lid ?cookware)
  (:action pick-lid-from-cookware
    :parameters (?lid - lid ?cookware - cookware)
    :precondition (and
      (gripper-open)
      (lid-in-cookware ?lid ?cookware))
    :effect (and
      (gripper-in-lid ?lid)
      (not (gripper-open))
      (not (lid-in-cookware ?lid ?cookware))))

  ; maintains (gripper-in-lid ?lid)
  (:action place-lid-to-cabinet
    :parameters (?lid - lid ?cabinet - cabinet)
    :precondition (and
      (gripper-in-lid ?lid))
    :effect (and
      (gripper-open)
      (lid-in-cabinet ?lid ?cabinet)
      (not (gripper-in-lid ?lid))))

  ; maintains (gripper-in-lid ?lid)
  (:action place-lid-to-cookware
    :parameters (?lid - lid ?cookware - cookware)
    :precondition (and
      (gripper-in-lid ?lid))
    :effect (and
      (gripper-open)
      (lid-in-cookware ?lid ?cookware)
      (not (gripper-in-lid ?lid))))

  ; maintains (gripper-open) (thing-in-drawer ?thing ?drawer)
  (:action pick-thing-from-drawer
    :parameters (?thing - thing ?drawer - drawer)
    :precondition (and
      (gripper-open)
      (thing-in-drawer ?thing ?drawer))
    :effect (and
      (gripper-in-thing ?thing)
      (not (gripper-open))
      (not (thing-in-drawer ?thing ?drawer))))

  ; maintains (gripper-open) (thing-in-cookware ?thing ?cookware)
  (:action pick-thing-from-cookware
    :parameters (?thing - thing ?cookware - cookware)
    :precondition (and
      (gripper-open)
      (thing-in-cookware ?thing ?cookware)
      (forall (?any - lid) (not (lid-in-cookware ?any ?cookware))))
    :effect (and
      (gripper-in-thing ?thing)
      (not (gripper-open))
      (not (thing-in-cookware ?thing ?cookware))))

  ; maintains (gripper-open) (thing-in-container ?thing ?container)
  (:action pick-thing-from-container
    :parameters (?thing - thing ?container - container)
    :precondition (and
      (gripper-open)
      (thing-in-container ?thing ?container))
    :effect (and
      (gripper-in-thing ?thing)
      (not (gripper-open))
      (not (thing-in-container ?thing ?container))))

  ; maintains (gripper-in-thing ?thing)
  (:action place-thing-to-drawer
    :parameters (?thing - thing ?drawer - drawer)
    :precondition (and
      (gripper-in-thing ?thing))
    :effect (and
      (gripper-open)
      (thing-in-drawer ?thing ?drawer)
      (not (gripper-in-thing ?thing))))

  ; maintains (gripper-in-thing ?thing)
  (:action place-thing-to-cookware
    :parameters (?thing - thing ?cookware - cookware)
    :precondition (and
      (gripper-in-thing ?thing)
      (forall (?any - lid) (not (lid-in-cookware ?any ?cookware))))
    :effect (and
      (gripper-open)
      (thing-in-cookware ?thing ?cookware)
      (not (gripper-in-thing ?thing))))

  ; maintains (gripper-in-thing ?thing)
  (:action place-thing-to-container
    :parameters (?thing - thing ?container - container)
    :precondition (and
      (gripper-in-thing ?thing))
    :effect (and
      (gripper-open)
      (thing-in-container ?thing ?container)
      (not (gripper-in-thing ?thing))))
)
