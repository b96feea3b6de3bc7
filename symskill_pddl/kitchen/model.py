"""The MuJoCo model of the kitchen, put together with robosuite's own pieces.

robosuite gives the arm, the gripper, the empty room and the meshes of some foods; fixtures are added as an arena of our own. The
model of a scene is compiled once per process and copied for every episode, whose placements are fields of the compiled model.
"""

from __future__ import annotations

import copy
import xml.etree.ElementTree as ET
from functools import lru_cache
from pathlib import Path
from typing import Any

from symskill_pddl.errors import MissingDependencyError, alternatives
from symskill_pddl.kitchen import layout, loose
from symskill_pddl.kitchen.backend import load_mujoco, load_robosuite
from symskill_pddl.kitchen.fixtures import fixtures
from symskill_pddl.kitchen.layout import SceneLayout
from symskill_pddl.kitchen.loose import Loose, Mesh
from symskill_pddl.kitchen.mjcf import CONTACT
from symskill_pddl.panda.arm import tune as tune_arm

EE_SITE = "ee"


def _mesh(name: str, thing: Loose, shape: Mesh) -> Any:
    """A robosuite object with mass and contacts of our own (theirs weigh a few grams)."""
    load_robosuite()
    from robosuite.models.objects import MujocoXMLObject
    from robosuite.utils.mjcf_utils import xml_path_completion

    path = Path(xml_path_completion(f"objects/{shape.file}.xml"))
    if not path.is_file():
        there = alternatives(p.stem for p in path.parent.glob("*.xml"))
        raise MissingDependencyError(f"robosuite has no object '{shape.file}' for '{name}' ({path}); it has: {there}")
    item = MujocoXMLObject(str(path), name=name, scale=shape.scale)
    for mesh in item.asset.iter("mesh"):
        if not Path(mesh.get("file", "")).is_file():
            raise MissingDependencyError(
                f"robosuite's object '{shape.file}' lacks its mesh {mesh.get('file')}: install robosuite again"
            )
    for geom in item.get_obj().iter("geom"):
        if geom.get("group") == "0":
            geom.attrib.pop("density", None)
            geom.attrib.update(CONTACT, mass=str(thing.mass), friction=loose.FOOD_FRICTION)
    return item


def task_model(scene: SceneLayout, robot: Any) -> Any:
    """A robosuite `ManipulationTask` of a scene with a robosuite model of a Panda, its hand mounted, in front of it."""
    load_robosuite()
    from robosuite.models.arenas import EmptyArena
    from robosuite.models.tasks import ManipulationTask

    class KitchenArena(EmptyArena):  # type: ignore[misc]
        """robosuite's empty room with the fixtures."""

        def __init__(self) -> None:
            super().__init__()
            self.set_origin((0.0, 0.0, layout.FLOOR_Z))
            for element in fixtures(scene):
                self.worldbody.append(element)
            for name, thing in scene.loose.items():
                body = loose.mjcf(name, thing)
                if body is not None:
                    self.worldbody.append(ET.fromstring(body))
            # a closed door rests on the cabinet's edges; the joint limit does that better than contacts
            for name, part in scene.parts.items():
                self.contact.append(ET.Element("exclude", body1=part.unit, body2=name))

    meshes = [_mesh(name, thing, thing.shape) for name, thing in scene.loose.items() if isinstance(thing.shape, Mesh)]
    task = ManipulationTask(KitchenArena(), [robot], meshes)
    for geom in task.root.iter("geom"):
        # arm links meet the world and the hand but not each other (a fifth of the time, for joint limits do the same)
        if geom.get("name", "").startswith("robot0_link") and geom.get("group") == "0":
            geom.attrib.update(contype="0", conaffinity="1")
    grip = next(body for body in task.root.iter("body") if body.get("name") == "gripper0_right_eef")
    # the grip point with y along the opening of the fingers
    ET.SubElement(grip, "site", name=EE_SITE, pos="0 0 0", quat="0.70710678 0 0 -0.70710678", size="0.003", rgba="0 0 0 0")
    return task


def _mjcf(scene: SceneLayout) -> str:
    """The whole scene as one MJCF document."""
    load_robosuite()
    from robosuite.models.grippers import PandaGripper
    from robosuite.models.robots import Panda

    robot = Panda(0)
    robot.add_gripper(PandaGripper("0_right"))
    return str(ET.tostring(task_model(scene, robot).root, encoding="unicode"))


@lru_cache
def _compiled(scene: SceneLayout) -> Any:
    mujoco = load_mujoco()
    model = mujoco.MjModel.from_xml_string(_mjcf(scene))
    tune(scene, model)
    return model


def tune(scene: SceneLayout, model: Any) -> None:
    """Set what the documents of robosuite's parts leave to the defaults: solver, drives, and which shapes are drawn."""
    mujoco = load_mujoco()
    tune_arm(mujoco, model)
    plain = [loose.body_of(name) for name, thing in scene.loose.items() if not isinstance(thing.shape, Mesh)]
    drawn = {"counter", "room", *scene.units, *scene.parts, *plain}
    for i in range(model.ngeom):
        # robosuite takes inertia from group 0 only; once that is done, group 2 tells what is drawn as it collides
        if model.geom_group[i] == 0 and model.body(model.geom_bodyid[i]).name in drawn:
            model.geom_group[i] = 2


def scene_model(scene: SceneLayout) -> Any:
    """A fresh `mujoco.MjModel` of a scene that the caller may change.

    Raises
    ------
    MissingDependencyError
        robosuite, mujoco, or a mesh of robosuite's is not there.
    """
    return copy.deepcopy(_compiled(scene))
