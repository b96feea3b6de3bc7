"""How often does the demonstrator do its tasks? Every seed counts, also those that a recording would drop.

    python benchmarks/demonstrator.py [--tasks T,...] [--first 0] [--seeds 100] [--jobs 1] [-o docs/benchmarks-kitchen.md]

Each episode is recorded as `symskill record` does it, with what goes wrong on purpose: a pause, a second approach, a knock,
a poor grasp. Episodes lie in the folder, one line each; called again it goes on where it was, and they count as long as the
kitchen's code is the same. The section is written anew after every seed. About 45 minutes on one core. Play takes half a minute
an episode and is asked for on its own: `--tasks Play --seeds 10` adds a row.
"""

from __future__ import annotations

import argparse
import json
import os
from collections import Counter
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")


from page import PAGE, machine, write_section

import symskill_pddl
from symskill_pddl import workers
from symskill_pddl.demos.truth import Truth
from symskill_pddl.evaluation.statistics import wilson
from symskill_pddl.kitchen import TASKS, make, task_named
from symskill_pddl.kitchen.record import record_with_truth

PACKAGE = Path(symskill_pddl.__file__).parent


@dataclass(frozen=True)
class Done:
    """One episode: whether the judge saw success, what it missed otherwise, and how long it took on the robot's clock [s]."""

    task: str
    seed: int
    success: bool
    missed: str
    seconds: float


def record(task: str, seed: int) -> Done:
    """Run one episode."""
    (demo,), truths = record_with_truth(task, 1, seed, keep_failed=True)
    success = bool(demo.attributes["success"])
    missed = "" if success else miss(task, make(task, seed).focus, truths[demo.name])
    return Done(task, seed, success, missed, round(float(demo.times[-1]), 2))


def miss(task: str, focus: tuple[str, ...], truth: Truth) -> str:
    """What the judge missed at the end of a failed episode, by what really happened."""
    at_end = {relation for relation, held in truth.relations.items() if held[-1]}
    types = task_named(task).scene.types
    foods = [name for name in focus if types[name] in ("food", "thing", "lid")]
    if not foods:
        wanted = "shut" if task.startswith(("Close", "TurnOff")) else "open"
        return f"not let go of the {focus[0]}" if (wanted, *focus[:2]) in at_end else f"the {focus[0]} was not {wanted}"
    rests = {food: sorted({ref for _, thing, ref in at_end if thing == food}) for food in foods}
    if len(foods) > 1:
        lost = [f for f in foods if not {types[ref] for ref in rests[f]} & {"cookware", "drawer", "container", "cabinet"}]
        return f"{types[lost[0]]} in no dish" if lost else "lid askew, or not let go of"
    food, start, end = focus[0], focus[1], focus[2]
    if end in rests[food]:
        return f"not let go of, or not well on the {end}"
    where = rests[food][0] if rests[food] else "nothing"
    moved = any(move.obj == food for move in truth.moves)
    return f"food ended on {where}, from {start}" if moved else f"food was never moved from {start}"


def kept(path: Path, code: str) -> dict[tuple[str, int], Done]:
    """The episodes that were run with the same code."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    found = [json.loads(line) for line in lines]
    return {(e["task"], e["seed"]): Done(**e) for e in found if e.pop("code") == code}


def kitchen_code() -> str:
    """Digest of what decides how an episode goes."""
    digest = sha256()
    for file in (PACKAGE / "control.py", PACKAGE / "geometry.py", *sorted((PACKAGE / "kitchen").glob("*.py"))):
        digest.update(file.read_bytes())
    return digest.hexdigest()[:16]


def page(found: list[Done]) -> str:
    """The section."""
    tasks = [task for task in TASKS if any(done.task == task for done in found)]

    def row(task: str) -> str:
        mine = [done for done in found if done.task == task]
        good = sum(done.success for done in mine)
        low, high = wilson(good, len(mine))
        seconds = sorted(done.seconds for done in mine)[len(mine) // 2]
        missed = Counter(done.missed for done in mine if not done.success)
        why = "; ".join(f"{count} x {what}" for what, count in sorted(missed.items(), key=lambda item: (-item[1], item[0])))
        seeds = f"{min(done.seed for done in mine)} to {max(done.seed for done in mine)}"
        return f"| {task} | {seeds} | {good} of {len(mine)} | {low:.2f}-{high:.2f} | {seconds:.0f} | {why or '-'} |"

    bad = [f"{task}: {', '.join(str(d.seed) for d in found if d.task == task and not d.success)}" for task in tasks]
    return "\n".join(
        [
            "## The demonstrator",
            "",
            f"Written by `python benchmarks/demonstrator.py` on {machine()}.",
            "Every seed counts, also those that `symskill record` drops. Pauses, second approaches, knocks and poor grasps are",
            "drawn as in a recording.",
            "",
            "| task | seeds | successes | interval | median time [s] | what the judge missed |",
            "|---|---|---|---|---|---|",
            *map(row, tasks),
            "",
            "Seeds that failed: " + ("; ".join(line for line in bad if not line.endswith(": ")) or "none") + ".",
        ]
    )


def main() -> None:
    """Run the episodes and write the section."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tasks", help="names separated by commas; otherwise the atomic tasks")
    parser.add_argument("--first", type=int, default=0, help="seed of the first episode of every task")
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument("--jobs", type=int, default=1, help="processes")
    parser.add_argument("--folder", type=Path, default=Path("symskill-out/demonstrator"))
    parser.add_argument("-o", "--output", type=Path, default=PAGE)
    arguments = parser.parse_args()
    names = arguments.tasks.split(",") if arguments.tasks else [t for t, s in TASKS.items() if s.kind == "atomic"]
    tasks = [task_named(name).name for name in names]
    arguments.folder.mkdir(parents=True, exist_ok=True)
    lines, code = arguments.folder / "episodes.jsonl", kitchen_code()
    found = kept(lines, code)
    with workers.pool(arguments.jobs, "fork") as pool:
        for seed in range(arguments.first, arguments.first + arguments.seeds):
            missing = [task for task in tasks if (task, seed) not in found]
            for done in pool.map(record, missing, [seed] * len(missing)):
                found[done.task, seed] = done
                with lines.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(asdict(done) | {"code": code}) + "\n")
            # the page holds what was done so far, if this is stopped
            write_section("demonstrator", page(list(found.values())), arguments.output)
            bad = [f"{task}: {found[task, seed].missed}" for task in tasks if not found[task, seed].success]
            print(f"seed {seed}:", "; ".join(bad) or "all done", flush=True)
    print(f"{arguments.output}: written")


if __name__ == "__main__":
    main()
