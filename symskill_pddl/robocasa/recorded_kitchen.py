"""What `tracking` and `things` ask RoboCasa's environment and fixtures for, read from a recorded model and its description.

A recording names its fixtures and things (``ep_meta``: ``fixture_refs``, ``task_refs``, ``object_cfgs``), and names of the model
begin with these: bodies, joints, geoms. What RoboCasa works out from them, the free stretch of a counter, is found in shapes.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from symskill_pddl.errors import FormatError, alternatives
from symskill_pddl.geometry import Array
from symskill_pddl.robocasa.tasks import TaskSpec
from symskill_pddl.robocasa.tracking import Model

LEAST_M = (0.40, 0.25)
"""Width and depth of the least stretch of a counter that RoboCasa puts things on."""
LEAST_WIDTH_M = 0.20
"""Of that, once it is centred on the fixture it is next to."""


class RecordedEnv:
    """An environment's attributes, as far as they are asked for.

    Parameters
    ----------
    m : Model
        The recorded model, in the episode's first state.
    meta : mapping
        The episode's description.
    """

    def __init__(self, m: Model, meta: Mapping[str, Any]) -> None:
        self._m = m
        self.references = {key: str(name) for key, name in mapping(meta.get("fixture_refs")).items()}
        self.knob = mapping(meta.get("task_refs")).get("knob")
        self.drawer_side = "left" if " left " in str(meta.get("lang", "")) else "right"
        cfgs = meta.get("object_cfgs")
        self.object_cfgs = (
            [c for c in cfgs if isinstance(c, dict) and "cat" in mapping(c.get("info"))] if isinstance(cfgs, list) else []
        )
        self.joints = [str(m.model.joint(j).name) for j in range(m.model.njnt)]

    @property
    def obj_body_id(self) -> dict[str, int]:
        """Bodies of the loose things, by RoboCasa's names for them."""
        bodies = {str(self._m.model.body(b).name): b for b in range(self._m.model.nbody)}
        named = [str(c.get("name")) for c in self.object_cfgs]
        return _Bodies({name: bodies[f"{name}_main"] for name in named if f"{name}_main" in bodies})

    @property
    def counter(self) -> RecordedFixture:
        """The counter of a task that has one."""
        if "counter" not in self.references:
            raise FormatError(f"names no counter ('fixture_refs': {alternatives(self.references)})")
        return RecordedFixture(self._m, self.references["counter"], self.joints)

    def fixture(self, spec: TaskSpec) -> RecordedFixture:
        """The fixture that a task is about: one that the description names, or whose joint the task is named after.

        Raises
        ------
        FormatError
            There is none, or it has two doors and the task is about one.
        """
        names, lacking = self._candidates(spec.about)
        if not names:
            raise FormatError(f"task '{spec.name}': the recording {lacking}")
        fixture = RecordedFixture(self._m, names[0], self.joints)
        if spec.about == "door" and len(fixture.door_joint_names) != 1:
            raise FormatError(f"'{fixture.name}' has {len(fixture.door_joint_names)} doors; task '{spec.name}' is about one")
        return fixture

    def _candidates(self, about: str) -> tuple[list[str], str]:
        """Names of fixtures, and what to say if there are none."""
        if about in ("knob", "lever"):
            ending = "_handle_joint" if about == "lever" else f"_knob_{self.knob}_joint"
            names = [j.removesuffix(ending) for j in self.joints if j.endswith(ending)]
            if about == "knob":
                return names, f"has no joint '...{ending}'" if self.knob else "names no knob ('task_refs')"
            # refrigerators and ovens have handles too
            return [name for name in names if f"{name}_spout_joint" in self.joints], f"has no sink with a joint '...{ending}'"
        references = list(self.references.values())
        if about == "cooked food":
            return references, "names no fixture ('fixture_refs')"
        word = "slidejoint" if about == "drawer" else "door"
        names = [r for r in references if any(j.startswith(f"{r}_") and word in j.removeprefix(r) for j in self.joints)]
        return (
            names,
            f"names no fixture with a {'drawer' if about == 'drawer' else 'door'} ('fixture_refs': {alternatives(references)})",
        )


class _Bodies(dict[str, int]):
    """Bodies by name; one that is missing is an error of the file."""

    def __missing__(self, name: str) -> int:
        raise FormatError(f"names no thing '{name}' that the model has ('object_cfgs': {alternatives(self)})")


class RecordedFixture:
    """A fixture's attributes and regions, as far as they are asked for."""

    def __init__(self, m: Model, name: str, joints: list[str]) -> None:
        self._m, self.name = m, name
        self.door_joint_names = [j for j in joints if j.startswith(f"{name}_") and "door" in j.removeprefix(name)]
        body = m.mj.mj_name2id(m.model, m.mj.mjtObj.mjOBJ_BODY, f"{name}_main")
        if body < 0:
            raise FormatError(f"the model has no fixture '{name}'")
        self._body = int(body)

    def get_int_sites(self, *, relative: bool) -> dict[str, tuple[Array, ...]]:
        """Corners of the interiors, the first and its neighbours along x, y and z, in the fixture's frame or the world's."""
        regions = {}
        for name, center, half in self._boxes("reg_", word="main", without=True):
            p0 = center - half
            corners = [p0, *(p0 + 2 * half * axis for axis in np.eye(3))]
            T_world = self._m.T_world(self._body)
            regions[name] = tuple(corners if relative else [T_world.apply(p) for p in corners])
        if not regions:
            raise FormatError(f"fixture '{self.name}' has no interior ('{self.name}_reg_...')")
        return regions

    def get_reset_regions(self, _env: RecordedEnv, ref: RecordedFixture) -> dict[str, dict[str, Any]]:
        """The stretch of a counter next to a fixture: middle of its top, and width and depth, in the counter's frame."""
        at = self._m.T_world(self._body).inverse().apply(self._m.T_world(ref._body).p)
        tops = [
            (c, h)
            for _, c, h in self._boxes("top", word="visual", without=False)
            if np.all(2 * h[:2] >= np.array(LEAST_M) - 1e-9)
        ]
        if not tops:
            raise FormatError(f"counter '{self.name}' has no top to put something on")
        center, half = min(tops, key=lambda top: float(np.linalg.norm(np.maximum(np.abs(at - top[0])[:2] - top[1][:2], 0.0))))
        low, high = center[0] - half[0], center[0] + half[0]
        middle, width = center[0], 2 * half[0]
        beside = 2 * min(at[0] - low, high - at[0])
        if beside >= LEAST_WIDTH_M:
            middle, width = at[0], beside
        return {"top": {"offset": (middle, center[1], center[2] + half[2]), "size": (width, 2 * half[1])}}

    def _boxes(self, begin: str, *, word: str, without: bool) -> list[tuple[str, Array, Array]]:
        """Boxes of the fixture's own body whose names begin so, and have a word in them, or have not: centre, half sizes."""
        model, prefix = self._m.model, f"{self.name}_{begin}"
        found = []
        for g in range(model.ngeom):
            name = str(model.geom(g).name)
            if name.startswith(prefix) and int(self._owner(g)) == self._body and (word in name.removeprefix(prefix)) != without:
                found.append((name.removeprefix(prefix), model.geom_pos[g].copy(), model.geom_size[g].copy()))
        return found

    def _owner(self, geom: int) -> int:
        return int(self._m.model.geom_bodyid[geom])


def mapping(value: object) -> dict[str, Any]:
    """The value, if it is a dictionary, else an empty one."""
    return value if isinstance(value, dict) else {}
