from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from symskill_pddl.abstraction import Classifier
from symskill_pddl.execution.lines import (
    GroundStep,
    Header,
    NoteLine,
    OutcomeLine,
    PlanLine,
    RecoveryLine,
    StepLine,
    TickLine,
    VerdictLine,
)
from symskill_pddl.execution.trace import Trace
from symskill_pddl.geometry import Pose
from symskill_pddl.library import Evidence, Goal, LearnedOperator, Library
from symskill_pddl.scene import GRIPPER
from symskill_pddl.skills import Phase, Skill, Trajectory, fit_fields
from symskill_pddl.symbols import Absent, Atom, Operator, Parameter, Predicate, Type

HOLDS, OPEN = Atom("gripper-holds-food", ("?food",)), Atom("gripper-open")
IN, DOOR = Atom("food-in-cabinet", ("?food", "?cabinet")), Atom("door-open-at-cabinet", ("?door", "?cabinet"))
HOSTILE = "<script>alert('x')</script> & \"quotes\""


def classifier(name: str = "food-in-cabinet", child: str = "food", parent: str = "cabinet", **changes: Any) -> Classifier:
    values: dict[str, Any] = {
        "T_mean": Pose.from_rotvec([0.0, -0.02, 0.031], [0, 0, np.radians(90)]),
        "cov_p": np.diag([0.03, 0.02, 0.001]) ** 2,
        "cov_r": np.diag(np.radians([2.0, 2.0, 60.0])) ** 2,
        "enter_p": 3.0,
        "enter_r": 3.5,
    }
    types = (parent,) if child == GRIPPER else (child, parent)
    return Classifier(Predicate(name, types), child, parent, **{**values, **changes})


def make_library(note: str = "dropped (lid-on-pan ?lid ?pan): no argument of this operator") -> Library:
    t = np.linspace(0, 2, 41)
    path = Pose.from_rotvec(np.stack([0.3 * np.cos(t / 1.3), 0.1 * t, 0.2 - 0.1 * t], axis=1), np.zeros((41, 3)))
    (field,) = fit_fields([Trajectory(t, path)])
    skill = Skill((Phase("?food", field, False, 0.01, 0.1, 2.0),), True)
    food, cabinet, door = Parameter("?food", "food"), Parameter("?cabinet", "cabinet"), Parameter("?door", "door")
    pick = Operator("pick-food", (food,), frozenset({OPEN}), frozenset({HOLDS}), frozenset({OPEN}), frozenset({OPEN}), cost=2.5)
    place = Operator(
        "place-food-in-cabinet",
        (food, cabinet, door),
        frozenset({HOLDS, DOOR}),
        frozenset({IN, OPEN}),
        frozenset({HOLDS}),
        frozenset({HOLDS, DOOR}),
        absent=frozenset({Absent(Atom("lid-on-cabinet", ("?lid", "?cabinet")), (Parameter("?lid", "lid"),))}),
    )
    evidence = (
        Evidence("store:demo_0", 1.0, 3.5, (("?food", "cheese"),)),
        Evidence("store:demo_1", 0.5, 2.5, (("?food", "bread"),)),
    )
    return Library(
        types=(Type("food"), Type("cabinet"), Type("door")),
        classifiers=(classifier("gripper-holds-food", GRIPPER, "food"), classifier()),
        operators=(
            LearnedOperator(pick, pick.pre, "pick-food", "pick", evidence, (2.2, 3.0), (note,)),
            LearnedOperator(place, place.pre | {IN}, "gone", "place", evidence[:1], (4.0, 4.0)),
        ),
        skills={"pick-food": skill},
        goals=(Goal("StoreFood", (food, cabinet), frozenset({IN})),),
        extents={"food": (0.03, 0.02, 0.015)},
    )


def _step(name: str, *args: str) -> GroundStep:
    return GroundStep(name=name, args=args, pre=(), add=(), delete=(), maintain=(), absent=(), cost=1.0)


def _start(time: float, index: int, step: GroundStep, verdict: VerdictLine, attempt: int = 0) -> StepLine:
    return StepLine(
        time=time, index=index, step=step, later=(), gripper=(), state=(("gripper-open",),), inherited=(), assumed=(), phases=1,
        exit_s=1, budget_s=10, grace_s=1, stall_s=1, blocked_s=2, still_speed=0.01, still_turn=0.1, attempt=attempt,
        shift=(0, 0, 0, 1, 0, 0, 0) if attempt else None, verdict=verdict,
    )  # fmt: skip


def _tick(time: float, verdict: VerdictLine, added: tuple = (), removed: tuple = ()) -> TickLine:
    return TickLine(
        time=time, stage=0, stage_s=0, settling=False, closing=False, speed=0.1, turn=0.1, rest_s=0, added=added, removed=removed,
        verdict=verdict, ms={"abstract": 0.2 + time / 100, "skill": 0.4},
    )  # fmt: skip


def make_trace(text: str = "cheese was pushed by 6 cm", *, outcome: bool = True) -> Trace:
    """Pick, place; the grasp is lost; recovery; pick again with a moved goal, place."""
    going = VerdictLine(kind="Continue", reason="under way")
    done = VerdictLine(kind="EffectsHold", reason="effects hold")
    lost = VerdictLine(
        kind="Violation",
        reason="the grasp was lost",
        violation="lost grasp",
        atoms=(("gripper-holds-food", "cheese"),),
        blame="acquiring step",
    )
    pick, place = _step("pick-food", "cheese"), _step("place-food-in-cabinet", "cheese", "cabinet", "door")
    steps = (("pick-food", ("cheese",)), ("place-food-in-cabinet", ("cheese", "cabinet", "door")))
    held, inside = ("gripper-holds-food", "cheese"), ("food-in-cabinet", "cheese", "cabinet")
    lines: list[Any] = [
        PlanLine(time=0, reason="start", status="solved", steps=steps, state=(("gripper-open",),), seconds=0.012),
        _start(0, 0, pick, going),
        *(_tick(0.05 * i, going) for i in range(1, 40)),
        _tick(2.0, done, added=(held,)),
        _start(2.05, 1, place, going),
        *(_tick(2.05 + 0.05 * i, going) for i in range(1, 20)),
        NoteLine(time=3.0, text=text),
        _tick(3.1, lost, removed=(held,)),
        RecoveryLine(time=3.15, name="retreat", reason="a lost grasp", result="clear"),
        PlanLine(
            time=4.0,
            reason="lost grasp",
            status="solved",
            steps=steps,
            state=(),
            seconds=0.02,
            messages=("cost of pick-food raised",),
        ),
        _start(4.05, 0, pick, going, attempt=1),
        *(_tick(4.05 + 0.05 * i, going) for i in range(1, 40)),
        _tick(6.05, VerdictLine(kind="JumpAhead", reason="the next step can start", index=1)),
        _start(6.1, 1, place, going),
        _tick(8.0, done, added=(inside,)),
    ]
    if outcome:
        lines.append(
            OutcomeLine(time=8.05, success=True, category="", reason="the goal holds", replans=1, recoveries=1, seconds=3)
        )
    goal = (("food-in-cabinet", "cheese", "cabinet"), ("door-closed-at-cabinet", "door", "cabinet"))
    header = Header(
        task="StoreCheese", seed=3, goal=goal, objects={"cheese": "food", "cabinet": "cabinet"}, planner="gbfs", period_s=0.05
    )
    return Trace(header, tuple(lines))


@pytest.fixture(scope="session")
def new_library() -> Callable[..., Library]:
    return make_library


@pytest.fixture(scope="session")
def new_trace() -> Callable[..., Trace]:
    return make_trace


@pytest.fixture(scope="session")
def hostile() -> str:
    return HOSTILE


@pytest.fixture(scope="session")
def library() -> Library:
    return make_library()


@pytest.fixture
def trace() -> Trace:
    return make_trace()
