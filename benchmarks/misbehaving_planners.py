"""Planners that misbehave: whether their time limit holds, and whether anything is left of them.

    python benchmarks/misbehaving_planners.py [--runs 100] [--time 1.0] [-o FILE.md]

Runs small programs as planners, each way of misbehaving in turn, then kills processes that are asking such a planner. Counted are
processes of theirs that are left, and files in the folder for temporary ones. The last column is the longest answer over the
time limit. Ends with 1 where something is left. Needs /proc.
"""

from __future__ import annotations

import argparse
import os
import shlex
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import NamedTuple

from symskill_pddl.planning import Command, Limits, PlanResult
from symskill_pddl.symbols import Atom, Domain, Operator, Parameter, Predicate, Problem, Type

MOVE = Operator(
    "move", (Parameter("?a", "box"),), frozenset({Atom("here", ("?a",))}), frozenset({Atom("there", ("?a",))}), frozenset()
)
DOMAIN = Domain("boxes", (Type("box"),), (Predicate("here", ("box",)), Predicate("there", ("box",))), (MOVE,))
PROBLEM = Problem("one", "boxes", (("b", "box"),), frozenset({Atom("here", ("b",))}), frozenset({Atom("there", ("b",))}))
PLAN = "(move b)"


class Way(NamedTuple):
    """How a planner misbehaves, as a shell script with arguments MARK DOMAIN PROBLEM PLAN, and what has to come of it."""

    script: str
    status: str
    """Of the answer."""
    said: str = ""
    """In its messages."""


def _python(code: str) -> str:
    return f'exec {shlex.quote(sys.executable)} -I -S -c {shlex.quote("import os, signal, sys, time; " + code)} "$@"'


DETACHED = """env -i setsid sh -c "trap '' TERM; sh -c 'sleep 60; :' $1 & sleep 60; :" "$1" &"""
FORKS = _python("[os.fork() or (os.setsid(), time.sleep(60)) for _ in range(600)]; time.sleep(60)")
FILES = _python("[open('f' + str(i), 'wb').write(bytes(10**7)) for i in range(100)]; time.sleep(60)")
NAMELESS = _python("k = [open('f', 'wb') for _ in range(60) if not os.path.exists('f') or not os.unlink('f')]; "
    "[f.write(bytes(10**7)) for f in k]; time.sleep(60)")  # fmt: skip
EMPTY = _python("[open('f' + str(i), 'w').close() for i in range(12000)]; time.sleep(60)")
MEMORY = _python("[os.fork() for _ in range(4)]; b = b'1' * (40 << 20); time.sleep(60)")
DEEP = _python("[(os.mkdir('d'), os.chdir('d')) for _ in range(3000)]; sys.exit(4)")

WAYS = {
    "ignores SIGTERM": Way("trap '' TERM; while :; do sleep 60; done", "timeout"),
    "detaches twice, ends": Way(f"({DETACHED}); exit 3", "failed", "status 3"),
    "detaches, goes on": Way(f"{DETACHED} sleep 60", "timeout"),
    "starts processes": Way(FORKS, "failed", "processes"),
    "floods its output": Way("yes '(not a step)'", "timeout"),
    "floods the disk": Way(FILES, "failed", "MB"),
    "floods the disk, nameless": Way(NAMELESS, "failed", "MB"),
    "makes many files": Way(EMPTY, "failed", "ten thousand files"),
    "its plan is a FIFO": Way('mkfifo "$4"', "failed", "no plan"),
    "its plan is a device": Way('ln -s /dev/zero "$4"', "failed", "no plan"),
    "its plan is a folder": Way('mkdir -p "$4/plan.txt"; chmod 0 "$4"', "failed", "no plan"),
    "its plan is a loop": Way('ln -s "$4" "$4"', "failed", "no plan"),
    "removes its folder": Way('rm -r "$PWD"', "failed", "no plan"),
    "puts a link in its folder's place": Way('rm -r "$PWD"; ln -s / "$PWD"', "failed", "no plan"),
    "closes its output": Way("exec >&- 2>&-; sleep 60", "timeout"),
    "takes memory": Way(MEMORY, "failed", "memory"),
    "prints control characters": Way(
        r"printf '\033]52;c;AAAA\007\000\377\n'; head -c 100000 /dev/urandom; exit 5", "failed", "status 5"
    ),
    "stops itself": Way("kill -STOP $$", "timeout"),
    "leaves who holds its output": Way(f"(setsid sleep 60; echo) & echo '{PLAN}' > \"$4\"", "solved"),
    "ends what watches it": Way("setsid sleep 60 & kill -KILL $PPID; sleep 60", "failed", "was ended"),
    "asks what watches it to end": Way("kill -TERM $PPID; kill -HUP $PPID; sleep 60", "timeout"),
    "makes deep folders": Way(DEEP, "failed", "status 4"),
}


def planner(way: Way, mark: str) -> Command:
    """The program; `mark` is in the arguments of its processes, and in their environment where they keep it."""
    return Command(f"sh -c {shlex.quote(way.script)} sh {mark} {{domain}} {{problem}} {{plan}}")


def ask(way: Way, mark: str, time_s: float) -> PlanResult:
    """Its answer; those that end by themselves, or by another bound than time, get a minute for it."""
    limits = Limits(time_s=time_s if way.status == "timeout" else 60.0, memory_mb=300)
    return planner(way, mark).solve(DOMAIN, PROBLEM, limits)


def kill_while_asking(way: Way, mark: str, started: int = 3) -> None:
    """Start a process that asks, and kill it when so many run: it, the one that watches, and the planner's."""
    code = f"import sys; sys.path[:0] = {[str(Path(__file__).parent)]!r}; import misbehaving_planners as m; "
    code += f"m.ask(m.Way({way.script!r}, ''), {mark!r}, 60.0)"
    asking = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    while len(running(mark)) < started and asking.poll() is None:
        time.sleep(0.01)
    asking.send_signal(signal.SIGKILL)
    asking.wait()


def running(mark: str) -> list[int]:
    """Processes that have the mark in their arguments or their environment and have not ended, this one apart."""
    found = []
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            about = (folder / "cmdline").read_bytes() + (folder / "environ").read_bytes()
        except OSError:
            continue
        if mark.encode() in about and folder.name != str(os.getpid()):
            found.append(int(folder.name))
    return found


def left(mark: str) -> int:
    """How many are left when all had two seconds to go."""
    for _ in range(100):
        if not running(mark):
            return 0
        time.sleep(0.02)
    return len(running(mark))


def main() -> int:
    """Run all ways, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=100, help="in all (100)")
    parser.add_argument("--time", type=float, default=1.0, help="time limit [s] (1)")
    parser.add_argument("-o", "--output", type=Path, help="also write the table there")
    arguments = parser.parse_args()
    rows = ["| way | runs | answers | as expected | processes left | longest over limit |", "|---|---|---|---|---|---|"]
    total = 0
    with tempfile.TemporaryDirectory() as folder:
        tempfile.tempdir = os.environ["TMPDIR"] = folder
        share = {name: len(range(i, arguments.runs, len(WAYS) + 1)) for i, name in enumerate([*WAYS, "killed"])}
        for name, way in WAYS.items():
            answers, as_expected, remains, longest = Counter[str](), 0, 0, 0.0
            for i in range(share[name]):
                mark = f"symskill-mark-{os.getpid()}-{i}"
                found = ask(way, mark, arguments.time)
                answers[found.status.value] += 1
                longest = max(longest, found.seconds / arguments.time)
                as_expected += found.status.value == way.status and way.said in " ".join(found.messages)
                remains += left(mark)
            said = ", ".join(f"{status} {n}" for status, n in sorted(answers.items()))
            over = f"{longest:.2f}" if way.status == "timeout" else "-"
            rows.append(f"| {name} | {share[name]} | {said} | {as_expected} | {remains} | {over} |")
            total += remains
        remains = 0
        for i in range(share["killed"]):
            mark = f"symskill-mark-{os.getpid()}-{i}"
            kill_while_asking(WAYS["detaches, goes on"], mark, started=5)
            remains += left(mark)
        rows.append(f"| killed while it asks | {share['killed']} | - | - | {remains} | - |")
        files = len(list(Path(folder).iterdir()))
    text = "\n".join([*rows, "", f"Left: {total + remains} processes, {files} folders, of {arguments.runs} runs."])
    print(text)
    if arguments.output is not None:
        arguments.output.write_text(text + "\n", encoding="utf-8")
    return 1 if total + remains + files else 0


if __name__ == "__main__":
    sys.exit(main())
