begin_version
3
end_version
begin_metric
0
end_metric
5
begin_variable
var0
0
2
Atom new-axiom@0(pan)
NegatedAtom new-axiom@0(pan)
end_variable
begin_variable
var1
-1
3
Atom gripper-in-lid(lid-1)
Atom lid-in-cabinet(lid-1, dishrack)
Atom lid-in-cookware(lid-1, pan)
end_variable
begin_variable
var2
-1
2
Atom gripper-open()
NegatedAtom gripper-open()
end_variable
begin_variable
var3
-1
4
Atom gripper-in-thing(banana)
Atom thing-in-container(banana, white-plate)
Atom thing-in-cookware(banana, pan)
Atom thing-in-drawer(banana, red-plate)
end_variable
begin_variable
var4
-1
4
Atom gripper-in-thing(block)
Atom thing-in-container(block, white-plate)
Atom thing-in-cookware(block, pan)
Atom thing-in-drawer(block, red-plate)
end_variable
1
begin_mutex_group
4
1 0
3 0
4 0
2 0
end_mutex_group
begin_state
1
2
0
2
2
end_state
begin_goal
2
3 1
4 1
end_goal
16
begin_operator
pick-lid-from-cabinet lid-1 dishrack
0
2
0 1 1 0
0 2 0 1
1
end_operator
begin_operator
pick-lid-from-cookware lid-1 pan
0
2
0 1 2 0
0 2 0 1
1
end_operator
begin_operator
pick-thing-from-container banana white-plate
0
2
0 3 1 0
0 2 0 1
1
end_operator
begin_operator
pick-thing-from-container block white-plate
0
2
0 4 1 0
0 2 0 1
1
end_operator
begin_operator
pick-thing-from-cookware banana pan
1
0 1
2
0 3 2 0
0 2 0 1
1
end_operator
begin_operator
pick-thing-from-cookware block pan
1
0 1
2
0 4 2 0
0 2 0 1
1
end_operator
begin_operator
pick-thing-from-drawer banana red-plate
0
2
0 3 3 0
0 2 0 1
1
end_operator
begin_operator
pick-thing-from-drawer block red-plate
0
2
0 4 3 0
0 2 0 1
1
end_operator
begin_operator
place-lid-to-cabinet lid-1 dishrack
0
2
0 1 0 1
0 2 -1 0
1
end_operator
begin_operator
place-lid-to-cookware lid-1 pan
0
2
0 1 0 2
0 2 -1 0
1
end_operator
begin_operator
place-thing-to-container banana white-plate
0
2
0 3 0 1
0 2 -1 0
1
end_operator
begin_operator
place-thing-to-container block white-plate
0
2
0 4 0 1
0 2 -1 0
1
end_operator
begin_operator
place-thing-to-cookware banana pan
1
0 1
2
0 3 0 2
0 2 -1 0
1
end_operator
begin_operator
place-thing-to-cookware block pan
1
0 1
2
0 4 0 2
0 2 -1 0
1
end_operator
begin_operator
place-thing-to-drawer banana red-plate
0
2
0 3 0 3
0 2 -1 0
1
end_operator
begin_operator
place-thing-to-drawer block red-plate
0
2
0 4 0 3
0 2 -1 0
1
end_operator
1
begin_rule
1
1 2
0 1 0
end_rule
