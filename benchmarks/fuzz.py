"""Fuzz the readers: spoil files that are right, in ways that have a grammar and ways that have none, and read them.

    python benchmarks/fuzz.py --minutes 10 [--reader NAME ...] [--keep FOLDER]

Nothing may come of it but what was read, or a `SymSkillError`. Every reader runs in a process of its own, case after case, each
from its number alone, so that `--reader NAME --case 4711` repeats one. Watched are other exceptions, the end of the process, 10 s
of processor time, a gigabyte of memory, files that are written or removed outside the case's folder, programs and connections
that are started, and files that are opened because an input names them. What is found is kept, the smallest case of each kind,
in `tests/data/fuzz/READER/KIND`, which the tests read again. Minutes are of wall-clock time, for each reader; the table says how
much processor time that was.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import resource
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from dataclasses import dataclass, field
from pathlib import Path
from random import Random
from typing import Any

from fuzz_mutations import SECRET, copy, spoil
from fuzz_readers import READERS, ROOT

LIMIT_S, LIMIT_MB, PATIENCE_S = 10.0, 1000, 120.0
"""Processor time and memory of one case; wall-clock time after which a process is taken to wait without end."""
KEEP = ROOT / "tests" / "data" / "fuzz"
LARGEST = 100_000
"""Bytes of a case that is kept."""
WRITES = ("os.mkdir", "os.remove", "os.rmdir", "os.rename", "os.link", "os.symlink", "os.chmod", "os.truncate")
STARTS = ("subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "socket.connect", "socket.getaddrinfo")


# ------------------------------------------------------------------------------------------------------------- one process


class Watch:
    """Hears of every file that Python opens, writes or removes, and of programs and connections."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.seen, self.on = os.path.realpath(folder), "", False
        sys.addaudithook(self)

    def __call__(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.on:
            return
        if event in STARTS:
            self.seen = f"{event} {arguments[0]!r}"
        elif event == "open" and isinstance(arguments[0], str | bytes):
            path, flags = os.fsdecode(arguments[0]), arguments[2]
            if path == SECRET:
                self.seen = f"opens {path}"
            elif isinstance(flags, int) and flags & (os.O_WRONLY | os.O_RDWR | os.O_CREAT):
                self._written(path, "open")
        elif event in WRITES and isinstance(arguments[0], str | bytes | os.PathLike):
            self._written(os.fsdecode(arguments[0]), event)

    def _written(self, path: str, how: str) -> None:
        if path != os.devnull and not os.path.realpath(path).startswith(self.folder):
            self.seen = f"{how} {path}"


def child(name: str, seed: Path, folder: Path, first: int) -> None:
    """Read cases from number `first` on, and say of each how it ended, until somebody ends us."""
    reader, here = READERS[name], folder / "here"
    here.mkdir(exist_ok=True)
    os.chdir(here)
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    resource.setrlimit(resource.RLIMIT_DATA, (4_000_000_000, 4_000_000_000))
    copy(seed, folder / "case")
    reader.read(folder / "case")  # what is right can be read; all modules are loaded
    watch = Watch(folder)
    for number in range(first, sys.maxsize):
        make(name, seed, folder / "case", number)
        print(json.dumps({"begin": number}), flush=True)
        # the peak of memory is counted from here
        Path("/proc/self/clear_refs").write_text("5")
        before = resource.getrusage(resource.RUSAGE_SELF)
        signal.setitimer(signal.ITIMER_PROF, LIMIT_S)
        watch.seen, watch.on = "", True
        fault = read(name, folder / "case")
        watch.on = False
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        after = resource.getrusage(resource.RUSAGE_SELF)
        peak = int(Path("/proc/self/status").read_text().split("VmHWM:")[1].split()[0]) // 1000
        if not fault and watch.seen:
            fault = f"outside: {watch.seen}"
        if not fault and peak > LIMIT_MB:
            fault = f"memory: {peak} MB"
        if not fault and (litter := list(here.iterdir())):
            fault = f"outside: writes {litter[0].name} where it runs"
        spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        print(json.dumps({"end": number, "fault": fault, "s": spent, "mb": peak}), flush=True)


def make(name: str, seed: Path, case: Path, number: int) -> None:
    """The files of a case."""
    copy(seed, case)
    spoil(Random(f"{name} {number}"), case)
    READERS[name].repair(case)


def read(name: str, case: Path) -> str:
    """What is wrong with how a case is read; nothing where it is read, or refused as it should be."""
    from symskill_pddl.errors import SymSkillError

    try:
        READERS[name].read(case)
    except SymSkillError as error:
        return "" if str(error).strip() and len(str(error)) < 20_000 else f"message of {len(str(error))} characters"
    except BaseException as error:  # noqa: BLE001 - whatever it is, it was found
        frames = [f for f in traceback.extract_tb(error.__traceback__) if "symskill_pddl" in f.filename]
        at = f"{Path(frames[-1].filename).name}:{frames[-1].name}" if frames else "elsewhere"
        return f"{type(error).__name__} in {at}: {' '.join(str(error).split())[:160]}"
    return ""


# ------------------------------------------------------------------------------------------------------------- the command


@dataclass
class Tally:
    """How a reader did."""

    cases: int = 0
    cpu_s: float = 0.0
    slowest_s: float = 0.0
    most_mb: int = 0
    faults: dict[str, tuple[int, int]] = field(default_factory=dict)
    """By kind: how often, and the case that is kept."""


def fuzz(name: str, minutes: float, keep: Path, first: int) -> Tally:
    """Run one reader for so long."""
    tally, end = Tally(), time.monotonic() + 60.0 * minutes
    with tempfile.TemporaryDirectory(prefix="fuzz-") as temporary:
        folder = Path(temporary)
        (folder / "seed").mkdir()
        READERS[name].seed(folder / "seed")
        while time.monotonic() < end:
            first = run(name, folder, first, end, tally, keep)
    return tally


def run(name: str, folder: Path, first: int, end: float, tally: Tally, keep: Path) -> int:
    """One process until it ends or time is over; the number of the next case."""
    call = [sys.executable, __file__, "--child", name, str(folder), str(first)]
    errors = folder / "stderr.txt"
    with errors.open("w") as stderr:
        process = subprocess.Popen(call, stdout=subprocess.PIPE, stderr=stderr, env={**os.environ, "MUJOCO_GL": "disabled"})
    stream, number, began = process.stdout, first, False
    assert stream is not None
    try:
        while time.monotonic() < end:
            if not select.select([stream], [], [], PATIENCE_S)[0]:
                found(name, folder, number, f"hang: nothing for {PATIENCE_S:g} s", tally, keep)
                return number + 1
            line = stream.readline()
            if not line:
                status = process.wait()
                if not began:
                    raise SystemExit(f"{name}: what is right cannot be read:\n{errors.read_text()[-3000:]}")
                hung = f"hang: over {LIMIT_S:g} s of processor time"
                found(name, folder, number, hung if status == -signal.SIGPROF else f"ended with {status}", tally, keep)
                return number + 1
            if not line.startswith(b"{"):
                found(name, folder, number, "outside: prints to standard output", tally, keep)
                continue
            said = json.loads(line)
            began = True
            number = said.get("begin", number)
            if "end" in said:
                tally.cases += 1
                tally.cpu_s += said["s"]
                tally.slowest_s, tally.most_mb = max(tally.slowest_s, said["s"]), max(tally.most_mb, said["mb"])
                if said["fault"]:
                    found(name, folder, number, said["fault"], tally, keep)
                number += 1
        return number
    finally:
        process.kill()
        process.wait()
        stream.close()


def found(name: str, folder: Path, number: int, fault: str, tally: Tally, keep: Path) -> None:
    """Count a fault, and keep its case if it is the first or smallest of its kind."""
    kind = fault.split(":")[0] if fault.startswith(("memory", "hang", "outside", "ended")) else fault.partition(": ")[0]
    count, _ = tally.faults.get(kind, (0, number))
    tally.faults[kind] = (count + 1, number)
    if count == 0:
        print(f"{name}, case {number}: {fault}", flush=True)
    case = folder / "again"
    make(name, folder / "seed", case, number)
    place = keep / name / hashlib.sha256(kind.encode()).hexdigest()[:10]
    if size(case) <= LARGEST and (not place.exists() or size(case) < size(place)):
        shutil.rmtree(place, ignore_errors=True)
        shutil.copytree(case, place, symlinks=True, ignore_dangling_symlinks=True)


def size(folder: Path) -> int:
    """Bytes of the regular files."""
    return sum(p.stat().st_size for p in folder.rglob("*") if p.is_file() and not p.is_symlink())


def main() -> None:
    """Run the readers one after another and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--reader", action="append", choices=sorted(READERS))
    parser.add_argument("--keep", type=Path, default=KEEP)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--case", type=int, help="read this case only, and show the traceback")
    options = parser.parse_args()
    names = options.reader or sorted(READERS)
    if options.case is not None:
        with tempfile.TemporaryDirectory(prefix="fuzz-") as folder:
            Path(folder, "seed").mkdir()
            READERS[names[0]].seed(Path(folder, "seed"))
            make(names[0], Path(folder, "seed"), Path(folder, "case"), options.case)
            READERS[names[0]].read(Path(folder, "case"))
        return
    print("| reader | cases | processor time [s] | slowest [s] | most memory [MB] | faults |\n|---|---|---|---|---|---|")
    faults = 0
    for name in names:
        tally = fuzz(name, options.minutes, options.keep, options.first)
        kinds = "; ".join(f"{kind} ({n} times, case {case})" for kind, (n, case) in tally.faults.items()) or "none"
        numbers = f"{tally.cases} | {tally.cpu_s:.0f} | {tally.slowest_s:.1f} | {tally.most_mb}"
        print(f"| {name} | {numbers} | {kinds} |", flush=True)
        faults += len(tally.faults)
    sys.exit(faults > 0)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        child(sys.argv[2], Path(sys.argv[3], "seed"), Path(sys.argv[3]), int(sys.argv[4]))
    else:
        main()
