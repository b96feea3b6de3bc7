import numpy as np
import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.kitchen import arm, make, parse_disturbance
from symskill_pddl.kitchen.layout import hand_pose
from symskill_pddl.scene import Command


@pytest.mark.parametrize(
    ("spec", "time", "step"),
    [
        ("close-door@t=5", 5.0, None),
        ("close-door@op=2", None, 2),
        ("push:20N,0.5s@t=1.5", 1.5, None),
        ("drop@op=0", None, 0),
        ("push:-30N@t=0", 0.0, None),
    ],
)
def test_specs_are_understood(spec, time, step):
    disturbance = parse_disturbance(spec)
    assert (disturbance.at_time, disturbance.at_step) == (time, step)


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("explode@t=1", "there are: close-door, drop, push"),
        ("drop", "drop@t=SECONDS"),
        ("drop@t=", "drop@t=SECONDS"),
        ("drop@t=soon", "drop@t=SECONDS"),
        ("drop@op=1.5", "drop@op=NUMBER"),
        ("drop@x=1", "drop@t=SECONDS"),
        ("push:20@t=1", "units N, s"),
        ("push:20kg@t=1", "units N, s"),
        ("push:N@t=1", "units N, s"),
    ],
)
def test_errors_say_what_exists(spec, message):
    with pytest.raises(InputError, match=message) as error:
        parse_disturbance(spec)
    assert "\n" not in str(error.value)


@pytest.mark.simulation
def test_close_door_waits_for_its_step_and_shuts_the_door():
    kitchen = make("CloseSingleDoor", 0, ["close-door@op=1"])
    # out of the way of the door
    kitchen.physics.set_arm(arm.solve(kitchen.physics, hand_pose((0.46, 0.43, 0.10), np.radians(-15), np.radians(70))))
    kitchen.physics.forward()
    for k in range(2):
        kitchen.notify_step(k)
        before = kitchen.physics.door_angle
        for _ in range(20):
            kitchen.step(Command.hold(False))
        assert (abs(kitchen.physics.door_angle - before) < 1e-3) == (k == 0)
    for _ in range(80):
        kitchen.step(Command.hold(False))
    assert kitchen.physics.door_angle < np.radians(3)
    assert kitchen.physics.door_torque == 0.0
    assert kitchen.disturbances[0].done


@pytest.mark.simulation
def test_push_moves_the_hand_for_its_time_only():
    kitchen = make("OpenSingleDoor", 0, ["push:20N,0.5s@t=0.2"])
    y = [kitchen.observe().T_world_ee.p[1]] + [kitchen.step(Command.hold(False)).T_world_ee.p[1] for _ in range(40)]
    assert abs(y[4] - y[0]) < 1e-3
    assert y[14] - y[4] > 0.003
    assert abs(y[-1] - y[30]) < 1e-3
    assert not kitchen.physics.hand_force.any()


@pytest.mark.simulation
def test_drop_opens_the_fingers_whatever_the_command():
    kitchen = make("OpenSingleDoor", 0, ["drop:1s@t=1"])
    opening = [kitchen.step(Command.hold(True)).aperture for _ in range(80)]
    assert opening[19] < 0.005
    assert opening[38] > 0.05
    assert opening[-1] < 0.005
    assert kitchen.observe().gripper_closed
