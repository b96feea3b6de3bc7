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
from symskill_pddl.kitchen.layout import Box, Vec3

ARM_JOINTS = tuple(f"robot0_joint{i}" for i in range(1, 8))
FINGER_JOINTS = ("gripper0_right_finger_joint1", "gripper0_right_finger_joint2")
PADS = ("gripper0_right_finger1_pad_collision", "gripper0_right_finger2_pad_collision")
EE_SITE = "ee"
DOOR_JOINT = "door_hinge"

CONTACT = {"condim": "4", "solref": "0.01 1", "solimp": "0.95 0.99 0.001"}
FINGER_FORCE = 45.0
"""Most the fingers' drives give [N], each; the real hand presses with up to 70 N."""


def _text(values: Vec3 | tuple[float, ...]) -> str:
    return " ".join(f"{v:.6g}" for v in values)


def _box(name: str, box: Box, rgba: str, friction: str = "0.8 0.02 0.001") -> str:
    contact = _text_attributes(CONTACT)
    return (
        f'<geom name="{name}" type="box" pos="{_text(box.center)}" size="{_text(box.half)}" rgba="{rgba}" '
        f'group="0" friction="{friction}" {contact}/>'
    )


def _text_attributes(attributes: dict[str, str]) -> str:
    return " ".join(f'{key}="{value}"' for key, value in attributes.items())


def _cabinet() -> str:
    hx, hy, hz = layout.CABINET.half
    t = layout.PANEL / 2
    wood = "0.72 0.55 0.38 1"
    panels = (
        ("cabinet_floor", Box((0.0, 0.0, -hz + t), (hx, hy, t))),
        ("cabinet_top", Box((0.0, 0.0, hz - t), (hx, hy, t))),
        ("cabinet_right", Box((0.0, -hy + t, 0.0), (hx, t, hz))),
        ("cabinet_left", Box((0.0, hy - t, 0.0), (hx, t, hz))),
        ("cabinet_back", Box((hx - t, 0.0, 0.0), (t, hy, hz))),
        ("cabinet_shelf", layout.SHELF),
    )
    return "".join(_box(name, box, wood) for name, box in panels)


def _door() -> str:
    x, y, z = layout.HANDLE
    panel = Box((0.0, 0.0, 0.0), layout.DOOR.half)
    half, radius = layout.HANDLE_LENGTH / 2, layout.HANDLE_RADIUS
    contact = _text_attributes(CONTACT)
    steel = f'rgba="0.75 0.76 0.78 1" group="0" friction="1 0.02 0.001" mass="0.05" {contact}'
    standoffs = "".join(
        f'<geom name="door_standoff{i}" type="capsule" size="0.005" {steel} '
        f'fromto="{_text((-layout.DOOR.half[0], y, z + dz))} {_text((x, y, z + dz))}"/>'
        for i, dz in enumerate((-half + 0.006, half - 0.006))
    )
    # solid panel of 2 kg; friction keeps the door where it is left
    return (
        f'<body name="door" pos="{_text(layout.DOOR.center)}">'
        f'<joint name="{DOOR_JOINT}" type="hinge" axis="0 0 1" pos="{_text(layout.DOOR_HINGE)}" limited="true" '
        f'range="0 {layout.DOOR_RANGE}" damping="1.5" frictionloss="0.6" armature="0.01"/>'
        + _box("door_panel", panel, "0.82 0.68 0.50 1").replace("/>", ' mass="2.0"/>')
        + f'<geom name="door_handle" type="cylinder" pos="{_text(layout.HANDLE)}" size="{radius} {half}" {steel}/>'
        + f"{standoffs}</body>"
    )


def _fixtures() -> list[ET.Element]:
    """Bodies of the arena: counter, wall cabinet with its door, and what only completes the picture."""
    cx, cy, _ = layout.COUNTER.center
    hx, hy, _ = layout.COUNTER.half
    below = Box((cx + 0.02, cy, (layout.FLOOR_Z - 0.04) / 2), (hx - 0.02, hy, -(layout.FLOOR_Z + 0.04) / 2))
    pedestal = Box((0.0, 0.0, layout.FLOOR_Z / 2), (0.09, 0.09, -layout.FLOOR_Z / 2 - 0.002))
    wall = Box((layout.WALL_X + 0.02, 0.0, 0.4), (0.02, 1.5, 1.32))
    slab = Box((0.0, 0.0, 0.0), layout.COUNTER.half)
    texts = (
        f'<body name="counter" pos="{_text(layout.COUNTER.center)}">{_box("counter_top", slab, "0.33 0.34 0.36 1")}</body>',
        f'<body name="cabinet" pos="{_text(layout.CABINET.center)}">{_cabinet()}{_door()}</body>',
        f'<body name="room">{_box("base_cabinet", below, "0.9 0.9 0.88 1")}'
        f"{_box('pedestal', pedestal, '0.25 0.25 0.27 1')}{_box('wall', wall, '0.85 0.88 0.84 1')}</body>",
        '<camera name="overview" pos="-0.75 1.25 1.15" xyaxes="-0.70 -0.71 0 0.30 -0.30 0.90" fovy="48"/>',
        '<camera name="inside" pos="-0.25 0.30 0.95" xyaxes="-0.36 -0.93 0 0.25 -0.10 0.96" fovy="55"/>',
    )
    return [ET.fromstring(text) for text in texts]


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
        """robosuite's empty room with a counter and a wall cabinet."""

        def __init__(self) -> None:
            super().__init__()
            self.set_origin((0.0, 0.0, layout.FLOOR_Z))
            for element in _fixtures():
                self.worldbody.append(element)
            # a closed door rests on the cabinet's edges; the joint limit does that better than contacts
            self.contact.append(ET.Element("exclude", body1="cabinet", body2="door"))

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
        if model.body(model.geom_bodyid[i]).name in ("counter", "cabinet", "door", "room"):
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
