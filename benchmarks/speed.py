"""How fast the kitchen is, as ratios within one run: 20 Hz control, 2 ms physics, one core, no pictures.

    OMP_NUM_THREADS=1 python benchmarks/speed.py [--rounds 20] [-o docs/benchmarks-kitchen.md]

Compared, on the same model and from the same states: MuJoCo's bare step, the kitchen's whole loop with the passive controller,
and robosuite's own loop with OSC_POSE. They take turns, a second of robot time each, and processor time is counted, not the
clock's: another program on the machine slows all of them alike.
"""

from __future__ import annotations

import argparse
import os
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from statistics import median
from time import process_time
from typing import Any

os.environ.setdefault("OMP_NUM_THREADS", "1")

import numpy as np
from page import PAGE, machine, write_section

from symskill_pddl.kitchen import TASKS, make
from symskill_pddl.kitchen.backend import load_mujoco, load_robosuite
from symskill_pddl.kitchen.world import PHYSICS_STEPS, Kitchen
from symskill_pddl.scene import Command

STEPS = 20
"""Control steps of a turn: one second."""
SPEED = 0.05
"""The hand goes up and down at this speed [m/s], half a turn each."""
SHARE, TIMES, RESET_S = 0.5, 2.5, 0.3
"""What is aimed at: the loop's share of the bare steps, its multiple of robosuite's, and the longest reset."""


CHOSEN = tuple(task for task, spec in TASKS.items() if spec.kind in ("atomic", "play"))
"""Both scenes, every kind of start."""


def rate(act: Callable[[int], object]) -> float:
    """Control steps in a second of processor time, over one turn."""
    begin = process_time()
    for k in range(STEPS):
        act(k)
    return STEPS / (process_time() - begin)


class Subject:
    """What is timed in one episode; every turn begins in the same state."""

    def __init__(self, task: str) -> None:
        import robosuite

        import symskill_pddl.kitchen.robosuite_env  # noqa: F401  # registers the environment

        self.kitchen = make(task, 0)
        self.rivals = {
            name: robosuite.make("SymSkillKitchen", "Panda", task=task, seed=0, use_object_obs=objects)
            for name, objects in (("robosuite", True), ("robosuite, without objects", False))
        }
        for env in self.rivals.values():
            env.reset()
        self.worlds = {"kitchen": self.kitchen.physics, **{name: env.physics for name, env in self.rivals.items()}}
        self.starts = {name: state(physics) for name, physics in self.worlds.items()}

    def turns(self) -> dict[str, float]:
        """Rates of all, one turn each."""
        mj, physics = load_mujoco(), self.kitchen.physics
        model, data, found = physics.model, physics.data, {}

        restore(physics, self.starts["kitchen"])
        # the arm's own weight is carried, so that it stays where it is
        data.ctrl[physics._motors] = data.qfrc_bias[physics._arm_v]
        found["bare"] = rate(lambda _: mj.mj_step(model, data, PHYSICS_STEPS))

        restore(physics, self.starts["kitchen"])
        physics.controller.reset()
        found["kitchen"] = rate(lambda k: self.kitchen.step(up_and_down(k)))

        for name, env in self.rivals.items():
            restore(env.physics, self.starts[name])
            env.robots[0].composite_controller.update_state()
            env.robots[0].composite_controller.reset()
            env.timestep = 0
            # a unit of its action is 5 cm
            action = np.zeros(env.action_dim)

            def act(k: int, env: Any = env, action: Any = action) -> None:
                action[2] = up_and_down(k).twist[2] / STEPS / 0.05
                env.step(action)

            found[name] = rate(act)
        return found


def up_and_down(k: int) -> Command:
    """The command of control step k."""
    return Command.of([0.0, 0.0, SPEED if k < STEPS // 2 else -SPEED], [0.0, 0.0, 0.0], False)


def state(physics: Any) -> Any:
    """All that MuJoCo needs to go on from here."""
    mj = load_mujoco()
    kind = int(mj.mjtState.mjSTATE_INTEGRATION)
    values = np.empty(mj.mj_stateSize(physics.model, kind))
    mj.mj_getState(physics.model, physics.data, values, kind)
    return values


def restore(physics: Any, values: Any) -> None:
    """Go back there."""
    mj = load_mujoco()
    mj.mj_setState(physics.model, physics.data, values, int(mj.mjtState.mjSTATE_INTEGRATION))
    mj.mj_forward(physics.model, physics.data)


PARTS = {
    "mj_step1": "MuJoCo, up to the forces (`mj_step1`)",
    "mj_step2": "MuJoCo, from the torques on (`mj_step2`)",
    "mj_forward": "poses after the last physics step (`mj_forward`)",
    "mj_jacSite": "Jacobian (`mj_jacSite`)",
    "torques": "torque law of the passive controller",
    "observe": "the scene that is returned",
}


class Stopwatch:
    """Stands in for a module or object and times the calls of its functions."""

    def __init__(self, inner: Any, spent: dict[str, float]) -> None:
        self._inner, self._spent = inner, spent

    def __getattr__(self, name: str) -> Any:
        value = getattr(self._inner, name)
        return timed(name, value, self._spent) if name in PARTS else value


def timed(name: str, function: Callable[..., Any], spent: dict[str, float]) -> Callable[..., Any]:
    """The function, its processor time added to `spent[name]`."""

    def call(*arguments: Any) -> Any:
        begin = process_time()
        result = function(*arguments)
        spent[name] += process_time() - begin
        return result

    return call


def breakdown(kitchen: Kitchen, rounds: int) -> dict[str, float]:
    """Seconds of processor time of the loop's parts in one control step, and of the whole under 'whole'."""
    physics, spent, start = kitchen.physics, defaultdict[str, float](float), state(kitchen.physics)
    plain = physics._mj, physics.controller, kitchen.observe
    physics._mj, physics.controller = Stopwatch(plain[0], spent), Stopwatch(plain[1], spent)
    kitchen.observe = timed("observe", plain[2], spent)
    for _ in range(rounds):
        restore(physics, start)
        begin = process_time()
        for k in range(STEPS):
            kitchen.step(up_and_down(k))
        spent["whole"] += process_time() - begin
    physics._mj, physics.controller, kitchen.observe = plain
    return {name: seconds / (rounds * STEPS) for name, seconds in spent.items()}


def resets(tasks: list[str]) -> tuple[float, list[float]]:
    """Seconds of processor time that the first episode takes to set up, and all others."""
    found = []
    for task in (tasks[0], *tasks):
        begin = process_time()
        make(task, 1)
        found.append(process_time() - begin)
    return found[0], found[1:]


def page(
    rates: dict[str, list[float]], parts: dict[str, float], first: float, later: list[float], rounds: int, tasks: int
) -> str:
    """The section."""
    typical = {name: median(values) for name, values in rates.items()}
    share = median(a / b for a, b in zip(rates["kitchen"], rates["bare"], strict=True))
    times = median(a / b for a, b in zip(rates["kitchen"], rates["robosuite"], strict=True))
    bare_times = median(a / b for a, b in zip(rates["kitchen"], rates["robosuite, without objects"], strict=True))
    yes = {True: "reached", False: "**missed**"}
    known = sum(seconds for name, seconds in parts.items() if name != "whole")
    rows = [(text, parts[name]) for name, text in PARTS.items() if name in parts]
    rows.append(("all else: Python, copies, limits", parts["whole"] - known))
    return "\n".join(
        [
            "## Speed",
            "",
            f"Written by `python benchmarks/speed.py --rounds {rounds}` on {machine()}: 20 Hz control, 2 ms physics (25 steps",
            f"in a control step), one core, no pictures. Median of {rounds} turns of a second in an episode of each of the",
            f"{tasks} tasks; every turn begins in the same state, the hand goes up and down at 5 cm/s. Processor time.",
            "",
            "| control steps a second | | times real time |",
            "|---|---|---|",
            *(
                f"| {text} | {typical[name]:.0f} | {typical[name] / 20:.0f} |"
                for name, text in (
                    ("bare", "bare `mj_step`, 25 at a time, nothing controlled"),
                    ("kitchen", "the kitchen's loop: command in, passive controller at 500 Hz, scene out"),
                    ("robosuite", 'robosuite\'s loop with OSC_POSE, `robosuite.make("SymSkillKitchen", ...)`'),
                    ("robosuite, without objects", "the same with `use_object_obs=False`"),
                )
            ),
            "",
            "| ratio | | aimed at | |",
            "|---|---|---|---|",
            f"| kitchen's loop to bare steps | {share:.2f} | {SHARE} | {yes[share >= SHARE]} |",
            f"| kitchen's loop to robosuite's | {times:.1f} | {TIMES} | {yes[times >= TIMES]} |",
            f"| the same, robosuite without objects | {bare_times:.1f} | | |",
            f"| longest reset after the first [s] | {max(later):.2f} (median {median(later):.2f}) | {RESET_S} "
            f"| {yes[max(later) <= RESET_S]} |",
            f"| first reset, which imports and compiles [s] | {first:.1f} | | |",
            "",
            "Where a control step's time goes (25 physics steps; the timing itself costs a little):",
            "",
            "| part | ms | % |",
            "|---|---|---|",
            *(f"| {text} | {1e3 * seconds:.2f} | {100 * seconds / parts['whole']:.0f} |" for text, seconds in rows),
            f"| whole | {1e3 * parts['whole']:.2f} | 100 |",
        ]
    )


def main() -> None:
    """Measure and write the section."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=20, help="turns per task")
    parser.add_argument("--tasks", default=",".join(CHOSEN), help="names separated by commas")
    parser.add_argument("-o", "--output", type=Path, default=PAGE)
    arguments = parser.parse_args()
    load_robosuite()
    from robosuite.utils.log_utils import ROBOSUITE_DEFAULT_LOGGER

    ROBOSUITE_DEFAULT_LOGGER.setLevel("ERROR")
    tasks = arguments.tasks.split(",")
    first, later = resets(tasks)
    rates: dict[str, list[float]] = defaultdict(list)
    for task in tasks:
        subject = Subject(task)
        subject.turns()
        for _ in range(arguments.rounds):
            for name, value in subject.turns().items():
                rates[name].append(value)
        print(task, {name: round(median(rates[name][-arguments.rounds :])) for name in rates}, flush=True)
    parts = breakdown(make(tasks[0], 0), 2 * arguments.rounds)
    write_section("speed", page(rates, parts, first, later, arguments.rounds, len(tasks)), arguments.output)
    print(f"{arguments.output}: written")


if __name__ == "__main__":
    main()
