"""Room beside an open door, in a model of a door, a wall and nothing else."""

import numpy as np
import pytest

from symskill_pddl.demonstrator.part import Jointed
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen.backend import load_mujoco
from symskill_pddl.robocasa.beside import free_beside, hand_fits
from symskill_pddl.robocasa.tracking import Model
from symskill_pddl.robocasa.view import View

ROOM = """<mujoco><worldbody>
  <body name="door" pos="0.4 0.2 0.8"><geom type="box" size="0.01 0.2 0.1"/></body>
  <body name="robot0_base"><geom type="box" pos="0.2 -0.4 0.5" size="0.1 0.1 0.1"/></body>
  <body name="wall" pos="0.2 {y} 0.5"><geom type="box" size="0.3 0.1 0.5"/></body>
</worldbody></mujoco>"""
DOOR = Jointed(
    "door", Pose(np.array([0.4, 0.2, 0.8]), np.array([1.0, 0.0, 0.0, 0.0])), "hinge", (0.0, 0.0, 1.0), (0.0, -0.4, 0.0)
)


@pytest.mark.parametrize(
    ("y", "mirrored", "free"), [(-0.4, False, False), (-0.8, False, True), (0.4, False, True), (0.4, True, False)]
)
def test_a_wall_beside_the_door_leaves_no_room(y: float, mirrored: bool, free: bool) -> None:
    mujoco = load_mujoco()
    model = mujoco.MjModel.from_xml_string(ROOM.format(y=y))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert free_beside(Model(mujoco, model, data), View(Pose.identity(), mirrored), DOOR, model.body("door").id) is free


@pytest.mark.parametrize(("y", "fits"), [(-0.2, True), (-0.3, False), (-0.05, False), (0.1, False)])
def test_a_hand_fits_between_the_door_and_the_other_side(y: float, fits: bool) -> None:
    p = DOOR.T_world_home.apply([0.2, y, -0.1])
    assert hand_fits(DOOR, p) is fits
    # and likewise where the door is hinged on the left
    other = Jointed(DOOR.name, DOOR.T_world_home, DOOR.joint, (0.0, 0.0, -1.0), (0.0, 0.4, 0.0))
    assert hand_fits(other, DOOR.T_world_home.apply([0.2, -y, -0.1])) is fits
