"""The tasks: what an episode looks like, and when it is a success. One table, `TASKS`.

Judges read the simulator's state: joint angle, region, rest, hand away. Learned controllers never see them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.random import Generator

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.layout import Box, Vec3, hand_pose

if TYPE_CHECKING:
    from symskill_pddl.kitchen.physics import Physics

AT_REST = 0.01
"""Speed below which a food is at rest [m/s]."""
HAND_AWAY = 0.08
"""Least distance from the grip point to a food that was let go of [m]."""

COUNTER_REGION = Box((0.42, 0.0, 0.025), (0.20, 0.55, 0.025))
"""Where a food counts as being on the counter (world): what the arm reaches of it."""
COUNTER_SPOT = Box((0.55, 0.11, 0.0), (0.03, 0.07, 0.0))
"""Where the food to be picked from the counter stands (world): a steep hand is clear of the wrist's singularity here."""
COUNTER_ASIDE = (Box((0.46, -0.25, 0.0), (0.08, 0.04, 0.0)), Box((0.46, -0.42, 0.0), (0.08, 0.04, 0.0)))
"""Where the other foods stand (world), out of the way."""
CABINET_SPOT = Box((-0.08, -0.005, 0.0), (0.025, 0.04, 0.0))
"""Where a food stands in the cabinet, in the cabinet's frame: near the front, where the same steep hand fits in."""
STANDING_SHIFT = (0.01, 0.01, 0.0)
"""How far a unit on the counter may stand from its place, to either side [m]."""
HAND_START = Box((0.42, 0.0, 0.32), (0.03, 0.05, 0.04))


@dataclass(frozen=True)
class Place:
    """Where a food stands: 'counter' or 'cabinet', (x, y) [m] in the frame of the world or the cabinet, and the yaw [rad]."""

    on: str
    x: float
    y: float
    yaw: float


@dataclass(frozen=True, eq=False)
class Episode:
    """What is drawn from the seed.

    Attributes
    ----------
    focus : tuple of str
        Objects the task is about.
    shifts : dict of str to (float, float, float)
        Where the units stand or hang, relative to the layout [m].
    positions : dict of str to float
        How far the parts are open [rad] or [m].
    foods : dict of str to Place
    T_start : Pose
        Start pose of the hand.
    """

    focus: tuple[str, ...]
    shifts: dict[str, Vec3]
    positions: dict[str, float]
    foods: dict[str, Place]
    T_start: Pose

    @property
    def cabinet_shift(self) -> Vec3:
        """[m]"""
        return self.shifts["cabinet"]

    def must_reach(self, T_world_door: Pose) -> tuple[Pose, ...]:
        """Hand poses without which the task cannot be done: the foods of the focus, and the handle where the door is."""
        poses = [
            hand_pose(food_pose(name, place, self.cabinet_shift).p, place.yaw, math.radians(78.0))
            for name, place in self.foods.items()
            if name in self.focus
        ]
        if "door" in self.focus and self.positions["door"] < layout.PARTS["door"].opened / 2:
            poses.append(hand_pose(T_world_door.apply(layout.HANDLE), math.radians(15.0), math.radians(42.0)))
        return tuple(poses)


def food_pose(name: str, place: Place, cabinet_shift: Vec3) -> Pose:
    """`T_world_food` of a food standing at a place."""
    height = layout.FOODS[name][2] + 0.001
    yaw = [math.cos(place.yaw / 2), 0.0, 0.0, math.sin(place.yaw / 2)]
    if place.on == "counter":
        return Pose(np.array([place.x, place.y, height]), np.array(yaw))
    floor = layout.CABINET_INSIDE.center[2] - layout.CABINET_INSIDE.half[2]
    center = np.asarray(layout.CABINET.center) + np.asarray(cabinet_shift)
    return Pose(center + np.array([place.x, place.y, floor + height]), np.array(yaw))


# --- drawing


def _uniform(rng: Generator, box: Box) -> tuple[float, float, float]:
    x, y, z = (float(c + h * rng.uniform(-1.0, 1.0)) for c, h in zip(box.center, box.half, strict=True))
    return x, y, z


def _place(rng: Generator, on: str, box: Box) -> Place:
    x, y, _ = _uniform(rng, box)
    # on the counter beside the arm, a hand turned further left meets the wrist's limit
    low, high = (-15.0, 15.0) if on == "cabinet" else (-20.0, 2.0)
    return Place(on, x, y, math.radians(float(rng.uniform(low, high))))


def _draw(
    rng: Generator,
    focus: tuple[str, ...],
    food: str | None,
    food_on: str,
    door_deg: tuple[float, float] = (0.0, 0.0),
    **opened: tuple[float, float],
) -> Episode:
    """An episode with `food` (one of the focus, or any) on the counter's spot or in the cabinet, and the others aside.

    `opened` says between which positions other parts than the door are; those not named are shut.
    """
    # a stream of its own: what is added to the kitchen leaves the rest of an episode as it was
    more = rng.spawn(1)[0]
    names = list(layout.FOODS)
    main = food or names[int(rng.integers(len(names)))]
    spot = _place(rng, food_on, CABINET_SPOT if food_on == "cabinet" else COUNTER_SPOT)
    aside = rng.permutation(len(COUNTER_ASIDE))
    others = [name for name in names if name != main]
    foods = {main: spot} | {name: _place(rng, "counter", COUNTER_ASIDE[int(i)]) for name, i in zip(others, aside, strict=True)}
    shifts = {"cabinet": _uniform(rng, Box((0.0, 0.0, 0.0), (0.02, 0.02, 0.02)))}
    positions = {"door": math.radians(float(rng.uniform(*door_deg)))}
    for name in layout.UNITS:
        if name not in shifts:
            shifts[name] = _uniform(more, Box((0.0, 0.0, 0.0), STANDING_SHIFT))
    for name in layout.PARTS:
        if name not in positions:
            positions[name] = float(more.uniform(*opened.get(name, (0.0, 0.0))))
    yaw, pitch = (math.radians(float(rng.uniform(*limits))) for limits in ((-10.0, 10.0), (65.0, 85.0)))
    start = hand_pose(_uniform(rng, HAND_START), yaw, pitch)
    focus = tuple(main if name == "food" else name for name in focus)
    return Episode(focus, shifts, positions, {name: foods[name] for name in names}, start)


def _anywhere(rng: Generator) -> str:
    return ("counter", "cabinet")[int(rng.integers(2))]


def _open_door(rng: Generator) -> Episode:
    return _draw(rng, ("door", "cabinet"), None, _anywhere(rng))


def _close_door(rng: Generator) -> Episode:
    return _draw(rng, ("door", "cabinet"), None, _anywhere(rng), (75.0, 100.0))


def _with_part(part: str, *start: float) -> Callable[[Generator], Episode]:
    """Episodes about a part of a unit on the counter, at first shut or somewhere between the two positions of `start`."""
    focus, opened = (part, layout.PARTS[part].unit), {part: (start[0], start[1])} if start else {}
    return lambda rng: _draw(rng, focus, None, _anywhere(rng), **opened)


def _cab_to_counter(rng: Generator) -> Episode:
    return _draw(rng, ("food", "cabinet", "counter"), None, "cabinet", (85.0, 105.0))


def _counter_to_cab(rng: Generator) -> Episode:
    return _draw(rng, ("food", "cabinet", "counter"), None, "counter", (85.0, 105.0))


def _store_cheese(rng: Generator) -> Episode:
    return _draw(rng, ("cheese", "cabinet", "counter", "door"), "cheese", "cabinet", (0.0, 0.0))


# --- judging


def _food_of(episode: Episode) -> str:
    return next(name for name in episode.focus if name in layout.FOODS)


def hand_off(physics: Physics, part: str) -> bool:
    """The hand touches the part nowhere and does not enclose what it is taken by."""
    grip = physics.T_world(part).apply(layout.PARTS[part].grip)
    return not physics.robot_touches(part) and float(np.linalg.norm(physics.T_world_ee().p - grip)) > HAND_AWAY


def is_open(physics: Physics, part: str) -> bool:
    """The part is open far enough and let go of."""
    return physics.position(part) >= layout.PARTS[part].opened and hand_off(physics, part)


def is_shut(physics: Physics, part: str) -> bool:
    """The part is shut and let go of."""
    return physics.position(part) <= layout.PARTS[part].shut and hand_off(physics, part)


def let_go(physics: Physics, food: str) -> bool:
    """The food is at rest and the hand away from it."""
    distance = float(np.linalg.norm(physics.T_world_ee().p - physics.T_world(food).p))
    return physics.speed(food) < AT_REST and distance > HAND_AWAY and not physics.robot_touches(food)


def on_counter(physics: Physics, food: str) -> bool:
    """The food lies on the counter, within the region."""
    return COUNTER_REGION.contains(physics.T_world(food).p)


def in_cabinet(physics: Physics, food: str) -> bool:
    """The food lies on the cabinet's floor."""
    p = (physics.T_world("cabinet").inverse() @ physics.T_world(food)).p
    floor = layout.CABINET_INSIDE.center[2] - layout.CABINET_INSIDE.half[2]
    return layout.CABINET_INSIDE.contains(p) and bool(p[2] - floor < 0.06)


def _opened(physics: Physics, episode: Episode) -> bool:
    return is_open(physics, episode.focus[0])


def _shut(physics: Physics, episode: Episode) -> bool:
    return is_shut(physics, episode.focus[0])


def _on_counter(physics: Physics, episode: Episode) -> bool:
    food = _food_of(episode)
    return on_counter(physics, food) and let_go(physics, food)


def _in_cabinet(physics: Physics, episode: Episode) -> bool:
    food = _food_of(episode)
    return in_cabinet(physics, food) and let_go(physics, food)


@dataclass(frozen=True)
class TaskSpec:
    """A task: its name, how an episode is drawn, its judge, and the atomic tasks whose goals together are its goal."""

    name: str
    draw: Callable[[Generator], Episode]
    judge: Callable[[Physics, Episode], bool]
    goal_of: tuple[str, ...] = ()

    @property
    def composite(self) -> bool:
        """Whether no demonstration of it exists: it is solved with what was learned from others."""
        return bool(self.goal_of)


TASKS: dict[str, TaskSpec] = {
    spec.name: spec
    for spec in (
        TaskSpec("OpenSingleDoor", _open_door, _opened),
        TaskSpec("CloseSingleDoor", _close_door, _shut),
        TaskSpec("PnPCabToCounter", _cab_to_counter, _on_counter),
        TaskSpec("PnPCounterToCab", _counter_to_cab, _in_cabinet),
        TaskSpec("OpenDrawer", _with_part("drawer"), _opened),
        TaskSpec("CloseDrawer", _with_part("drawer", 0.14, 0.185), _shut),
        TaskSpec("TurnOnStove", _with_part("knob"), _opened),
        TaskSpec("TurnOffStove", _with_part("knob", 1.45, 1.75), _shut),
        TaskSpec("TurnOnSinkFaucet", _with_part("lever"), _opened),
        TaskSpec("TurnOffSinkFaucet", _with_part("lever", 1.1, 1.35), _shut),
        TaskSpec(
            "StoreCheese",
            _store_cheese,
            lambda physics, episode: _on_counter(physics, episode) and is_shut(physics, "door"),
            goal_of=("PnPCabToCounter", "CloseSingleDoor"),
        ),
    )
}


def task_named(name: str) -> TaskSpec:
    """The task of that name.

    Raises
    ------
    InputError
        There is none.
    """
    try:
        return TASKS[name]
    except KeyError:
        raise InputError(f"unknown task '{name}'; the kitchen has: {alternatives(TASKS)}") from None
