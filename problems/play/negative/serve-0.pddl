; symskill 494f3b84e282: checksum of the other lines, by which an edited file is not overwritten unasked
; task PlayServe, seed 0
(define (problem playserve-0)
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
    (thing-on-drawer bread red-plate)
  )
  (:goal (and
    (thing-on-container block white-plate)))
)
