"""What is seen of things that are carried, on a kitchen of a few boxes made by hand."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose, rotation_distance
from symskill_pddl.robocasa.things import FITS_M, _clearance, cooked
from symskill_pddl.robocasa.tracking import Model, Tracked

mujoco = pytest.importorskip("mujoco")

DISH = """<body name="{name}" pos="{x} {y} 0.9"><freejoint/><geom type="cylinder" size="0.1 0.005" pos="0 0 0.005"/>
<geom type="box" size="0.004 0.04 0.02" pos="0.1 0 0.02"/></body>"""


def a_kitchen(food: str, x: float = 0.5, y: float = 0.1, plate_y: float = -0.5, yaw_deg: float = 0.0) -> tuple[Model, Any]:
    """The robot stands at (1, 2) and looks along +y of the world: a food in a pan ahead of it, a plate beside that."""

    def world(forward: float, left: float) -> dict[str, float]:
        return {"x": 1.0 - left, "y": 2.0 + forward}

    at = world(x, y)
    model = mujoco.MjModel.from_xml_string(
        f'''<mujoco><worldbody><body name="robot0_link0" pos="1 2 0.7" euler="0 0 90"/>
        <body name="food" pos="{at["x"]} {at["y"]} 0.95" euler="0 0 {yaw_deg + 90}"><freejoint/>{food}</body>
        {DISH.format(name="pan", **world(x, y))}{DISH.format(name="plate", **world(0.4, plate_y))}</worldbody></mujoco>'''
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    names = {"obj": "food", "obj_container": "pan", "container": "plate"}
    cfgs = [{"name": thing, "info": {"cat": body}} for thing, body in names.items()]
    env = SimpleNamespace(obj_body_id={thing: model.body(body).id for thing, body in names.items()}, object_cfgs=cfgs)
    return Model(mujoco, model, data), env


def seen(m: Model, tracked: Tracked) -> Pose:
    return m.T_world_robot().inverse() @ m.T_world(tracked.body) @ tracked.T_body_frame


def test_the_robot_sees_from_where_it_stands_and_the_plate_on_its_right() -> None:
    m, env = a_kitchen('<geom type="box" size="0.02 0.03 0.025"/>')
    right = cooked(m, env, None)
    np.testing.assert_allclose(seen(m, right.tracked[1]).p, [0.5, 0.1, 0.2], atol=1e-9)
    assert not right.mirrored
    assert cooked(*a_kitchen('<geom type="box" size="0.02 0.03 0.025"/>', plate_y=0.5), None).mirrored


@pytest.mark.parametrize("yaw", [-170.0, -95.0, -40.0, 0.0, 30.0, 120.0])
def test_the_fingers_go_across_a_side_that_fits_and_the_hand_looks_away_from_the_robot(yaw: float) -> None:
    m, env = a_kitchen('<geom type="box" size="0.02 0.06 0.025"/>', y=0.0, yaw_deg=yaw)
    food = cooked(m, env, None).tracked[0]
    assert food.half is not None
    assert np.allclose(food.half, (0.06, 0.02, 0.025))
    assert seen(m, food).rotate([1.0, 0.0, 0.0])[0] > -1e-9


def test_of_two_sides_that_fit_the_hand_turns_less() -> None:
    m, env = a_kitchen('<geom type="box" size="0.02 0.025 0.025"/>', y=0.0, yaw_deg=80.0)
    food = cooked(m, env, None).tracked[0]
    assert food.half is not None
    assert np.allclose(food.half, (0.025, 0.02, 0.025))
    assert 2 * food.half[1] < FITS_M
    assert rotation_distance(seen(m, food), Pose.from_rotvec([0, 0, 0], [0, 0, 0])) == pytest.approx(np.radians(10.0))


def test_round_food_and_dishes_look_straight_away() -> None:
    m, env = a_kitchen('<geom type="cylinder" size="0.03 0.04" pos="0 0 0.01"/>', yaw_deg=33.0)
    found = cooked(m, env, None)
    for tracked in found.tracked:
        T = seen(m, tracked)
        forward = T.rotate([1.0, 0.0, 0.0])
        assert np.arctan2(forward[1], forward[0]) == pytest.approx(np.arctan2(T.p[1], T.p[0]), abs=1e-6)
    assert seen(m, found.tracked[0]).p[2] == pytest.approx(0.26)


def test_there_is_room_on_the_floor_of_a_dish() -> None:
    m, env = a_kitchen('<geom type="box" size="0.02 0.03 0.025"/>')
    assert cooked(m, env, None).room == {"pan": pytest.approx((0.0, 0.0, 0.01)), "plate": pytest.approx((0.0, 0.0, 0.01))}


def test_an_episode_without_a_pan_is_refused() -> None:
    m, env = a_kitchen('<geom type="box" size="0.02 0.03 0.025"/>')
    env.object_cfgs[1]["info"]["cat"] = "bowl"
    with pytest.raises(InputError, match="needs a pan"):
        cooked(m, env, None)


def test_room_on_a_counter_is_where_nothing_stands() -> None:
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><worldbody><geom name="counter" type="box" size="0.3 1 0.02" pos="0.5 0 0.9"/>
        <geom name="roll" type="cylinder" size="0.05 0.15" pos="0.5 0.1 1.07"/>
        <geom name="lamp" type="box" size="0.3 1 0.1" pos="0.5 0 1.8"/></worldbody></mujoco>"""
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    points = np.array([[0.5, 0.1, 0.92], [0.5, -0.3, 0.92], [0.5, 0.3, 0.92]])
    np.testing.assert_allclose(_clearance(Model(mujoco, model, data), points), [0.0, 0.35, 0.15], atol=1e-6)
