; symskill a137964961d6: checksum of the other lines, by which an edited file is not overwritten unasked
; task PlayServe, seed 1
(define (problem playserve-1)
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
    (= (total-cost) 0)
    (gripper-open)
    (lid-on-cookware lid-1 pan)
    (thing-in-cookware block pan)
    (thing-on-drawer bread red-plate)
  )
  (:goal (and
    (thing-on-container block white-plate)))
  (:metric minimize (total-cost))
)
