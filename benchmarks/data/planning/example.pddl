(define (problem kitchen-5-g12)
  (:domain kitchen)
  (:objects
    thing0 thing1 thing2 thing3 thing4 - thing
    drawer0 drawer1 - drawer
    container0 container1 - container
    cookware0 cookware1 - cookware
    cabinet0 - cabinet
    lid0 lid1 - lid
    gripper0 - gripper
  )
  (:init
    (gripper-open)
    (rel-thing-in-drawer thing0 drawer0)
    (rel-thing-in-container thing1 container0)
    (rel-thing-in-drawer thing2 drawer1)
    (rel-thing-in-container thing3 container1)
    (rel-thing-in-drawer thing4 drawer0)
    (rel-lid-on-cookware lid0 cookware0)
    (cookware-covered cookware0)
    (rel-lid-on-cookware lid1 cookware1)
    (cookware-covered cookware1)
  )
  (:goal (and
    (rel-thing-in-cookware thing1 cookware0)
    (rel-lid-on-cookware lid0 cookware0)
    (rel-thing-in-cookware thing0 cookware1)
    (rel-lid-in-cabinet lid1 cabinet0)
    (gripper-in-thing thing2)
  ))
)
