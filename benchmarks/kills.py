"""What is left when a command that writes is killed at any moment.

    python benchmarks/kills.py [--kills 50] [--seed 0] [COMMAND ...]

Kills `learn`, `record`, `export` and `evaluate` (SIGKILL, to their own process alone): every other time at a moment drawn over
the length of a whole run, else a few milliseconds after it began to write. After each kill the output has to be the whole
old one or the whole new one, and no process of the command may be left; after the same command has then run to its end
there has to be the new one, byte for byte as without a kill, and no temporary file beside it or in the folder for temporary
files. Prints a line per command, and everything that was found; the exit status is 1 if that is anything.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from time import monotonic, sleep

from symskill_pddl.cli.work import learn_from, shipped_demos
from symskill_pddl.demos import load_demos, save_demos
from symskill_pddl.errors import SymSkillError
from symskill_pddl.library import Library

MARK = "SYMSKILL_KILLS"
"""A variable in the environment of a command and of all that it starts."""
GRACE_S = 10.0
"""What a command started may take this long to notice that it is gone."""
Content = Mapping[str, bytes]


@dataclass(frozen=True)
class Subject:
    """A command to kill."""

    words: tuple[object, ...]
    """What the program is called with; it writes into `out`, below its working folder."""
    old: tuple[object, ...] = ()
    """The call that made what was there before; nothing was, if there is none."""
    grows: tuple[str, ...] = ()
    """Files that are there between a kill and the next run, and hold what was done so far."""
    check: Callable[[Path], object] = lambda _: None
    """Raises if an output, old or new, cannot be read."""


def subjects(inputs: Path) -> dict[str, Subject]:
    """The commands, with inputs that make them short."""
    shipped = {file.stem: file for file in shipped_demos()}
    few = {name: inputs / f"{name}.hdf5" for name in ("OpenDrawer", "CloseDrawer")}
    for name, file in few.items():
        save_demos(file, load_demos(shipped[name])[:1])
    library = inputs / "library"
    learn_from(tuple(few.values()), library)
    first, second = few.values()
    write = ("--force", "-o")
    evaluate = ("evaluate", library, "--tasks", "OpenDrawer", "--trials", 3, "--jobs", 2, "--keep-failed", "out/failed")
    return {
        "learn": Subject(
            ("learn", first, second, *write, "out/library"), ("learn", second, "-o", "out/library"), check=_load_library
        ),
        "record": Subject(
            ("record", "OpenDrawer", "-n", 1, "--seed", 1, *write, "out/a.hdf5"),
            ("record", "OpenDrawer", "-n", 1, "--seed", 0, "-o", "out/a.hdf5"),
            check=lambda folder: load_demos(folder / "a.hdf5"),
        ),
        "export": Subject(
            ("export", library, "--dialect", "all", "--name", "new", "-o", "out"),
            ("export", library, "--dialect", "all", "--name", "old", "-o", "out"),
        ),
        "evaluate": Subject((*evaluate, "-o", "out/r.json"), grows=("r.json.partial.jsonl",)),
    }


def _load_library(folder: Path) -> Library:
    return Library.load(folder / "library")


class Ground:
    """A working folder, and the environment in which a command runs there."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.out, self.temporary = folder, folder / "out", folder / "tmp"
        self._environment = {**os.environ, "TMPDIR": str(self.temporary), MARK: str(folder), "MUJOCO_GL": "disabled"}

    def clear(self, content: Content) -> None:
        shutil.rmtree(self.folder, ignore_errors=True)
        self.temporary.mkdir(parents=True)
        self.out.mkdir()
        for name, data in content.items():
            (self.out / name).parent.mkdir(parents=True, exist_ok=True)
            (self.out / name).write_bytes(data)

    def start(self, words: tuple[object, ...], errors: int = subprocess.DEVNULL) -> subprocess.Popen[bytes]:
        program = [sys.executable, "-m", "symskill_pddl.cli", *map(str, words)]
        quiet = subprocess.DEVNULL
        return subprocess.Popen(program, cwd=self.folder, env=self._environment, stdin=quiet, stdout=quiet, stderr=errors)

    def run(self, words: tuple[object, ...]) -> str:
        """The last line of what it said, if it did not end with 0."""
        if not words:
            return ""
        process = self.start(words, subprocess.PIPE)
        _, said = process.communicate()
        return "" if process.returncode == 0 else f"exit status {process.returncode}: {said.decode(errors='replace').strip()}"

    def content(self) -> dict[str, bytes]:
        return {str(p.relative_to(self.out)): p.read_bytes() for p in sorted(self.out.rglob("*")) if p.is_file()}

    def processes(self) -> list[int]:
        """Those whose environment has our mark."""
        mark, found = f"{MARK}={self.folder}\0".encode(), []
        for entry in Path("/proc").iterdir():
            if entry.name.isdigit():
                with suppress(OSError):
                    if mark in (entry / "environ").read_bytes() + b"\0":
                        found.append(int(entry.name))
        return found

    def writes(self) -> bool:
        """Whether something is being written."""
        with suppress(OSError):
            for path in self.out.rglob("*"):
                if path.name.endswith(".symskill") or (path.name.endswith(".saving") and path.stat().st_size):
                    return True
        return False


def killed(ground: Ground, subject: Subject, wait_s: float, *, writing: bool) -> bool:
    """Start it, wait (if `writing`, until it writes, and then for a moment), and kill it; False if it had ended before."""
    process = ground.start(subject.words)
    if writing:
        while process.poll() is None and not ground.writes():
            sleep(0.002)
        sleep(wait_s)
    else:
        with suppress(subprocess.TimeoutExpired):
            process.wait(wait_s)
    early = process.poll() is None
    process.send_signal(signal.SIGKILL)
    process.wait()
    return early


def found_wrong(ground: Ground, subject: Subject, old: Content, new: Content) -> Iterator[str]:
    """What is not as it should be after a kill, and after the next run."""
    until = monotonic() + GRACE_S
    while (left := ground.processes()) and monotonic() < until:
        sleep(0.05)
    if left:
        yield f"processes left: {left}"
        for pid in left:
            os.kill(pid, signal.SIGKILL)
    content = ground.content()
    for name in sorted(old.keys() | new.keys()):
        # a library's files have their checksum in their name, so these may be there beside each other
        if content.get(name) not in (old.get(name), new.get(name), None) or (
            name in old.keys() & new.keys() and name not in content
        ):
            yield f"{name} is neither the old one nor the new one"
    if old:
        try:
            subject.check(ground.out)
        except SymSkillError as error:
            yield f"what is there cannot be read: {error}"
    if said := ground.run(subject.words):
        yield f"the next run: {said}"
    again = ground.content()
    if different := sorted(name for name in again.keys() | new.keys() if again.get(name) != new.get(name)):
        yield f"after the next run these differ from a run without a kill: {', '.join(different)}"
    if temporary := sorted(str(p.relative_to(ground.folder)) for p in ground.temporary.rglob("*")):
        yield f"left for temporary files: {', '.join(temporary)}"


def measure(ground: Ground, name: str, subject: Subject, kills: int, draw: random.Random) -> int:
    """Kill one command so often; print what was found, and how many kills found something."""
    ground.clear({})
    ground.run(subject.old)
    old = ground.content()
    begin = monotonic()
    if said := ground.run(subject.words):
        print(f"{name}: does not run: {said}")
        return 1
    whole_s, new = monotonic() - begin, ground.content()
    early = wrong = mixed = 0
    for k in range(kills):
        ground.clear(old)
        writing = k % 2 == 1
        early += killed(ground, subject, draw.uniform(0.0, 0.03 if writing else whole_s), writing=writing)
        left = ground.content()
        mixed += any(name not in old.keys() | new.keys() and name not in subject.grows for name in left)
        problems = list(found_wrong(ground, subject, old, new))
        for problem in problems:
            print(f"{name}, kill {k}: {problem}", flush=True)
        wrong += bool(problems)
    print(
        f"{name}: {kills} kills, {early} before its end, {mixed} left something for the next run to clean; wrong: {wrong}",
        flush=True,
    )
    return wrong


def main() -> None:
    """See the module's docstring."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commands", nargs="*", metavar="COMMAND")
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    args = parser.parse_args()
    draw = random.Random(args.seed)
    with tempfile.TemporaryDirectory() as name:
        found = subjects(Path(name))
        chosen = args.commands or list(found)
        if unknown := sorted(set(chosen) - found.keys()):
            parser.error(f"unknown command '{unknown[0]}'; there are: {', '.join(found)}")
        ground = Ground(Path(name) / "ground")
        wrong = sum(measure(ground, command, found[command], args.kills, draw) for command in chosen)
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
