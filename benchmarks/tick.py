"""What a control tick costs, stage by stage, with 5, 10, 20 and 40 objects in the scene.

    python benchmarks/tick.py [LIBRARY] [--ticks 2000]

Runs the executor's own parts (abstraction with hysteresis, monitor, skill, obstacles) and the controller on scenes that are made
of the kitchen's objects and more foods, all of which are obstacles and arguments of predicates. In the last row a thing of a type
that was never shown stands in the way besides, and the hand is on its detour in every tick. Without LIBRARY it learns one
from the shipped demonstrations. Times depend on the machine; the last column is relative to the first row of the same run.
"""

from __future__ import annotations

import argparse
import tempfile
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

import numpy as np

from symskill_pddl.abstraction import groundings
from symskill_pddl.cli.work import learn_from, shipped_demos
from symskill_pddl.control import PassiveController
from symskill_pddl.execution.around import Obstacles, Strangers
from symskill_pddl.execution.body import Body
from symskill_pddl.execution.config import ExecutionConfig
from symskill_pddl.execution.monitor import Memory, Tick, Watch, judge
from symskill_pddl.execution.runner import SkillRun
from symskill_pddl.execution.timing import STAGES, TICK, Spread, spreads
from symskill_pddl.geometry import Pose
from symskill_pddl.library import LearnedOperator, Library
from symskill_pddl.scene import Command, Scene
from symskill_pddl.skills import Skill, rollout
from symskill_pddl.symbols import GroundOperator, State

CONTROLLER_CALLS = 25
"""In one tick of 50 ms, at 500 Hz."""
OBJECTS = {"cabinet": "cabinet", "door": "door", "counter": "counter", "food-0": "food", "food-1": "food", "drawer": "drawer"}
STRANGE = {"strange": (0.04, 0.03, 0.05)}
"""Half sizes [m] of a type that nobody has shown."""
OBJECTS |= {"drawer-unit": "drawer-unit", "knob": "knob", "stove": "stove", "sink": "sink", "lever": "lever"}


def objects(count: int) -> dict[str, str]:
    """The kitchen's first objects, then more foods."""
    found = dict(list(OBJECTS.items())[:count])
    return found | {f"food-{i}": "food" for i in range(2, 2 + count - len(found))}


@dataclass
class Paper:
    """A world without physics: the hand goes where it is told, the objects tremble. Every controller call is a real one."""

    names: dict[str, str]
    poses: Pose
    hand: Pose
    speed: float = 0.01
    """What part of the told way the hand goes: it is to be on its way in every tick."""
    period_s: float = 0.05
    time: float = 0.0
    ms: dict[str, float] = field(default_factory=dict)
    controller: PassiveController = field(default_factory=PassiveController)
    rng: np.random.Generator = field(default_factory=lambda: np.random.default_rng(0))

    def observe(self) -> Scene:
        return Scene(self.time, self.hand, 0.08, False, self.names, self.poses)

    def step(self, command: Command) -> Scene:
        self.time += self.period_s
        p = self.poses.p + self.rng.normal(0.0, 1e-4, self.poses.p.shape)
        q, hand_p = self.poses.q, self.hand.p + self.period_s * self.speed * command.twist[:3]
        jacobian, inertia, zero = self.rng.normal(size=(6, 7)), np.diag(np.linspace(1.5, 0.1, 7)), np.zeros(7)
        start = perf_counter()
        self.poses, self.hand = Pose(p, q), Pose(hand_p, self.hand.q)
        scene = self.observe()
        seen = perf_counter()
        for _ in range(CONTROLLER_CALLS):
            self.controller.torques(zero, zero, jacobian, inertia, zero, command.twist, 0.002)
        self.ms = {"observe": 1e3 * (seen - start), "controller": 1e3 * (perf_counter() - seen)}
        return scene


def scene_of(count: int, rng: np.random.Generator) -> Paper:
    """Objects spread over a counter, the hand above them."""
    names = objects(count)
    p = rng.uniform((0.2, -0.5, 0.0), (0.7, 0.5, 0.1), (count, 3))
    turned = Pose.from_rotvec(p, np.outer(rng.uniform(-1.0, 1.0, count), (0.0, 0.0, 1.0)))
    return Paper(names, turned, Pose([0.4, 0.0, 0.3], [0.0, 1.0, 0.0, 0.0]))


def blocked(world: Paper, skill: Skill, binding: dict[str, str]) -> Strangers:
    """A strange thing in the world, half a second ahead of the hand, which stays where it has to go around it."""
    phase, scene, config = skill.phases[0], world.observe(), ExecutionConfig().motion
    T_world_frame = scene.pose(binding[phase.frame])
    way = T_world_frame @ rollout(phase.field, T_world_frame.inverse() @ world.hand, 10.0, 0.1)
    world.names, world.speed, poses = {**world.names, "strange": "strange"}, 0.0, world.poses
    strangers = Strangers(world.names, STRANGE, frozenset(), config)
    for at in way.p:
        world.poses = Pose(np.vstack([poses.p, at]), np.vstack([poses.q, [1.0, 0.0, 0.0, 0.0]]))
        if strangers.levels(world.observe(), way[:1])[0] > 1.02:
            break
    levels = strangers.levels(world.observe(), way)
    assert levels[:6].min() < 1.0 < levels[0], "the thing is not in the way"
    return strangers


def watch_of(learned: LearnedOperator, binding: dict[str, str], state: State, phases: int) -> Watch:
    """A step that goes on for ever."""
    op = learned.operator
    sets = {n: frozenset(a.substitute(binding) for a in getattr(op, n)) for n in ("pre", "add", "delete", "maintain")}
    step = GroundOperator(op.name, tuple(binding.values()), absent=frozenset(), cost=1.0, **sets)
    endless = dict.fromkeys(("exit_s", "budget_s", "grace_s", "stall_s", "blocked_s"), 1000000000.0)
    return Watch(
        step,
        0,
        (step,) * 9,
        frozenset(),
        0.0,
        state,
        frozenset(),
        frozenset(),
        phases,
        still_speed=0.0,
        still_turn=0.0,
        **endless,
    )


def measure(library: Library, count: int, ticks: int, detour: bool = False) -> tuple[dict[str, Spread], int, int]:
    """Times [ms], number of obstacles, and of atoms that could hold."""
    config = ExecutionConfig()
    learned = next(
        o for o in library.operators if "food" in o.operator.name and o.kind == "pick" and "counter" in o.operator.name
    )
    world = scene_of(count, np.random.default_rng(count))
    binding = {p.name: next(n for n, kind in world.names.items() if kind == p.type) for p in learned.operator.parameters}
    skill = library.skills[learned.skill]
    strange = blocked(world, skill, binding) if detour else None
    body = Body(world, library, world.names, config.motion, config.debounce_s)
    around = Obstacles(world.names, library.extents, frozenset(binding.values()), config.motion, body.velocities)
    run = SkillRun(skill, binding, body.scene, config.motion, obstacles=around, strange=strange)
    watch, memory, found = watch_of(learned, binding, body.state, run.phases), Memory(), []
    for _ in range(ticks + 50):
        begin = perf_counter()
        motion = run.tick(body.scene)
        skill = 1e3 * (perf_counter() - begin)
        body.step(motion.command)
        begin = perf_counter()
        m = motion
        tick = Tick(body.now, body.state, m.stage, m.stage_s, m.settling, body.closing, m.speed, m.turn, m.rest_s)
        memory = judge(watch, tick, memory).memory
        monitor = 1e3 * (perf_counter() - begin)
        found.append({**body.ms, "skill": skill - run.obstacles_ms, "obstacles": run.obstacles_ms, "monitor": monitor})
    atoms = sum(len(list(groundings(c, world.names))) for c in library.classifiers)
    return spreads(found[50:], []), len(around.names), atoms


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("library", type=Path, nargs="?")
    parser.add_argument("--ticks", type=int, default=2000)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        path = args.library or Path(folder) / "library"
        if args.library is None:
            learn_from(shipped_demos(), path)
        library = Library.load(path)
    print(f"median / 95th percentile [ms] of {args.ticks} ticks\n")
    print("| objects | atoms | obstacles |", " | ".join((*STAGES, TICK, "relative")), "|")
    print("|" + "---|" * (len(STAGES) + 5))
    first = None
    for count, detour in ((5, False), (10, False), (20, False), (40, False), (20, True)):
        times, obstacles, atoms = measure(library, count, args.ticks, detour)
        first = first or times[TICK].p50
        cells = [f"{times[name].p50:.2f} / {times[name].p95:.2f}" for name in (*STAGES, TICK)]
        print(
            f"| {count}{', detour' if detour else ''} | {atoms} | {obstacles} |",
            " | ".join(cells),
            f"| {times[TICK].p50 / first:.2f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
