"""A kinematic world and a library made by hand: a food, a counter, and a cabinet behind a door."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from symskill_pddl.abstraction import Classifier
from symskill_pddl.geometry import Pose, quat_conjugate, quat_log, quat_multiply
from symskill_pddl.library import LearnedOperator, Library
from symskill_pddl.scene import GRIPPER, Command, Scene
from symskill_pddl.skills import Phase, Skill
from symskill_pddl.symbols import Absent, Atom, Operator, Parameter, Predicate, Type

DOWN = np.array([0.0, 1.0, 0.0, 0.0])
"""Hand with its approach direction straight down."""
HINGE, RADIUS = np.array([0.45, 0.05, 0.5]), 0.3
CABINET, COUNTER = np.array([0.6, 0.2, 0.4]), np.array([0.4, -0.4, 0.0])
HOME = Pose([0.2, -0.1, 0.35], DOWN)
OBJECTS = {"cheese": "food", "cabinet": "cabinet", "counter": "counter", "door": "door"}
WIDTH = 0.03


def at(x: float, y: float, z: float, q: np.ndarray | None = None) -> Pose:
    return Pose([x, y, z], [1.0, 0, 0, 0] if q is None else q)


def handle(angle: float) -> Pose:
    return Pose.from_rotvec(HINGE + RADIUS * np.array([-np.sin(angle), np.cos(angle), 0.0]), [0.0, 0.0, angle])


class FakeWorld:
    """The hand goes where it is told; what is near when the fingers close follows it; the door turns about its hinge."""

    period_s = 0.05

    def __init__(self, *, cheese: Pose | None = None, angle: float = 0.0, ee: Pose = HOME, closed: bool = False) -> None:
        self.time, self.ee, self.closed = 0.0, ee, closed
        self.aperture = 0.0 if closed else 0.08
        self.angle = angle
        self.cheese = Pose(COUNTER + np.array([0.02, 0, 0.03]), [1.0, 0, 0, 0]) if cheese is None else cheese
        self.grasp: Pose | None = None
        self.on_door = False
        self.slippery = 0
        """How many grasps fail before one holds."""
        self.frozen = False
        self.stuck_fingers = False
        self.todo: list[tuple[float, Callable[[], None]]] = []

    def after(self, seconds: float, action: Callable[[], None]) -> None:
        self.todo.append((self.time + seconds, action))

    def observe(self) -> Scene:
        poses = {
            "cheese": self.cheese,
            "cabinet": Pose(CABINET, [1.0, 0, 0, 0]),
            "counter": Pose(COUNTER, [1.0, 0, 0, 0]),
            "door": handle(self.angle),
        }
        return Scene(self.time, self.ee, self.aperture, self.closed, OBJECTS, Pose.stack([poses[o] for o in OBJECTS]))

    def step(self, command: Command) -> Scene:
        self.time = round(self.time + self.period_s, 9)
        if not self.frozen:
            v, w = command.twist[:3], command.twist[3:]
            turned = Pose.from_rotvec(np.zeros(3), w * self.period_s)
            self.ee = Pose(self.ee.p + v * self.period_s, quat_multiply(turned.q, self.ee.q))
        self._fingers(command.close_gripper)
        if self.grasp is not None:
            self.cheese = self.ee @ self.grasp
        if self.on_door:
            x, y = (self.ee.p - HINGE)[:2]
            self.angle = float(np.clip(np.arctan2(-x, y), 0.0, 1.8))
        for due in [t for t in self.todo if t[0] <= self.time]:
            self.todo.remove(due)
            due[1]()
        return self.observe()

    def _fingers(self, close: bool) -> None:
        self.closed = close
        near = np.linalg.norm(self.cheese.p - self.ee.p) < 0.035
        at_handle = np.linalg.norm(handle(self.angle).p - self.ee.p) < 0.04
        if self.stuck_fingers:
            self.aperture += 0.02 * self.period_s * (1 if (round(self.time / self.period_s) % 2) else -1)
            return
        if not close:
            self.aperture = min(0.08, self.aperture + 0.3 * self.period_s)
            if self.aperture > WIDTH + 0.005:
                self.drop()
                self.on_door = False
            return
        least = WIDTH if near or at_handle or self.grasp is not None else 0.0
        self.aperture = max(least, self.aperture - 0.3 * self.period_s)
        if self.aperture == WIDTH and self.grasp is None and not self.on_door:
            if near and self.slippery > 0:
                self.slippery -= 1
                self.cheese = Pose(self.cheese.p + np.array([0.06, 0, 0]), self.cheese.q)
            elif near:
                self.grasp = self.ee.inverse() @ self.cheese
            elif at_handle:
                self.on_door = True

    def drop(self) -> None:
        """The cheese falls onto what is below it."""
        if self.grasp is None:
            return
        self.grasp = None
        x, y, z = self.cheese.p
        inside = np.all(np.abs(self.cheese.p - CABINET)[:2] < 0.15) and z > 0.35
        self.cheese = at(x, y, CABINET[2] + 0.05 if inside else 0.03)

    def shut(self, angle: float = 0.0) -> None:
        if not self.on_door:
            self.angle = angle


@dataclass(frozen=True)
class Linear:
    """A trivially stable field: straight to the goal."""

    T_goal: Pose
    gain: float = 3.0
    cap: float = 0.5

    @property
    def max_period_s(self) -> float:
        return 2.0 / self.gain

    def twist_at(self, p: np.ndarray, q: np.ndarray) -> np.ndarray:
        v = self.gain * (self.T_goal.p - p)
        v = v * min(1.0, self.cap / max(float(np.linalg.norm(v)), 1e-12))
        return np.concatenate([v, self.gain * quat_log(quat_multiply(self.T_goal.q, quat_conjugate(q)))])


def phase(frame: str, goal: Pose, closed: bool, duration_s: float = 1.5) -> Phase:
    return Phase(frame, Linear(goal), closed, 0.008, 0.05, duration_s)  # type: ignore[arg-type]


def classifier(name: str, child: str, parent: str, mean: Pose, sd_p: float, sd_r: float = 0.3) -> Classifier:
    types = (parent,) if child == GRIPPER else (child, parent)
    return Classifier(Predicate(name, types), child, parent, mean, np.eye(3) * sd_p**2, np.eye(3) * sd_r**2, 3.0, 3.0)


def atoms(*texts: str) -> frozenset[Atom]:
    return frozenset(Atom(*(lambda w: (w[0], tuple(w[1:])))(t.split())) for t in texts)


def operator(name: str, parameters: str, *sets: Iterable[str]) -> Operator:
    """`sets` are pre, add, delete, maintain, absent."""
    *positive, absent = (atoms(*s) for s in sets)
    return Operator(name, tuple(Parameter(f"?{t}", t) for t in parameters.split()), *positive, frozenset(map(Absent, absent)))


def make_library() -> Library:
    to_cabinet = lambda T: at(*(T.p - CABINET), T.q)  # noqa: E731
    hand = Pose([0, 0, 0], DOWN)
    above = Pose([0, 0, 0.1], DOWN)
    classifiers = (
        classifier("gripper-holds-food", GRIPPER, "food", hand, 0.01),
        classifier("gripper-holds-door", GRIPPER, "door", hand, 0.015, 1.0),
        classifier("food-in-cabinet", "food", "cabinet", at(0, 0, 0.05), 0.02),
        classifier("food-on-counter", "food", "counter", at(0, 0, 0.03), 0.05),
        classifier("door-closed", "door", "cabinet", to_cabinet(handle(0.0)), 0.02, 0.06),
        classifier("door-open", "door", "cabinet", to_cabinet(handle(1.5)), 0.02, 0.06),
    )

    def hold_at(T: Pose) -> Pose:
        return Pose(to_cabinet(T).p, DOWN)

    skills = {
        "pick": Skill((phase("?food", above, False), phase("?food", hand, False, 0.8)), True),
        "place-cabinet": Skill(
            (phase("?cabinet", Pose([0, 0, 0.05], DOWN), True), phase("?cabinet", Pose([0, 0, 0.2], DOWN), False)), False
        ),
        "place-counter": Skill(
            (phase("?counter", Pose([0, 0, 0.03], DOWN), True), phase("?counter", Pose([0, 0, 0.2], DOWN), False)), False
        ),
        "reach-door": Skill((phase("?door", Pose([0, 0, 0.1], DOWN), False), phase("?door", hand, False)), True),
        "open-door": Skill(
            (
                phase("?cabinet", hold_at(handle(0.5)), True),
                phase("?cabinet", hold_at(handle(1.0)), True),
                phase("?cabinet", hold_at(handle(1.5)), True),
                phase("?cabinet", Pose(hold_at(handle(1.5)).p + np.array([0, 0, 0.15]), DOWN), False),
            ),
            False,
        ),
    }
    holds, holds_door = "gripper-holds-food ?food", "gripper-holds-door ?door"
    opened, closed = "door-open ?door ?cabinet", "door-closed ?door ?cabinet"
    there, inside = "food-on-counter ?food ?counter", "food-in-cabinet ?food ?cabinet"
    free, both = "gripper-open", {holds, opened}
    # name, kind, skill, parameters, pre, add, delete, maintain, absent
    table = (
        ("pick-from-counter", "pick", "pick", "food counter", {free, there}, {holds}, {free, there}, {free, there}, ()),
        ("pick-from-cabinet", "pick", "pick", "food cabinet door", {free, inside, opened}, {holds}, {free, inside}, {opened}, ()),
        ("place-in-cabinet", "place", "place-cabinet", "food cabinet door", both, {free, inside}, {holds}, both, {free}),
        ("place-on-counter", "place", "place-counter", "food counter", {holds}, {free, there}, {holds}, {holds}, {free}),
        ("reach-closed-door", "reach", "reach-door", "door cabinet", {free, closed}, {holds_door}, {free, closed}, (), ()),
        ("open-door", "move", "open-door", "door cabinet", {holds_door}, {free, opened}, {holds_door}, {holds_door}, ()),
    )
    operators = tuple(
        LearnedOperator(operator(name, parameters, *sets), atoms(*sets[0]), skill, kind, (), (4.0, 5.0))
        for name, kind, skill, parameters, *sets in table
    )
    return Library(
        tuple(Type(t) for t in ("food", "cabinet", "counter", "door")),
        classifiers,
        operators,
        skills,
    )
