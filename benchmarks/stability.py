"""Does the kitchen hold together whatever the robot does? Random bounded twists in every task, 20 s an episode.

    OMP_NUM_THREADS=1 python benchmarks/stability.py [--seeds 100] [--jobs 1] [-o docs/benchmarks-kitchen.md]

Every control step is checked: numbers finite, no warning of MuJoCo's, nothing loose inside the counter or the walls or out of
the room. Some episodes are run a second time in another process, which has to go through the same states bit for bit. Exit
status 1 if anything fails. About half an hour on one core.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from hashlib import sha256
from itertools import repeat
from pathlib import Path
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from page import PAGE, machine, write_section

from symskill_pddl import workers
from symskill_pddl.kitchen import TASKS, make, task_named
from symskill_pddl.kitchen.world import Kitchen
from symskill_pddl.panda.arm import MAX_RATE, MAX_SPEED
from symskill_pddl.scene import Command

FIXED = ("counter", "room")
"""Bodies that nothing may get into."""
ROOM_M = np.array([[-2.0, -3.0, -0.95], [0.94, 3.0, 3.0]])
"""Corners of the room: the wall behind the counter, the floor, and where a thing has no business on the other sides."""


@dataclass
class Shaken:
    """What happened in one episode.

    Attributes
    ----------
    digest : str
        Of the positions and velocities at every control step.
    faults : list of str
        What went wrong, with its time.
    deepest_m : float
        How far anything was ever pressed into anything [m].
    fallen : int
        Things that lie on the floor at the end.
    """

    task: str
    seed: int
    digest: str = ""
    faults: list[str] = field(default_factory=list)
    deepest_m: float = 0.0
    fallen: int = 0


def commands(kitchen: Kitchen, rng: np.random.Generator, steps: int) -> Iterator[Command]:
    """Twists up to the limits and fingers open or shut, each kept for 0.2 to 2 s.

    Half of them go in any direction, half straight at some object: left to chance, the arm soon is where nothing can be hit.
    """
    while True:
        direction = rng.normal(size=(2, 3))
        if rng.random() < 0.5:
            scene = kitchen.observe()
            direction[0] = scene.T_world_objects.p[rng.integers(len(scene.objects))] - scene.T_world_ee.p
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        twist = np.concatenate(direction * rng.uniform(0.0, [[MAX_SPEED], [MAX_RATE]]))
        closing = bool(rng.random() < 0.5)
        for _ in range(int(rng.integers(4, 41))):
            if steps == 0:
                return
            steps -= 1
            yield Command(twist, closing)


def shake(task: str, seed: int, seconds: float) -> Shaken:
    """Run one episode."""
    kitchen = make(task, seed)
    physics, data, found, told = kitchen.physics, kitchen.physics.data, Shaken(task, seed), set[str]()
    solids, names = Solids(physics), physics.loose
    loose = [physics.bodies[name] for name in names]
    digest, rng = sha256(), np.random.default_rng([seed, list(TASKS).index(task)])

    def fault(what: str) -> None:
        if what not in told:
            told.add(what)
            found.faults.append(f"{what} at {kitchen.time:.2f} s")

    for command in commands(kitchen, rng, round(seconds / kitchen.period_s)):
        kitchen.step(command)
        digest.update(data.qpos.tobytes() + data.qvel.tobytes())
        if not (np.isfinite(data.qpos).all() and np.isfinite(data.qvel).all()):
            fault("not a number")
        for i, warning in enumerate(data.warning):
            if warning.number:
                fault(f"MuJoCo's warning {i}")
        if data.ncon:
            found.deepest_m = max(found.deepest_m, -float(data.contact.dist[: data.ncon].min()))
        for i, where in solids.around(data.xpos[loose]):
            fault(f"{names[i]} {where}")
    found.digest = digest.hexdigest()
    found.fallen = int(np.sum(data.xpos[loose, 2] < -0.5))
    return found


class Solids:
    """The boxes of the bodies that nothing may get into; all of them stand straight."""

    def __init__(self, physics: Any) -> None:
        model, data = physics.model, physics.data
        geoms = [g for g in range(model.ngeom) if model.body(model.geom_bodyid[g]).name in FIXED]
        self.names = [model.geom(g).name for g in geoms]
        self.centers, self.halves = data.geom_xpos[geoms].copy(), model.geom_size[geoms].copy()

    def around(self, points: Any) -> Iterator[tuple[int, str]]:
        """Which of the points (n, 3) are where they could only get through a surface, and what it is."""
        within = np.all(np.abs(points[:, None] - self.centers) < self.halves, axis=2)
        outside = np.any((points < ROOM_M[0]) | (points > ROOM_M[1]), axis=1)
        if within.any() or outside.any():
            for i in range(len(points)):
                yield from ((i, f"inside {self.names[j]}") for j in np.flatnonzero(within[i]))
                if outside[i]:
                    yield i, "out of the room"


def elsewhere(episodes: list[tuple[str, int, float]]) -> list[str]:
    """The digests of episodes that another process runs."""
    call = [sys.executable, __file__, "--digests", json.dumps(episodes)]
    return subprocess.run(call, capture_output=True, text=True, check=True).stdout.split()


def page(found: list[Shaken], repeated: dict[tuple[str, int], bool], seconds: float, hours: float) -> str:
    """The section."""
    tasks = list(dict.fromkeys(s.task for s in found))
    seeds = len(found) // len(tasks)

    def row(task: str) -> str:
        mine = [s for s in found if s.task == task]
        faults = [f for s in mine for f in s.faults]
        counts = [sum(text in f for f in faults) for text in ("not a number", "warning", "inside", "out of the room")]
        again = [same for (name, _), same in repeated.items() if name == task]
        deepest = 1e3 * max(s.deepest_m for s in mine)
        cells = (task, len(mine), *counts, f"{deepest:.1f}", sum(s.fallen for s in mine), f"{sum(again)} of {len(again)}")
        return f"| {' | '.join(map(str, cells))} |"

    faulty = [f"- {s.task}, seed {s.seed}: {fault}" for s in found for fault in s.faults]
    return "\n".join(
        [
            "## Stability",
            "",
            f"Written by `python benchmarks/stability.py --seeds {seeds} --seconds {seconds:g}` on {machine()}:",
            f"{len(tasks)} tasks x {seeds} seeds x {seconds:g} s, {hours:.1f} hours on the robots' clocks. Twists are random, up",
            f"to {MAX_SPEED} m/s and {MAX_RATE:g} rad/s, each kept for 0.2 to 2 s, half of them straight at some object; the",
            "fingers open and close. Checked at every control step. Things may be knocked off the counter onto the floor. The",
            "last column counts episodes that went through the same states, bit for bit, in a second process.",
            "",
            "| task | episodes | not a number | MuJoCo warnings | in counter or wall | out of the room | deepest contact [mm] "
            "| things on the floor | same again |",
            "|---|---|---|---|---|---|---|---|---|",
            *map(row, tasks),
            *(["", "Faults:", "", *faulty] if faulty else []),
        ]
    )


def main() -> int:
    """Run the episodes and write the section."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", help="names separated by commas; otherwise the atomic tasks and play")
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--again", type=int, default=2, help="episodes per task that are run in a second process")
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("-o", "--output", type=Path, default=PAGE)
    parser.add_argument("--digests", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.digests:
        print(*(shake(*episode).digest for episode in json.loads(arguments.digests)), sep="\n")
        return 0
    names = arguments.tasks.split(",") if arguments.tasks else [t for t, s in TASKS.items() if s.kind in ("atomic", "play")]
    tasks = [task_named(name).name for name in names]
    found: list[Shaken] = []
    repeated: dict[tuple[str, int], bool] = {}
    with workers.pool(arguments.jobs, "fork") as pool:
        for seed in range(arguments.seeds):
            fresh = list(pool.map(shake, tasks, repeat(seed), repeat(arguments.seconds)))
            found += fresh
            if seed < arguments.again:
                digests = elsewhere([(s.task, s.seed, arguments.seconds) for s in fresh])
                repeated |= {(s.task, s.seed): s.digest == digest for s, digest in zip(fresh, digests, strict=True)}
            # the page holds what was done so far, if this is stopped
            hours = len(found) * arguments.seconds / 3600
            write_section("stability", page(found, repeated, arguments.seconds, hours), arguments.output)
            print(f"seed {seed}:", "; ".join(f"{s.task}: {f}" for s in fresh for f in s.faults) or "no fault", flush=True)
    print(f"{arguments.output}: written")
    return int(any(s.faults for s in found) or not all(repeated.values()))


if __name__ == "__main__":
    sys.exit(main())
