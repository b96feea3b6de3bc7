"""A world of one's own: demonstrations from it, a library, PDDL, a plan, and its execution under the monitor.

    python examples/my_world.py FOLDER

A table without physics: what the fingers close on goes with the hand. Put a robot behind `observe` and `step` instead.
"""

import sys
from pathlib import Path

import numpy as np

from symskill_pddl.abstraction import abstract
from symskill_pddl.demos import Demo, save_demos
from symskill_pddl.describe import domain_comments
from symskill_pddl.execution.executor import execute
from symskill_pddl.execution.outcome import Outcome
from symskill_pddl.execution.recovery import near, servo
from symskill_pddl.execution.trace import TraceWriter
from symskill_pddl.geometry import Pose, quat_multiply
from symskill_pddl.learning import learn
from symskill_pddl.pddl import write_domain, write_plan, write_problem
from symskill_pddl.planning import get
from symskill_pddl.scene import Command, Scene
from symskill_pddl.symbols import Atom, Problem

OBJECTS = {"box": "cube", "left": "tray", "right": "tray"}
EXTENTS = {"cube": (0.02, 0.02, 0.02), "tray": (0.08, 0.08, 0.005)}
DOWN, UPRIGHT = np.array([0.0, 1.0, 0.0, 0.0]), np.array([1.0, 0.0, 0.0, 0.0])
FLAT, RISE = np.array([1.0, 1.0, 0.0]), np.array([0.0, 0.0, 0.12])


class Table:
    """Poses out, twists in: all that `symskill_pddl.scene.World` asks for is `period_s`, `observe` and `step`."""

    period_s = 0.05

    def __init__(self, rng: np.random.Generator, on: str) -> None:
        self.time, self.closed, self.aperture = 0.0, False, 0.08
        self.grasp: Pose | None = None
        self.hand = Pose(np.array([0.4, 0.0, 0.3]) + rng.uniform(-0.03, 0.03, 3), DOWN)
        trays = {"left": np.array([0.5, 0.2, 0.005]), "right": np.array([0.5, -0.2, 0.005])}
        self.at = {name: Pose(p + FLAT * rng.uniform(-0.03, 0.03, 3), UPRIGHT) for name, p in trays.items()}
        self.at["box"] = Pose(self.at[on].p + FLAT * rng.uniform(-0.02, 0.02, 3) + [0, 0, 0.025], UPRIGHT)

    def observe(self) -> Scene:
        return Scene(self.time, self.hand, self.aperture, self.closed, OBJECTS, Pose.stack([self.at[o] for o in OBJECTS]))

    def step(self, command: Command) -> Scene:
        self.time = round(self.time + self.period_s, 6)
        moved, turned = self.period_s * command.twist[:3], Pose.from_rotvec(np.zeros(3), self.period_s * command.twist[3:])
        self.hand = Pose(self.hand.p + moved, quat_multiply(turned.q, self.hand.q))
        self.closed = command.close_gripper
        between = self.grasp is not None or np.linalg.norm(self.hand.p - self.at["box"].p) < 0.02
        aim = (0.04 if between else 0.0) if self.closed else 0.08
        self.aperture += float(np.clip(aim - self.aperture, -0.015, 0.015))
        if self.aperture > 0.045 and self.grasp is not None:  # it falls on what is below
            self.grasp, self.at["box"] = None, Pose(FLAT * self.at["box"].p + [0, 0, 0.03], UPRIGHT)
        elif self.closed and between and self.aperture < 0.041 and self.grasp is None:
            self.grasp = self.hand.inverse() @ self.at["box"]
        if self.grasp is not None:
            self.at["box"] = self.hand @ self.grasp
        return self.observe()


def demonstrate(k: int) -> Demo:
    """Somebody moves the box from the left to the right; everything is recorded, nothing is labelled."""
    rng = np.random.default_rng(k)
    world = Table(rng, on="left")
    scenes = [world.observe()]
    box, goal = world.at["box"].p, world.at["right"].p + FLAT * rng.uniform(-0.02, 0.02, 3) + [0, 0, 0.027]
    for p, closed in ((box, False), (goal, True)):  # the fingers before; over it, down, close or open, up again
        for above, close in ((RISE, closed), (0 * RISE, closed), (0 * RISE, not closed), (RISE, not closed)):
            target = Pose(p + above, DOWN)
            while not near(world.hand, target, distance_m=0.002, angle_rad=0.05):
                scenes.append(world.step(Command(servo(world.hand, target, gain=3.0, max_speed=0.15, max_turn=1.0), close)))
            scenes += [world.step(Command.hold(close)) for _ in range(12)]
    return Demo.from_scenes(scenes, name=f"demo_{k}", task="MoveBox", extents=EXTENTS)


def main(folder: Path, world: Table) -> Outcome:
    """From demonstrations to the box on the left tray. Nobody has shown how it gets there."""
    demos = [demonstrate(k) for k in range(5)]
    save_demos(folder / "demos.hdf5", demos)  # from here on, the commands of `symskill` would do as well
    library, planner = learn(demos), get("auto")
    library.save(folder / "library")
    domain, goal = library.domain("table"), frozenset({Atom("cube-on-tray", ("box", "left"))})
    state = abstract(world.observe(), library.classifiers, gripper=library.gripper)
    problem = Problem("move", "table", tuple(OBJECTS.items()), state, goal)
    (folder / "domain.pddl").write_text(write_domain(domain, comments=domain_comments(library)))
    (folder / "problem.pddl").write_text(write_problem(problem, domain))
    (folder / "plan.txt").write_text(write_plan(planner.solve(domain, problem).unwrap()))
    with TraceWriter(folder / "trace.jsonl") as trace:  # the executor plans by itself, from what it sees
        return execute(world, library, domain, goal, planner, objects=OBJECTS, rng=np.random.default_rng(0), trace=trace)


if __name__ == "__main__":
    outcome = main(Path(sys.argv[1]), Table(np.random.default_rng(99), on="right"))
    print(*(f"{s.start_s:5.1f} s  {s.step}: {s.verdict}, {s.reason}" for s in outcome.steps), outcome.reason, sep="\n")
