; symskill 649c8181d6de: checksum of the other lines, by which an edited file is not overwritten unasked
; task PlayCookAndCover, seed 2
(define (problem playcookandcover-2)
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
    (arm-free)
    (gripper-open)
    (lid-on-cookware lid-1 pan)
    (thing-on-container bread white-plate)
    (thing-on-drawer block red-plate)
  )
  (:goal (and
    (lid-on-cookware lid-1 pan)
    (thing-in-cookware bread pan)))
  (:metric minimize (total-time))
)
