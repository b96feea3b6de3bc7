; symskill a4767645f9e6: checksum of the other lines, by which an edited file is not overwritten unasked
; task PlaySwap, seed 0
(define (problem playswap-0)
  (:domain play)
  (:objects
    stove-1 - stove
    dish-rack - cabinet
    counter-1 - counter
    pan - cookware
    lid-1 - lid
    red-plate - drawer
    white-plate - container
    block - thing
    bread - thing
  )
  (:init
    (gripper-open)
    (lid-on-cookware lid-1 pan)
    (thing-in-cookware block pan)
    (thing-on-container bread white-plate)
  )
  (:goal (and
    (lid-on-cookware lid-1 pan)
    (thing-in-cookware bread pan)
    (thing-on-drawer block red-plate)))
)
