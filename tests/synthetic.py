"""Synthetic demonstrations: a kinematic kitchen in which objects follow the hand exactly, with the faults of people on top.

Nothing here knows of learning. The world is as simple as can be (no physics): while `carry` is set, an object or a hinge is a
function of the hand's pose. Noise, pauses, repeated approaches, nudges, poor grasps, distractors and passengers are drawn from
the generator.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.geometry import Pose, quat_exp, quat_log, quat_multiply

DT = 0.05
HOME = np.array([0.35, 0.0, 0.30])
EXTENTS = {"cabinet": (0.15, 0.19, 0.20), "door": (0.009, 0.19, 0.20), "counter": (0.36, 0.60, 0.02), "food": (0.03, 0.03, 0.02)}
HANDLE = np.array([-0.045, 0.335, -0.07])
"""Middle of the bar in the door's frame: on the hinge, x into the cabinet, y along the door, shut."""


def facing(yaw: float, pitch: float) -> np.ndarray:
    """Orientation (4,) of a hand that points `pitch` below the horizon towards `yaw`, fingers opening level."""
    z = np.array([np.cos(pitch) * np.cos(yaw), np.cos(pitch) * np.sin(yaw), -np.sin(pitch)])
    y = np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    T = np.eye(4)
    T[:3, :3] = np.stack([np.cross(y, z), y, z], axis=-1)
    return Pose.from_matrix(T).q


def interpolate(a: Pose, b: Pose, s: np.ndarray) -> Pose:
    turn = quat_log(quat_multiply(b.q, a.q * np.array([1, -1, -1, -1])))
    return Pose(a.p + s[:, None] * (b.p - a.p), quat_multiply(quat_exp(s[:, None] * turn), a.q))


def yaw_pose(p: Sequence[float] | np.ndarray, yaw: float = 0.0) -> Pose:
    return Pose.from_rotvec(np.asarray(p, float), np.array([0.0, 0.0, yaw]))


class Recorder:
    """A hand, some objects, and what was recorded of them."""

    def __init__(self, rng: np.random.Generator, objects: dict[str, tuple[str, Pose]], *, faults: bool = True) -> None:
        self.rng, self.faults = rng, faults
        self.types = {name: type_ for name, (type_, _) in objects.items()}
        self.poses = {name: pose for name, (_, pose) in objects.items()}
        self.T = Pose(HOME + rng.uniform(-0.03, 0.03, 3), facing(rng.uniform(-0.1, 0.1), 0.6 + rng.uniform(-0.1, 0.1)))
        self.closed, self.aperture, self.close_to = False, 0.08, 0.0
        self.carry: Callable[[Pose], dict[str, Pose]] | None = None
        self.rows: list[tuple[Pose, float, bool, dict[str, Pose]]] = []
        self._record()

    def _record(self) -> None:
        self.rows.append((self.T, self.aperture, self.closed, dict(self.poses)))

    def _tick(self, T: Pose) -> None:
        self.T = T
        if self.carry is not None:
            self.poses.update(self.carry(T))
        target = self.close_to if self.closed else 0.08
        self.aperture += np.clip(target - self.aperture, -0.012, 0.012)
        self._record()

    def go(self, *via: Pose, speed: float = 0.14, pause: bool | None = None) -> None:
        """Minimum-jerk legs through `via`; each leg comes to rest for one sample only."""
        for T in via:
            start = self.T
            way = float(np.linalg.norm(T.p - start.p)) + 0.12 * float(
                np.linalg.norm(quat_log(quat_multiply(T.q, start.q * [1, -1, -1, -1])))
            )
            n = max(int(way / (speed * self.rng.uniform(0.8, 1.2)) * 1.5 / DT), 4)
            u = np.linspace(0.0, 1.0, n + 1)[1:]
            path = interpolate(start, T, u**3 * (10 - 15 * u + 6 * u**2))
            bump = np.sin(np.pi * u)[:, None] * self.rng.normal(0, 0.006 if self.carry is None else 0.002, 3)
            stop = (
                int(self.rng.integers(n // 3, n))
                if (pause or (pause is None and self.faults and self.rng.random() < 0.1))
                else -1
            )
            for k in range(n):
                if k == stop:
                    self.rest(self.rng.uniform(0.4, 1.2))
                self._tick(Pose(path.p[k] + bump[k], path.q[k]))

    def rest(self, seconds: float) -> None:
        for _ in range(max(1, round(seconds / DT))):
            self._tick(self.T)

    def fingers(self, close: bool, on: float = 0.0) -> None:
        self.closed, self.close_to = close, on
        self.rest(self.rng.uniform(0.6, 0.9))

    def reach(self, goal: Pose, back: float = 0.10) -> None:
        """Approach along the hand's own direction; with faults, sometimes twice."""
        off = goal @ Pose(np.array([0.0, 0.0, -back]), np.array([1.0, 0, 0, 0]))
        off = Pose(off.p + self.rng.uniform(-0.01, 0.01, 3), off.q)
        self.go(off)
        if self.faults and self.rng.random() < 0.2:
            self.go(Pose(0.4 * off.p + 0.6 * goal.p, goal.q), Pose(off.p + self.rng.uniform(-0.01, 0.01, 3), off.q))
        self.go(goal, speed=0.08)

    def grasp(self, name: str, on: float) -> None:
        self.fingers(True, on)
        T_ee_obj = self.T.inverse() @ self.poses[name]
        self.carry = lambda T: {name: T @ T_ee_obj}

    def release(self) -> None:
        self.carry = None
        self.fingers(False)

    def back_off(self, distance: float) -> None:
        self.go(self.T @ Pose(np.array([0.0, 0.0, -distance]), np.array([1.0, 0, 0, 0])), pause=False)

    def demo(
        self, name: str, source: str, task: str, *, noise_m: float = 0.0007, noise_rad: float = 0.003, extents: bool = True
    ) -> Demo:
        n, objects = len(self.rows), list(self.types)
        p = np.array([[poses[o].p for o in objects] for _, _, _, poses in self.rows])
        q = np.array([[poses[o].q for o in objects] for _, _, _, poses in self.rows])
        p = p + self.rng.normal(0, noise_m, p.shape)
        q = quat_multiply(q, quat_exp(self.rng.normal(0, noise_rad, p.shape)))
        return Demo(
            name=name,
            source=source,
            task=task,
            times=np.arange(n) * DT,
            T_world_ee=Pose.stack([row[0] for row in self.rows]),
            aperture=np.array([row[1] for row in self.rows]),
            gripper_closed=np.array([row[2] for row in self.rows]),
            objects=dict(self.types),
            T_world_objects=Pose(p, q),
            extents={t: e for t, e in EXTENTS.items() if t in self.types.values()} if extents else {},
        )


def kitchen(rng: np.random.Generator, angle: float) -> dict[str, tuple[str, Pose]]:
    """Cabinet with a door open by `angle`, and a counter; placed a little differently each time."""
    T_cabinet = yaw_pose(np.array([0.77, 0.0, 0.67]) + rng.uniform(-0.02, 0.02, 3), rng.uniform(-0.05, 0.05))
    return {
        "cabinet": ("cabinet", T_cabinet),
        "door": ("door", T_cabinet @ hinge(angle)),
        "counter": ("counter", yaw_pose(np.array([0.56, 0.0, -0.02]) + rng.uniform(-0.01, 0.01, 3))),
    }


def hinge(angle: float) -> Pose:
    """`T_cabinet_door` at an opening angle [rad]."""
    return yaw_pose([-0.15, -0.19, 0.0], angle)


def angle_of(recorder: Recorder) -> float:
    return float((recorder.poses["cabinet"].inverse() @ recorder.poses["door"]).rotvec()[2])


def swing(r: Recorder, to: float, hand: Callable[[float], Pose], speed: float) -> None:
    """Turn the door to an angle, the hand where `hand` puts it at each angle."""
    T_cabinet, start = r.poses["cabinet"], angle_of(r)
    n = max(int(abs(to - start) * 0.33 / speed * 1.5 / DT), 8)
    u = np.linspace(0.0, 1.0, n + 1)[1:]
    stop = int(r.rng.integers(n // 3, n)) if r.faults and r.rng.random() < 0.2 else -1
    for k, s in enumerate(u**3 * (10 - 15 * u + 6 * u**2)):
        angle = start + s * (to - start)
        r.poses["door"] = T_cabinet @ hinge(angle)
        if k == stop:
            r.rest(r.rng.uniform(0.4, 1.0))
        r._tick(hand(angle))


def open_door(r: Recorder) -> None:
    """Grasp the bar, pull to about 50 degrees, let go, rest; push the inner face to about 95 degrees; go home."""
    T_cabinet = r.poses["cabinet"]
    up = r.rng.uniform(-0.015, 0.015)

    def bar(angle: float) -> Pose:
        return Pose((T_cabinet @ hinge(angle)).apply(HANDLE + np.array([0, 0, up])), facing(0.25 + 0.6 * angle, 0.0))

    r.reach(bar(angle_of(r)))
    r.fingers(True, 0.014)
    swing(r, np.radians(r.rng.uniform(48, 53)), bar, 0.08)
    r.fingers(False)
    r.back_off(0.09)
    r.rest(r.rng.uniform(0.6, 0.9))
    along, height = r.rng.uniform(0.26, 0.30), r.rng.uniform(-0.12, -0.08)

    def inner(angle: float) -> Pose:
        return Pose((T_cabinet @ hinge(angle)).apply([0.015, along, height]), facing(0.5 - 0.5 * angle, 0.2))

    ajar = angle_of(r)
    door = T_cabinet @ hinge(ajar)
    r.go(Pose(door.apply([-0.10, 0.46, height]), facing(0.6, 0.1)), Pose(door.apply([0.06, 0.44, height]), facing(0.3, 0.2)))
    r.fingers(True)
    r.go(inner(ajar), speed=0.08)
    swing(r, np.radians(r.rng.uniform(92, 98)), inner, 0.08)
    r.go(Pose((T_cabinet @ hinge(angle_of(r))).apply([0.10, along, height]), r.T.q))
    r.fingers(False)
    go_home(r)


def close_door(r: Recorder) -> None:
    """Push the outer face from about 95 degrees shut, with a fist, and go home."""
    T_cabinet = r.poses["cabinet"]
    along, height = r.rng.uniform(0.27, 0.31), r.rng.uniform(-0.12, -0.08)

    def outer(angle: float) -> Pose:
        return Pose((T_cabinet @ hinge(angle)).apply([-0.02, along, height]), facing(0.9 * angle, 0.0))

    start = angle_of(r)
    door = T_cabinet @ hinge(start)
    r.go(
        Pose(door.apply([-0.12, along + 0.05, height - 0.15]), facing(0.6, 0.0)),
        Pose(door.apply([-0.10, along, height]), facing(1.2, 0.0)),
    )
    r.fingers(True)
    r.go(outer(start), speed=0.08)
    swing(r, 0.0, outer, 0.08)
    r.back_off(0.10)
    r.fingers(False)
    go_home(r)


def go_home(r: Recorder) -> None:
    r.go(Pose(HOME + r.rng.uniform(-0.03, 0.03, 3), facing(r.rng.uniform(-0.1, 0.1), 0.6)))
    r.rest(0.8)


def on_counter(r: Recorder, rng: np.random.Generator) -> Pose:
    return r.poses["counter"] @ yaw_pose([rng.uniform(-0.2, 0.0), rng.uniform(-0.15, 0.2), 0.04], rng.uniform(-0.4, 0.4))


def in_cabinet(T_cabinet: Pose, rng: np.random.Generator) -> Pose:
    return T_cabinet @ yaw_pose([rng.uniform(-0.08, 0.0), rng.uniform(-0.08, 0.1), -0.16], rng.uniform(-0.4, 0.4))


def move_food(r: Recorder, food: str, goal: Pose, pitch: float) -> None:
    """Grasp a food at a pitch, lift it, carry it over, put it down at the same pitch, leave backwards, go home."""

    def grip(T_food: Pose) -> Pose:
        yaw = float(T_food.rotvec()[2])
        return Pose(T_food.p + np.array([0, 0, 0.005]), facing(yaw, pitch))

    if r.faults and r.rng.random() < 0.2:  # a nudge: the food is pushed a little on the first try
        r.reach(grip(r.poses[food] @ yaw_pose([0.0, 0.01, 0.0])))
        shift = yaw_pose([0.007, 0.0, 0.0])
        r.poses[food] = r.poses[food] @ shift
        r.rest(0.1)
        r.back_off(0.06)
    r.reach(grip(r.poses[food]))
    if r.faults and r.rng.random() < 0.2:  # a poor grasp: lifted a little, dropped where it was
        home = r.poses[food]
        r.grasp(food, 0.05)
        r.go(Pose(r.T.p + np.array([0, 0, 0.03]), r.T.q))
        r.carry = None
        for f in (0.6, 0.2, 0.0):
            r.poses[food] = Pose(home.p + f * np.array([0, 0, 0.03]), home.q)
            r.rest(DT)
        r.fingers(False)
        r.back_off(0.05)
        r.reach(grip(r.poses[food]), back=0.05)
    r.grasp(food, 0.05)
    lift = Pose(r.T.p + np.array([-0.03, 0.0, 0.06]), r.T.q)
    over_goal = Pose(grip(goal).p + np.array([-0.03, 0.0, 0.06]), grip(goal).q)
    out = Pose(np.array([0.45, 0.0, 0.35]), facing(0.0, pitch))
    r.go(lift, out, over_goal)
    r.go(grip(goal), speed=0.07)
    r.release()
    r.back_off(0.10)
    go_home(r)


def record(
    task: str,
    n: int,
    seed: int = 0,
    *,
    faults: bool = True,
    source: str | None = None,
    open_deg: tuple[float, float] = (92.0, 98.0),
    **demo: float | bool,
) -> tuple[Demo, ...]:
    """`n` demonstrations of OpenSingleDoor, CloseSingleDoor, PnPCabToCounter or PnPCounterToCab; `open_deg` is
    how far the door stands open where it does at first."""
    demos = []
    for k in range(n):
        rng = np.random.default_rng([seed, k, sum(map(ord, task))])
        angle = 0.0 if task == "OpenSingleDoor" else np.radians(rng.uniform(*open_deg))
        objects = kitchen(rng, float(angle))
        if task.startswith("PnP"):
            inside = task == "PnPCabToCounter"
            food = str(rng.choice(["cheese", "bread", "can"]))
            objects[food] = ("food", yaw_pose([0, 0, 0]))
            r = Recorder(rng, objects, faults=faults)
            r.poses[food] = in_cabinet(r.poses["cabinet"], rng) if inside else on_counter(r, rng)
            if rng.random() < 0.5:  # a distractor
                r.types["lemon"], r.poses["lemon"] = "food", r.poses["counter"] @ yaw_pose([-0.1, 0.4, 0.04], rng.uniform(-3, 3))
            r.rows.clear()
            r._record()
            goal = on_counter(r, rng) if inside else in_cabinet(r.poses["cabinet"], rng)
            move_food(r, food, goal, 0.7)
        else:
            r = Recorder(rng, objects, faults=faults)
            (open_door if task == "OpenSingleDoor" else close_door)(r)
        demos.append(r.demo(f"demo_{k}", source or task, task, **demo))  # type: ignore[arg-type]
    return tuple(demos)
