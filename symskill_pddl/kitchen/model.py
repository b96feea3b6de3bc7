"""The MuJoCo model of the kitchen, put together with robosuite's own pieces.

robosuite gives the arm, the gripper, the empty room and the meshes of some foods; fixtures are added as an arena of our own. The
model is compiled once per process and copied for every episode, whose placements are fields of the compiled model.
"""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from functools import lru_cache
from typing import Any

from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.backend import load_mujoco, load_robosuite
from symskill_pddl.kitchen.fixtures import CONTACT, fixtures

ARM_JOINTS = tuple(f"robot0_joint{i}" for i in range(1, 8))
FINGER_JOINTS = ("gripper0_right_finger_joint1", "gripper0_right_finger_joint2")
PADS = ("gripper0_right_finger1_pad_collision", "gripper0_right_finger2_pad_collision")
EE_SITE = "ee"

FINGER_FORCE = 45.0
"""Most the fingers' drives give [N], each; the real hand presses with up to 70 N."""


def _foods() -> list[Any]:
    """robosuite objects, named, with masses and contacts of our own (theirs weigh a few grams)."""
    load_robosuite()
    from robosuite.models.objects import BoxObject, MujocoXMLObject
    from robosuite.utils.mjcf_utils import xml_path_completion

    mesh_scale = {"bread": None, "can": (1.0, 1.0, 0.6)}
    objects: list[Any] = [BoxObject("cheese", size=layout.FOODS["cheese"], rgba=(0.98, 0.80, 0.20, 1.0))]
    objects += [
        MujocoXMLObject(xml_path_completion(f"objects/{name}.xml"), name=name, scale=scale) for name, scale in mesh_scale.items()
    ]
    for item in objects:
        for geom in item.get_obj().iter("geom"):
            if geom.get("group") == "0":
                geom.attrib.pop("density", None)
                # rolling friction: a tin or a loaf does not spin on a point
                geom.attrib.update(CONTACT, mass=str(layout.FOOD_MASS[item.name]), friction="0.9 0.02 0.001")
    return objects


def _mjcf() -> str:
    """The whole kitchen as one MJCF document."""
    load_robosuite()
    from robosuite.models.arenas import EmptyArena
    from robosuite.models.grippers import PandaGripper
    from robosuite.models.robots import Panda
    from robosuite.models.tasks import ManipulationTask

    class KitchenArena(EmptyArena):  # type: ignore[misc]
        """robosuite's empty room with the fixtures."""

        def __init__(self) -> None:
            super().__init__()
            self.set_origin((0.0, 0.0, layout.FLOOR_Z))
            for element in fixtures():
                self.worldbody.append(element)
            # a closed door rests on the cabinet's edges; the joint limit does that better than contacts
            for name, part in layout.PARTS.items():
                self.contact.append(ET.Element("exclude", body1=part.unit, body2=name))

    robot = Panda(0)
    robot.add_gripper(PandaGripper("0_right"))
    root = ManipulationTask(KitchenArena(), [robot], _foods()).root
    for geom in root.iter("geom"):
        # arm links meet the world and the hand but not each other (a fifth of the time, for joint limits do the same)
        if geom.get("name", "").startswith("robot0_link") and geom.get("group") == "0":
            geom.attrib.update(contype="0", conaffinity="1")
    grip = next(body for body in root.iter("body") if body.get("name") == "gripper0_right_eef")
    # the grip point with y along the opening of the fingers
    ET.SubElement(grip, "site", name=EE_SITE, pos="0 0 0", quat="0.70710678 0 0 -0.70710678", size="0.003", rgba="0 0 0 0")
    text = ET.tostring(root, encoding="unicode")
    return str(text)


@lru_cache(maxsize=1)
def _compiled() -> Any:
    mujoco = load_mujoco()
    model = mujoco.MjModel.from_xml_string(_mjcf())
    model.opt.timestep = 0.002
    model.opt.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    model.opt.impratio = 5.0
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    for i in range(model.ngeom):
        # robosuite takes inertia from group 0 only; once that is done, group 2 tells what is drawn as it collides
        if model.body(model.geom_bodyid[i]).name in ("counter", "room", *layout.UNITS, *layout.PARTS):
            model.geom_group[i] = 2
    for name in ARM_JOINTS:
        actuator = model.actuator(name.replace("robot0_joint", "robot0_torq_j")).id
        limit = 87.0 if int(name[-1]) < 5 else 12.0
        model.actuator_ctrlrange[actuator] = (-limit, limit)
    for i, name in enumerate(FINGER_JOINTS):
        actuator = model.actuator(f"gripper0_right_gripper_finger_joint{i + 1}").id
        # targets behind the closed position: without them a thin bar is held with 7 N only
        model.actuator_ctrlrange[actuator] = (-0.02, 0.04) if i == 0 else (-0.04, 0.02)
        model.actuator_forcerange[actuator] = (-FINGER_FORCE, FINGER_FORCE)
        model.dof_damping[model.joint(name).dofadr[0]] = 60.0
    return model


def kitchen_model() -> Any:
    """A fresh `mujoco.MjModel` of the kitchen that the caller may change."""
    return copy.deepcopy(_compiled())
