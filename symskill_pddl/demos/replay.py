"""Poses from recorded MuJoCo states: a recording's model XML, reduced to its kinematics, and the frames worth reading from it.

Replaying needs bodies, joints and primitive shapes only (`model_xml`). Meshes, textures and materials lie on the machine of
whoever recorded; no asset is ever opened.

What is an object, and what it is called:

- The robot is the top-level body that carries the `grip_site`. Everything below it is robot.
- Every other body with a joint of its own is an object (free bodies, doors, latches, drawers).
- A body without a joint that can be touched and hangs from no moving body is an object too: a resting place or reference (table,
  bin, frame; not the pictures of goals that robosuite draws). Its frame is the body's site named `*_top` where there is one
  (robosuite marks table tops so), since robosuite's own table frame lies inside the slab; else the body's frame.
- An object's name is its body's without a `_main`, `_root`, `_object` or `_body` at the end; its type is the name without
  trailing digits (``can2`` is a ``can``; ``cubeA`` and ``cubeB`` stay types of their own unless the caller says otherwise).
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from symskill_pddl.demos.fingers import Fingers
from symskill_pddl.demos.model_xml import kinematic_xml
from symskill_pddl.errors import FormatError, MissingDependencyError, shown
from symskill_pddl.geometry import Array, Pose

_OLDER = {"Door_frame": "frame", "Door_door": "door", "Door_latch": "latch"}
"""What robosuite 1.5 calls bodies that its older releases, and recordings with them, call otherwise."""


@dataclass(frozen=True)
class TrackedObject:
    """A body of the model that becomes an object of the demonstration."""

    name: str
    body: int
    site: int
    """Site that gives the frame, or -1 for the body's own."""
    half_size: tuple[float, float, float] | None
    """Of the box about the frame that holds the primitive shapes [m]; None without such shapes, or if the body does not move."""
    moves: bool = False
    """Whether it has a joint of its own."""


@dataclass(frozen=True)
class Replayed:
    """Frames read from n recorded states."""

    T_world_ee: Pose
    aperture: Array
    T_world_objects: Pose


class KinematicModel:
    """A compiled model, its gripper and its objects.

    Attributes
    ----------
    mujoco, model, data : Any
        The module, and its model and data, for who looks for other frames.
    objects : tuple of TrackedObject
        In the order of the model.

    Raises
    ------
    FormatError
        If the model does not compile, or does not have exactly one gripper with sliding fingers.
    """

    def __init__(self, xml: str) -> None:
        try:
            import mujoco
        except ImportError as error:
            raise MissingDependencyError("importing robosuite recordings needs MuJoCo: pip install mujoco") from error
        stripped, self._shaped = kinematic_xml(xml)
        self.mujoco: Any = mujoco
        try:
            self.model = mujoco.MjModel.from_xml_string(stripped)
        except (ValueError, mujoco.FatalError) as error:
            raise FormatError(f"the model does not compile: {shown(error)}") from None
        self.data = mujoco.MjData(self.model)
        self._site, joints, moved, self._robot = self._find_gripper()
        self._place()
        self._fingers = Fingers(self.model, self.data, self._site, joints, moved)
        y, z = self._fingers.opening, np.array([0.0, 0.0, 1.0])
        # z is the site's: out of the hand
        self._R_site_ee = np.stack([np.cross(y, z), y, z], axis=1)
        self.objects = self._find_objects()

    @property
    def state_size(self) -> int:
        """Numbers in a recorded state: time, joint positions, joint velocities."""
        return int(1 + self.model.nq + self.model.nv)

    @property
    def grip(self) -> Any:
        """The gripper's site in the present state, as MuJoCo's view of it: its axes are the model's own."""
        return self.data.site(self._site)

    def replay(self, states: Array) -> Replayed:
        """Frames at the recorded `states` (n, 1 + nq + nv)."""
        n, m = len(states), len(self.objects)
        p_ee, R_ee = np.empty((n, 3)), np.empty((n, 3, 3))
        p, q, aperture = np.empty((n, m, 3)), np.empty((n, m, 4)), np.empty(n)
        for i, state in enumerate(states):
            self.pose(state)
            aperture[i] = self._fingers.aperture()
            p_ee[i] = self.data.site_xpos[self._site]
            R_ee[i] = self.data.site_xmat[self._site].reshape(3, 3) @ self._R_site_ee
            for k, tracked in enumerate(self.objects):
                q[i, k] = self.data.xquat[tracked.body]  # a top site is not turned against its body
                p[i, k] = self.data.xpos[tracked.body] if tracked.site < 0 else self.data.site_xpos[tracked.site]
        return Replayed(Pose(p_ee, Pose.from_matrix(_homogeneous(R_ee)).q), aperture, Pose(p, q))

    def aperture(self) -> float:
        """Opening between the fingers in the present state [m]."""
        return self._fingers.aperture()

    def pose(self, state: Array) -> None:
        """Put `data` into a recorded state (1 + nq + nv,): where things are, nothing else."""
        self.data.qpos[:] = state[1 : 1 + self.model.nq]
        self._place()

    def _place(self) -> None:
        """Put all bodies where the joints say; a model whose numbers are out of all proportion puts them nowhere."""
        self.mujoco.mj_kinematics(self.model, self.data)
        if not all(np.isfinite(a).all() for a in (self.data.xpos, self.data.xquat, self.data.site_xpos, self.data.site_xmat)):
            raise FormatError("the model's or a state's numbers are out of range: a body has no place")

    # -- structure ------------------------------------------------------------------------------------------------------

    def _name(self, kind: str, index: int) -> str:
        return str(getattr(self.model, kind)(index).name)

    def _ancestors(self, body: int) -> list[int]:
        """The body and all above it, without the world."""
        chain = []
        while body != 0:
            chain.append(body)
            body = int(self.model.body_parentid[body])
        return chain

    def _find_gripper(self) -> tuple[int, list[int], list[int], int]:
        """The grip site, the joints that move its fingers and the bodies that they move, and the robot's top body."""
        sites = [s for s in range(self.model.nsite) if self._name("site", s).endswith("grip_site")]
        if len(sites) != 1:
            names = ", ".join(self._name("site", s) for s in sites) or "none"
            raise FormatError(
                f"only recordings of one arm can be imported, the model has {len(sites)} grippers (grip sites: {names})"
            )
        chain = self._ancestors(int(self.model.site_bodyid[sites[0]]))
        above = {b: self._ancestors(b) for b in range(1, self.model.nbody)}
        for body in chain:
            joints = [j for j in range(self.model.njnt) if body in above[int(self.model.jnt_bodyid[j])]]
            if joints:
                jointed = {int(self.model.jnt_bodyid[j]) for j in joints}
                if body in jointed:
                    break
                moved = [b for b, up in above.items() if jointed.intersection(up)]
                return sites[0], joints, moved, chain[-1]
        raise FormatError("only hands whose fingers move can be imported, there is no joint beside the grip site that moves one")

    def _find_objects(self) -> tuple[TrackedObject, ...]:
        bodies = []
        for body in range(1, self.model.nbody):
            chain = self._ancestors(body)
            moving = [b for b in chain if self.model.body_jntnum[b] > 0]
            fixture = not moving and self._name("body", body) in self._shaped and self.model.body_mocapid[body] < 0
            if self._robot not in chain and (self.model.body_jntnum[body] > 0 or fixture):
                bodies.append(body)
        full = [self._name("body", b) for b in bodies]
        short = [object_name(name) for name in full]
        names = [s if short.count(s) == 1 else f for s, f in zip(short, full, strict=True)]
        return tuple(self._tracked(body, name) for body, name in zip(bodies, names, strict=True))

    def _tracked(self, body: int, name: str) -> TrackedObject:
        if self.model.body_jntnum[body] > 0:
            return TrackedObject(name, body, -1, self._half_size(body), moves=True)
        sites = [
            s for s in range(self.model.nsite) if self.model.site_bodyid[s] == body and self._name("site", s).endswith("_top")
        ]
        return TrackedObject(name, body, sites[0] if sites else -1, None)

    def _half_size(self, body: int) -> tuple[float, float, float] | None:
        """Half sizes of the box about the body's frame that holds its primitive shapes."""
        half = np.zeros(3)
        for geom in range(self.model.ngeom):
            if self.model.geom_bodyid[geom] == body:
                centre, box = self.model.geom_aabb[geom][:3], self.model.geom_aabb[geom][3:]
                T = Pose(self.model.geom_pos[geom], self.model.geom_quat[geom])
                corners = centre + box * np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
                half = np.maximum(half, np.abs(T.apply(corners)).max(axis=0))
        a, b, c = (float(h) for h in half)
        return (a, b, c) if min(a, b, c) > 0 else None


def object_name(body: str) -> str:
    """A body's name without robosuite's endings, and as its older releases have it."""
    return _OLDER.get(body) or re.sub(r"_(main|root|object|body)$", "", body) or body


def type_name(name: str) -> str:
    """The type of an object that is not told otherwise: its name without trailing digits."""
    return name.rstrip("0123456789").rstrip("_-") or name


def _homogeneous(R: Array) -> Array:
    T = np.zeros((*R.shape[:-2], 4, 4))
    T[..., :3, :3] = R
    T[..., 3, 3] = 1.0
    return T
