begin_version
3
end_version
begin_metric
1
end_metric
7
begin_variable
var0
-1
3
Atom drawer-closed(drawer-1, drawer-unit-1)
Atom drawer-open(drawer-1, drawer-unit-1)
<none of those>
end_variable
begin_variable
var1
-1
3
Atom knob-turned(knob-1, stove-1)
Atom knob-unturned(knob-1, stove-1)
<none of those>
end_variable
begin_variable
var2
-1
3
Atom food-in-cabinet(bread, cabinet-1)
Atom food-on-counter(bread, counter-1)
<none of those>
end_variable
begin_variable
var3
-1
3
Atom food-in-cabinet(cheese, cabinet-1)
Atom food-on-counter(cheese, counter-1)
<none of those>
end_variable
begin_variable
var4
-1
6
Atom door-ajar(door-1, cabinet-1)
Atom door-closed(door-1, cabinet-1)
Atom door-open(door-1, cabinet-1)
Atom gripper-at-door-to-close(door-1)
Atom gripper-at-door-to-open(door-1)
<none of those>
end_variable
begin_variable
var5
-1
10
Atom gripper-holds-door-from-closed(door-1)
Atom gripper-holds-door-from-open(door-1)
Atom gripper-holds-drawer-to-close(drawer-1)
Atom gripper-holds-drawer-to-open(drawer-1)
Atom gripper-holds-food(bread)
Atom gripper-holds-food(can)
Atom gripper-holds-food(cheese)
Atom gripper-holds-knob-to-turn(knob-1)
Atom gripper-holds-knob-to-turn-back(knob-1)
Atom gripper-open()
end_variable
begin_variable
var6
-1
3
Atom food-in-cabinet(can, cabinet-1)
Atom food-on-counter(can, counter-1)
<none of those>
end_variable
6
begin_mutex_group
7
4 0
4 1
4 2
4 3
4 4
5 0
5 1
end_mutex_group
begin_mutex_group
4
0 0
0 1
5 2
5 3
end_mutex_group
begin_mutex_group
3
2 0
2 1
5 4
end_mutex_group
begin_mutex_group
3
6 0
6 1
5 5
end_mutex_group
begin_mutex_group
3
3 0
3 1
5 6
end_mutex_group
begin_mutex_group
4
5 7
5 8
1 0
1 1
end_mutex_group
begin_state
0
1
1
1
2
9
0
end_state
begin_goal
1
6 1
end_goal
28
begin_operator
close-door door-1 cabinet-1
1
5 9
1
0 4 3 1
440
end_operator
begin_operator
close-drawer drawer-1 drawer-unit-1
0
2
0 0 -1 0
0 5 2 9
290
end_operator
begin_operator
move-door-ajar-from-closed door-1 cabinet-1
0
2
0 4 -1 0
0 5 0 9
470
end_operator
begin_operator
move-door-ajar-from-open door-1 cabinet-1
0
2
0 4 -1 0
0 5 1 9
390
end_operator
begin_operator
open-door door-1 cabinet-1
1
5 9
1
0 4 4 2
350
end_operator
begin_operator
open-drawer drawer-1 drawer-unit-1
0
2
0 0 -1 1
0 5 3 9
320
end_operator
begin_operator
pick-food-from-cabinet bread cabinet-1 door-1
1
4 2
2
0 2 0 2
0 5 9 4
680
end_operator
begin_operator
pick-food-from-cabinet can cabinet-1 door-1
1
4 2
2
0 6 0 2
0 5 9 5
680
end_operator
begin_operator
pick-food-from-cabinet cheese cabinet-1 door-1
1
4 2
2
0 3 0 2
0 5 9 6
680
end_operator
begin_operator
pick-food-from-counter bread counter-1
0
2
0 2 1 2
0 5 9 4
570
end_operator
begin_operator
pick-food-from-counter can counter-1
0
2
0 6 1 2
0 5 9 5
570
end_operator
begin_operator
pick-food-from-counter cheese counter-1
0
2
0 3 1 2
0 5 9 6
570
end_operator
begin_operator
place-food-in-cabinet bread cabinet-1 door-1
1
4 2
2
0 2 -1 0
0 5 4 9
750
end_operator
begin_operator
place-food-in-cabinet can cabinet-1 door-1
1
4 2
2
0 6 -1 0
0 5 5 9
750
end_operator
begin_operator
place-food-in-cabinet cheese cabinet-1 door-1
1
4 2
2
0 3 -1 0
0 5 6 9
750
end_operator
begin_operator
place-food-on-counter bread counter-1
0
2
0 2 -1 1
0 5 4 9
760
end_operator
begin_operator
place-food-on-counter can counter-1
0
2
0 6 -1 1
0 5 5 9
760
end_operator
begin_operator
place-food-on-counter cheese counter-1
0
2
0 3 -1 1
0 5 6 9
760
end_operator
begin_operator
reach-door-ajar-to-close door-1 cabinet-1
1
5 9
1
0 4 0 3
380
end_operator
begin_operator
reach-door-ajar-to-open door-1 cabinet-1
1
5 9
1
0 4 0 4
530
end_operator
begin_operator
reach-door-closed door-1 cabinet-1
0
2
0 4 1 5
0 5 9 0
620
end_operator
begin_operator
reach-door-open door-1 cabinet-1
0
2
0 4 2 5
0 5 9 1
900
end_operator
begin_operator
reach-drawer-closed drawer-1 drawer-unit-1
0
2
0 0 0 2
0 5 9 3
680
end_operator
begin_operator
reach-drawer-open drawer-1 drawer-unit-1
0
2
0 0 1 2
0 5 9 2
720
end_operator
begin_operator
reach-knob-turned knob-1 stove-1
0
2
0 5 9 8
0 1 0 2
570
end_operator
begin_operator
reach-knob-unturned knob-1 stove-1
0
2
0 5 9 7
0 1 1 2
530
end_operator
begin_operator
turn-knob knob-1 stove-1
0
2
0 5 7 9
0 1 -1 0
370
end_operator
begin_operator
turn-knob-back knob-1 stove-1
0
2
0 5 8 9
0 1 -1 1
320
end_operator
0
