; Kitchen domain shaped like a table of learned predicates/operators.
; 11 operators: four for lids, six for things, and open-drawer.
(define (domain kitchen)
  (:requirements :strips :typing :negative-preconditions)
  (:types thing drawer container cabinet lid cookware gripper - object)
  (:predicates
    (rel-thing-in-drawer ?t - thing ?d - drawer)
    (rel-thing-in-container ?t - thing ?k - container)
    (rel-thing-in-cookware ?t - thing ?c - cookware)
    (rel-lid-in-cabinet ?l - lid ?b - cabinet)
    (rel-lid-on-cookware ?l - lid ?c - cookware)
    (cookware-covered ?c - cookware)
    (drawer-open ?d - drawer)
    (gripper-in-thing ?t - thing)
    (gripper-in-lid ?l - lid)
    (gripper-open))
  (:action pick-lid-from-cabinet
    :parameters (?l - lid ?b - cabinet)
    :precondition (and (gripper-open) (rel-lid-in-cabinet ?l ?b))
    :effect (and (gripper-in-lid ?l) (not (gripper-open)) (not (rel-lid-in-cabinet ?l ?b))))
  (:action pick-lid-from-cookware
    :parameters (?l - lid ?c - cookware)
    :precondition (and (gripper-open) (rel-lid-on-cookware ?l ?c))
    :effect (and (gripper-in-lid ?l) (not (gripper-open)) (not (rel-lid-on-cookware ?l ?c)) (not (cookware-covered ?c))))
  (:action place-lid-to-cabinet
    :parameters (?l - lid ?b - cabinet)
    :precondition (and (gripper-in-lid ?l) (not (gripper-open)))
    :effect (and (gripper-open) (not (gripper-in-lid ?l)) (rel-lid-in-cabinet ?l ?b)))
  (:action place-lid-to-cookware
    :parameters (?l - lid ?c - cookware)
    :precondition (and (gripper-in-lid ?l) (not (gripper-open)) (not (cookware-covered ?c)))
    :effect (and (gripper-open) (not (gripper-in-lid ?l)) (rel-lid-on-cookware ?l ?c) (cookware-covered ?c)))
  (:action pick-thing-from-drawer
    :parameters (?t - thing ?d - drawer)
    :precondition (and (gripper-open) (drawer-open ?d) (rel-thing-in-drawer ?t ?d))
    :effect (and (gripper-in-thing ?t) (not (gripper-open)) (not (rel-thing-in-drawer ?t ?d))))
  (:action pick-thing-from-cookware
    :parameters (?t - thing ?c - cookware)
    :precondition (and (gripper-open) (not (cookware-covered ?c)) (rel-thing-in-cookware ?t ?c))
    :effect (and (gripper-in-thing ?t) (not (gripper-open)) (not (rel-thing-in-cookware ?t ?c))))
  (:action pick-thing-from-container
    :parameters (?t - thing ?k - container)
    :precondition (and (gripper-open) (rel-thing-in-container ?t ?k))
    :effect (and (gripper-in-thing ?t) (not (gripper-open)) (not (rel-thing-in-container ?t ?k))))
  (:action place-thing-to-drawer
    :parameters (?t - thing ?d - drawer)
    :precondition (and (gripper-in-thing ?t) (not (gripper-open)) (drawer-open ?d))
    :effect (and (gripper-open) (not (gripper-in-thing ?t)) (rel-thing-in-drawer ?t ?d)))
  (:action place-thing-to-cookware
    :parameters (?t - thing ?c - cookware)
    :precondition (and (gripper-in-thing ?t) (not (gripper-open)) (not (cookware-covered ?c)))
    :effect (and (gripper-open) (not (gripper-in-thing ?t)) (rel-thing-in-cookware ?t ?c)))
  (:action place-thing-to-container
    :parameters (?t - thing ?k - container)
    :precondition (and (gripper-in-thing ?t) (not (gripper-open)))
    :effect (and (gripper-open) (not (gripper-in-thing ?t)) (rel-thing-in-container ?t ?k)))
  (:action open-drawer
    :parameters (?d - drawer)
    :precondition (and (gripper-open) (not (drawer-open ?d)))
    :effect (drawer-open ?d))
)
