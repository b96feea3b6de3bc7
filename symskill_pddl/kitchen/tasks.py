"""The tasks: what an episode looks like, and when it is a success. One table, `TASKS`."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from numpy.random import Generator

from symskill_pddl.arena import Kind
from symskill_pddl.demonstrator.poses import hand_pose
from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.episode import Episode, place, uniform
from symskill_pddl.kitchen.judges import covers, in_cabinet, in_rack, inside, is_open, is_shut, let_go, on_counter
from symskill_pddl.kitchen.layout import DINNER, KITCHEN, PLAY, Box, SceneLayout

if TYPE_CHECKING:
    from symskill_pddl.kitchen.physics import Physics

COUNTER_SPOT = Box((0.55, 0.11, 0.0), (0.03, 0.07, 0.0))
"""Where the food to be picked from the counter stands (world): a steep hand is clear of the wrist's singularity here."""
COUNTER_ASIDE = (Box((0.44, -0.285, 0.0), (0.07, 0.022, 0.0)), Box((0.44, -0.415, 0.0), (0.07, 0.020, 0.0)))
"""Where the other foods stand (world), out of the way."""
CABINET_SPOT = Box((-0.08, -0.005, 0.0), (0.025, 0.04, 0.0))
"""Where a food stands in the cabinet, in the cabinet's frame: near the front, where the same steep hand fits in."""
PAN_SPOT = Box((0.0, 0.0, 0.0), (0.02, 0.02, 0.0))
PLATE_SPOT = Box((0.0, 0.0, 0.0), (0.015, 0.015, 0.0))
"""Where a food stands in a pan or on a plate, in the dish's frame."""
SPOTS = {"counter": COUNTER_SPOT, "cabinet": CABINET_SPOT, "pan": PAN_SPOT, "plate": PLATE_SPOT}
PAN_ON_STOVE = Box((layout.BURNER[0], 0.0, 0.0), (0.006, 0.006, 0.0))
PLATE_ON_COUNTER = Box((0.38, 0.16, 0.0), (0.01, 0.01, 0.0))
YAW_DEG = {"counter": (-20.0, 2.0), "cabinet": (-15.0, 15.0), "pan": (-15.0, 10.0), "plate": (-15.0, 5.0)}
"""How far a food is turned; on the counter beside the arm, a hand turned further left meets the wrist's limit."""
STANDING_SHIFT = (0.01, 0.01, 0.0)
"""How far a unit on the counter may stand from its place, to either side [m]."""
HAND_START = Box((0.42, 0.0, 0.32), (0.03, 0.05, 0.04))


# --- drawing


def _draw(
    rng: Generator,
    focus: tuple[str, ...],
    food: str | None,
    food_on: str,
    door_deg: tuple[float, float] = (0.0, 0.0),
    **opened: tuple[float, float],
) -> Episode:
    """An episode with `food` (one of the focus, or any) at a spot of the counter, the cabinet or a dish, and the others aside.

    `opened` says between which positions other parts than the door are; those not named are shut.
    """
    # streams of their own: what is added to the kitchen leaves the rest of an episode as it was
    more, dishes = rng.spawn(1)[0], rng.spawn(1)[0]
    names = list(KITCHEN.of_type("food"))
    main = food or names[int(rng.integers(len(names)))]
    spot = place(rng, food_on, SPOTS[food_on], YAW_DEG[food_on])
    aside = rng.permutation(len(COUNTER_ASIDE))
    others = [name for name in names if name != main]
    foods = {main: spot} | {
        name: place(rng, "counter", COUNTER_ASIDE[int(i)], YAW_DEG["counter"]) for name, i in zip(others, aside, strict=True)
    }
    shifts = {"cabinet": uniform(rng, Box((0.0, 0.0, 0.0), (0.02, 0.02, 0.02)))}
    positions = {"door": math.radians(float(rng.uniform(*door_deg)))}
    for name in KITCHEN.units:
        if name not in shifts:
            shifts[name] = uniform(more, Box((0.0, 0.0, 0.0), STANDING_SHIFT))
    for name in KITCHEN.parts:
        if name not in positions:
            positions[name] = float(more.uniform(*opened.get(name, (0.0, 0.0))))
    start = _hand_start(rng)
    loose = {name: foods[name] for name in names}
    loose["pan"] = place(dishes, "stove", PAN_ON_STOVE, (-5.0, 5.0))
    loose["plate"] = place(dishes, "counter", PLATE_ON_COUNTER, (-5.0, 5.0))
    return Episode(tuple(main if name == "food" else name for name in focus), shifts, positions, loose, start)


def _hand_start(rng: Generator) -> Pose:
    yaw, pitch = (math.radians(float(rng.uniform(*limits))) for limits in ((-10.0, 10.0), (65.0, 85.0)))
    return hand_pose(uniform(rng, HAND_START), yaw, pitch)


def _anywhere(rng: Generator) -> str:
    return ("counter", "cabinet")[int(rng.integers(2))]


def _with_part(part: str, *start: float, door_deg: tuple[float, float] = (0.0, 0.0)) -> Callable[[Generator], Episode]:
    """Episodes about a part, at first shut or somewhere between the two positions of `start`."""
    focus, opened = (part, layout.PARTS[part].unit), {part: (start[0], start[1])} if start else {}
    return lambda rng: _draw(rng, focus, None, _anywhere(rng), door_deg, **opened)


def _food(start: str, end: str, door_deg: tuple[float, float] = (0.0, 0.0)) -> Callable[[Generator], Episode]:
    """Episodes about a food that is at `start` and belongs at `end`."""
    return lambda rng: _draw(rng, ("food", start, end), None, start, door_deg)


def _laid(focus: tuple[str, ...], scene: SceneLayout, **spots: tuple[str, Box]) -> Callable[[Generator], Episode]:
    """Episodes with a shut cabinet and foods at spots of their own."""

    def draw(rng: Generator) -> Episode:
        episode = _draw(rng, focus, "cheese", "cabinet")
        own = rng.spawn(1)[0]
        loose = episode.loose | {name: place(own, on, box, YAW_DEG.get(on, (-5.0, 5.0))) for name, (on, box) in spots.items()}
        # a second hob stands flush with the first
        shifts = {name: episode.shifts[name if name in episode.shifts else "stove"] for name in scene.units}
        positions = {name: episode.positions.get(name, 0.0) for name in scene.parts}
        return replace(episode, shifts=shifts, positions=positions, loose={name: loose[name] for name in scene.loose})

    return draw


def _cheese(start: str) -> Callable[[Generator], Episode]:
    """Episodes about a cheese at `start` and a shut cabinet."""
    return lambda rng: _draw(rng, ("cheese", "cabinet", "counter", "door"), "cheese", start)


def _play(lid_on: str | None = None, **things: str) -> Callable[[Generator], Episode]:
    """Episodes of the play scene: the lid on the pan or in the rack, the things in dishes; where not said, anywhere."""

    def draw(rng: Generator) -> Episode:
        shifts = {name: uniform(rng, Box((0.0, 0.0, 0.0), STANDING_SHIFT)) for name in PLAY.units}
        loose = {"pan": place(rng, "stove", Box((0.0, 0.0, 0.0), (0.006, 0.006, 0.0)), (-5.0, 5.0))}
        on = lid_on or ("pan", "dish-rack")[int(rng.integers(2))]
        loose["lid"] = place(rng, on, Box((0.0, 0.0, 0.0), (0.002 if on == "pan" else 0.01,) * 2 + (0.0,)), (-5.0, 5.0))
        for name, spot in PLAY_PLATES.items():
            loose[name] = place(rng, "counter", spot, (-5.0, 5.0))
        dishes = list(rng.permutation(["pan", *PLAY_PLATES]))
        for name in PLAY.of_type("thing"):
            taken = [loose[other].on for other in PLAY.of_type("thing") if other in loose]
            dish = things.get(name) or next(d for d in dishes if d not in taken and d not in things.values())
            loose[name] = place(rng, dish, PLATE_SPOT, (-15.0, 5.0))
        loose = {name: loose[name] for name in PLAY.loose}
        return Episode((*PLAY.loose, "dish-rack"), shifts, {}, loose, _hand_start(rng))

    return draw


PLAY_PLATES = {"red-plate": Box((0.40, 0.22, 0.0), (0.01, 0.01, 0.0)), "white-plate": Box((0.58, 0.22, 0.0), (0.01, 0.01, 0.0))}
"""Where the plates stand in the play scene (world)."""


# --- judging


@dataclass(frozen=True)
class TaskSpec:
    """A task.

    Attributes
    ----------
    name : str
    draw : callable
        `draw(rng) -> Episode`.
    judge : callable
        `judge(physics, focus) -> bool`: success, for the objects that the task is about.
    kind : Kind
    scene : SceneLayout
    goal_of : tuple of (str, tuple of str)
        Of a composed task: the atomic tasks whose goals together are its goal, and what each is about.
    goal_at : tuple of (str, str)
        Of a goal in the play scene: what is to be where.
    """

    name: str
    draw: Callable[[Generator], Episode]
    judge: Callable[[Physics, tuple[str, ...]], bool]
    kind: Kind = "atomic"
    scene: SceneLayout = KITCHEN
    goal_of: tuple[tuple[str, tuple[str, ...]], ...] = ()
    goal_at: tuple[tuple[str, str], ...] = ()

    @property
    def composite(self) -> bool:
        """Whether no demonstration of it exists: it is solved with what was learned from others."""
        return bool(self.goal_of or self.goal_at)


def _opened(physics: Physics, focus: tuple[str, ...]) -> bool:
    return is_open(physics, focus[0])


def _shut(physics: Physics, focus: tuple[str, ...]) -> bool:
    return is_shut(physics, focus[0])


def _on_counter(physics: Physics, focus: tuple[str, ...]) -> bool:
    return on_counter(physics, focus[0]) and let_go(physics, focus[0])


def _in_cabinet(physics: Physics, focus: tuple[str, ...]) -> bool:
    return in_cabinet(physics, focus[0]) and let_go(physics, focus[0])


def _in_dish(physics: Physics, focus: tuple[str, ...]) -> bool:
    return inside(physics, focus[0], focus[2]) and let_go(physics, focus[0])


ATOMIC = (
    TaskSpec("OpenSingleDoor", _with_part("door"), _opened),
    TaskSpec("CloseSingleDoor", _with_part("door", door_deg=(75.0, 100.0)), _shut),
    TaskSpec("PnPCabToCounter", _food("cabinet", "counter", (85.0, 105.0)), _on_counter),
    TaskSpec("PnPCounterToCab", _food("counter", "cabinet", (85.0, 105.0)), _in_cabinet),
    TaskSpec("PnPStoveToCounter", _food("pan", "plate"), _in_dish),
    TaskSpec("PnPCounterToStove", _food("plate", "pan"), _in_dish),
    TaskSpec("OpenDrawer", _with_part("drawer"), _opened),
    TaskSpec("CloseDrawer", _with_part("drawer", 0.14, 0.185), _shut),
    TaskSpec("TurnOnStove", _with_part("knob"), _opened),
    TaskSpec("TurnOffStove", _with_part("knob", 1.45, 1.75), _shut),
    TaskSpec("TurnOnSinkFaucet", _with_part("lever"), _opened),
    TaskSpec("TurnOffSinkFaucet", _with_part("lever", 1.1, 1.35), _shut),
)
_BY_NAME = {spec.name: spec for spec in ATOMIC}


def _composed(
    name: str, draw: Callable[[Generator], Episode], *goals: tuple[str, tuple[str, ...]], scene: SceneLayout = KITCHEN
) -> TaskSpec:
    """A task whose goal is that of several atomic tasks, each about its own objects."""

    def judge(physics: Physics, _focus: tuple[str, ...]) -> bool:
        return all(_BY_NAME[task].judge(physics, about) for task, about in goals)

    return TaskSpec(name, draw, judge, "composed", scene, goal_of=goals)


COMPOSED = (
    _composed(
        "StoreCheese",
        _cheese("cabinet"),
        ("PnPCabToCounter", ("cheese", "cabinet", "counter")),
        ("CloseSingleDoor", ("door", "cabinet")),
    ),
    _composed(
        "PutCheeseAway",
        _cheese("counter"),
        ("PnPCounterToCab", ("cheese", "counter", "cabinet")),
        ("CloseSingleDoor", ("door", "cabinet")),
    ),
)


def _spot(x: float, y: float, half: float = 0.006) -> Box:
    return Box((x, y, 0.0), (half, half, 0.0))


BREAKFAST = (
    ("PnPCabToCounter", ("cheese", "cabinet", "counter")),
    ("PnPCounterToStove", ("bread", "plate", "pan")),
    ("TurnOnStove", ("knob", "stove")),
    ("OpenDrawer", ("drawer", "drawer-unit")),
)
DINNER_GOALS = (
    ("PnPCabToCounter", ("cheese", "cabinet", "counter")),
    ("PnPStoveToCounter", ("can", "pan", "plate")),
    ("PnPCounterToStove", ("butter", "plate-2", "pan")),
    ("PnPCounterToStove", ("bread", "plate", "pan-2")),
    ("TurnOnStove", ("knob", "stove")),
    ("TurnOnStove", ("knob-2", "stove-2")),
    ("TurnOnSinkFaucet", ("lever", "sink")),
    ("OpenDrawer", ("drawer", "drawer-unit")),
    ("CloseSingleDoor", ("door", "cabinet")),
)


def _about(goals: tuple[tuple[str, tuple[str, ...]], ...]) -> tuple[str, ...]:
    """What all goals together are about; the door too, as the cabinet is shut."""
    return tuple(dict.fromkeys([*(name for _, focus in goals for name in focus), "door"]))


LONG = (
    _composed("MakeBreakfast", _laid(_about(BREAKFAST), KITCHEN, bread=("plate", PLATE_SPOT)), *BREAKFAST),
    _composed(
        "CookDinner",
        _laid(
            _about(DINNER_GOALS),
            DINNER,
            # in the pan there is room for what leaves it and for what comes, in whatever order
            can=("pan", _spot(0.042, 0.0)),
            butter=("plate-2", PLATE_SPOT),
            # what goes into a pan comes from the robot's left of it, as in the demonstrations: the way in that is learned from
            # them rises over the wall on that side only
            plate=("counter", _spot(0.37, 0.003, 0.004)),
            bread=("counter", _spot(0.485, 0.0)),
            **{
                "plate-2": ("counter", _spot(0.38, 0.168)),
                "pan-2": ("stove-2", Box((PAN_ON_STOVE.center[0], -0.025, 0.0), PAN_ON_STOVE.half)),
            },
        ),
        *DINNER_GOALS,
        scene=DINNER,
    ),
)
"""Goals of 12 and 24 operators: opening the door and shutting it takes four each, everything else two."""


def _tidy(physics: Physics, _focus: tuple[str, ...]) -> bool:
    """Every thing lies in a dish, the lid on the pan or in the rack, and the hand is away from all of them."""
    dishes, things = PLAY.of_type("cookware", "drawer", "container"), PLAY.of_type("thing")
    stowed = all(any(inside(physics, thing, dish) for dish in dishes) for thing in things)
    lid = covers(physics, "lid", "pan") or in_rack(physics, "lid", "dish-rack")
    return stowed and lid and all(let_go(physics, name) for name in (*things, "lid"))


def _arranged(*goals: tuple[str, str]) -> Callable[[Physics, tuple[str, ...]], bool]:
    """What is to be where is there, and let go of."""

    def there(physics: Physics, name: str, where: str) -> bool:
        if name != "lid":
            return inside(physics, name, where)
        return covers(physics, name, where) if where == "pan" else in_rack(physics, name, where)

    return lambda physics, _focus: all(there(physics, *goal) and let_go(physics, goal[0]) for goal in goals)


def _play_goal(name: str, draw: Callable[[Generator], Episode], *goals: tuple[str, str]) -> TaskSpec:
    return TaskSpec(name, draw, _arranged(*goals), "play goal", PLAY, goal_at=goals)


PLAYING = (
    TaskSpec("Play", _play(), _tidy, "play", PLAY),
    _play_goal("PlayServe", _play("pan", block="pan", bread="red-plate"), ("block", "white-plate")),
    _play_goal("PlayCookAndCover", _play("pan", block="red-plate", bread="white-plate"), ("bread", "pan"), ("lid", "pan")),
    _play_goal(
        "PlaySwap",
        _play("pan", block="pan", bread="white-plate"),
        ("block", "red-plate"), ("bread", "pan"), ("lid", "pan"),
    ),
)  # fmt: skip

TASKS: dict[str, TaskSpec] = {spec.name: spec for spec in (*ATOMIC, *COMPOSED, *LONG, *PLAYING)}


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
