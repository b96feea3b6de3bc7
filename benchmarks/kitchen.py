"""Success rates in the kitchen: every figure the package claims, in one command that may be stopped and called again.

    python benchmarks/kitchen.py [--scale 1.0] [--seed 5000] [--jobs 2] [--only NAME ...] [--folder DIR] [-o docs/results.md]

Learns libraries from the shipped demonstrations, runs every evaluation of `kitchen_suites.py`, and writes the page anew after
each. Results files, libraries, the episodes so far and the traces of those that failed lie in the folder; called again with the
same arguments, it goes on where it was. `--scale 0.1` runs a tenth of the episodes. `--list` says what there is to measure. An
evaluation whose tasks the kitchen does not have, or that nobody has recorded, is left out, and the page says so.
"""

from __future__ import annotations

import argparse
import sys
from hashlib import sha256
from pathlib import Path

from kitchen_page import Measured, page
from kitchen_suites import Entry, entries

from symskill_pddl.cli.work import checksum_of
from symskill_pddl.demos import load_demos
from symskill_pddl.evaluation.ablations import without
from symskill_pddl.evaluation.results import Results
from symskill_pddl.evaluation.resumable import evaluate
from symskill_pddl.evaluation.spread import Processes
from symskill_pddl.files import RESULTS, Output, Replace, write_atomic
from symskill_pddl.kitchen import TASKS
from symskill_pddl.learning import learn_reported
from symskill_pddl.library import Library

PACKAGE = Path(__file__).parent.parent / "symskill_pddl"


def shipped() -> list[Path]:
    """All recordings that come with the package, those of play too."""
    return sorted((PACKAGE / "data").glob("*/*.hdf5"))


def recordings(play: bool) -> list[Path]:
    """The shipped files of atomic tasks, or those of play."""
    return [f for f in shipped() if (f.stem in TASKS and TASKS[f.stem].kind == "atomic") is not play]


def library(shown: int, folder: Path) -> Path:
    """A library learned from the first `shown` demonstrations of each task, or from play (0); learned once for one code."""
    path = folder / (f"library-{shown}" if shown else "library-play")
    files = recordings(play=not shown)
    digest = sha256(str(shown).encode())
    for file in (*files, *sorted(PACKAGE.rglob("*.py"))):
        digest.update(file.read_bytes())
    stamp = path / "learned-from.txt"
    if not (stamp.is_file() and stamp.read_text() == digest.hexdigest()):
        print(f"learning {path.name}", file=sys.stderr, flush=True)
        found, _ = learn_reported([d for file in files for d in load_demos(file)[: shown or None]])
        found.save(path)
        stamp.write_text(digest.hexdigest())
    return path


def measure(entry: Entry, folder: Path, scale: float, seed: int, jobs: int) -> Measured:
    """Run what is left of an entry."""
    path, suite = library(entry.shown, folder), entry.suite(scale, seed)

    def run(name: str, what: str) -> Results:
        asked = suite if not what else without(suite, what)
        print(f"{name}: {len(asked.episodes)} episodes", file=sys.stderr, flush=True)
        output, failed = Output(folder / f"{name}.json", RESULTS, Replace.ANYTHING), folder / "failed" / name
        failed.mkdir(parents=True, exist_ok=True)
        return evaluate(
            Library.load, path, asked, output, checksum=checksum_of(path), pool=Processes(jobs), failed=failed, keep=True
        )

    found = Measured(entry, run(entry.name, ""))
    for mechanism in entry.against:
        found.without[mechanism] = run(f"{entry.name}.no-{mechanism}", mechanism)
    return found


def main() -> None:
    """Learn, run, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scale", type=float, default=1.0, help="of the number of episodes")
    parser.add_argument("--seed", type=int, default=5000, help="of the first episode of every task")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", nargs="+", metavar="NAME", help="evaluations by name")
    parser.add_argument("--list", action="store_true", help="what there is to measure, and leave")
    parser.add_argument("--folder", type=Path, default=Path("symskill-out/kitchen"))
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/results.md"))
    args = parser.parse_args()
    if not args.scale > 0:
        parser.error(f"--scale has to be positive, got {args.scale}")
    found, missing = entries({f.stem for f in shipped()})
    if unknown := sorted(set(args.only or ()) - {e.name for e in found}):
        parser.error(f"--only: there is no '{unknown[0]}'; there are: {', '.join(e.name for e in found)}")
    if args.list:
        for entry in found:
            runs = len(entry.suite(args.scale, args.seed).episodes) * (1 + len(entry.against))
            print(f"{entry.name:24} {runs:5} episodes  {entry.figure.title}")
        print(*(f"not measured: {text}" for text in missing), sep="\n")
        return
    args.folder.mkdir(parents=True, exist_ok=True)
    chosen = [e for e in found if args.only is None or e.name in args.only]
    call = f"python benchmarks/kitchen.py --scale {args.scale:g} --seed {args.seed}" + (
        f" --only {' '.join(args.only)}" if args.only else ""
    )
    measured: list[Measured] = []
    for i, entry in enumerate(chosen, start=1):
        measured.append(measure(entry, args.folder, args.scale, args.seed, args.jobs))
        write_atomic(args.output, page(measured, missing, chosen[i:], call, args.scale, args.seed).encode())


if __name__ == "__main__":
    main()
