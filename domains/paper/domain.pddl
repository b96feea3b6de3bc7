; The operators that the SymSkill paper reports from play data, transcribed from its table word by word.
; Read literally: every type a variable of its own, so "thing in container" has to hold of the very thing that is picked from
; the drawer. This solves 50 of the 162 problems of two things and one lid (tests/planning/test_paper_table.py).
(define (domain paper)
  (:requirements :strips :typing)
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

  ; Op7; maintains (gripper-open) (lid-in-cabinet ?lid ?cabinet)
  (:action pick-lid-from-cabinet
    :parameters (?lid - lid ?cabinet - cabinet)
    :precondition (and
      (gripper-open)
      (lid-in-cabinet ?lid ?cabinet))
    :effect (and
      (gripper-in-lid ?lid)
      (not (gripper-open))
      (not (lid-in-cabinet ?lid ?cabinet))))

  ; Op11; maintains (gripper-open) (lid-in-cookware ?lid ?cookware)
  (:action pick-lid-from-cookware
    :parameters (?lid - lid ?cookware - cookware)
    :precondition (and
      (gripper-open)
      (lid-in-cookware ?lid ?cookware))
    :effect (and
      (gripper-in-lid ?lid)
      (not (gripper-open))
      (not (lid-in-cookware ?lid ?cookware))))

  ; Op1; maintains (gripper-in-lid ?lid)
  (:action place-lid-to-cabinet
    :parameters (?lid - lid ?cabinet - cabinet)
    :precondition (and
      (gripper-in-lid ?lid))
    :effect (and
      (gripper-open)
      (lid-in-cabinet ?lid ?cabinet)
      (not (gripper-in-lid ?lid))))

  ; Op8; maintains (gripper-in-lid ?lid)
  (:action place-lid-to-cookware
    :parameters (?lid - lid ?cookware - cookware)
    :precondition (and
      (gripper-in-lid ?lid))
    :effect (and
      (gripper-open)
      (lid-in-cookware ?lid ?cookware)
      (not (gripper-in-lid ?lid))))

  ; Op9; maintains (gripper-open) (thing-in-container ?thing ?container) (thing-in-drawer ?thing ?drawer)
  (:action pick-thing-from-drawer
    :parameters (?thing - thing ?container - container ?drawer - drawer)
    :precondition (and
      (gripper-open)
      (thing-in-container ?thing ?container)
      (thing-in-drawer ?thing ?drawer))
    :effect (and
      (gripper-in-thing ?thing)
      (not (gripper-open))
      (not (thing-in-drawer ?thing ?drawer))))

  ; Op5; maintains (gripper-open) (lid-in-cabinet ?lid ?cabinet) (thing-in-cookware ?thing ?cookware)
  (:action pick-thing-from-cookware
    :parameters (?lid - lid ?cabinet - cabinet ?thing - thing ?cookware - cookware)
    :precondition (and
      (gripper-open)
      (lid-in-cabinet ?lid ?cabinet)
      (thing-in-cookware ?thing ?cookware))
    :effect (and
      (gripper-in-thing ?thing)
      (not (gripper-open))
      (not (thing-in-cookware ?thing ?cookware))))

  ; Op10; maintains (gripper-open) (thing-in-container ?thing ?container)
  (:action pick-thing-from-container
    :parameters (?thing - thing ?container - container)
    :precondition (and
      (gripper-open)
      (thing-in-container ?thing ?container))
    :effect (and
      (gripper-in-thing ?thing)
      (not (gripper-open))
      (not (thing-in-container ?thing ?container))))

  ; Op4; maintains (gripper-in-thing ?thing) (thing-in-cookware ?thing ?cookware)
  (:action place-thing-to-drawer
    :parameters (?thing - thing ?cookware - cookware ?drawer - drawer)
    :precondition (and
      (gripper-in-thing ?thing)
      (thing-in-cookware ?thing ?cookware))
    :effect (and
      (gripper-open)
      (thing-in-drawer ?thing ?drawer)
      (not (gripper-in-thing ?thing))))

  ; Op3; maintains (gripper-in-thing ?thing) (lid-in-cabinet ?lid ?cabinet)
  (:action place-thing-to-cookware
    :parameters (?thing - thing ?lid - lid ?cabinet - cabinet ?cookware - cookware)
    :precondition (and
      (gripper-in-thing ?thing)
      (lid-in-cabinet ?lid ?cabinet))
    :effect (and
      (gripper-open)
      (thing-in-cookware ?thing ?cookware)
      (not (gripper-in-thing ?thing))))

  ; Op6; maintains (gripper-in-thing ?thing)
  (:action place-thing-to-container
    :parameters (?thing - thing ?container - container)
    :precondition (and
      (gripper-in-thing ?thing))
    :effect (and
      (gripper-open)
      (thing-in-container ?thing ?container)
      (not (gripper-in-thing ?thing))))
)
