"""The engines called the way their own documentation says, without this package: what `benchmarks/planning.py` compares with.

Each takes the texts of a domain and a problem and a time limit, and gives the number of steps, or None without a plan.
"""

from __future__ import annotations

import logging
import os
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path


def kairos(domain: str, problem: str, time_s: float) -> int | None:
    """In process; one plan."""
    import kairos as engine

    search = engine.Planner().start(engine.parse_problem(problem, engine.parse_domain(domain)), timeout=time_s, anytime=False)
    plan = search.wait_first(time_s)
    return None if plan is None else len(plan.steps)


def mimir(domain: str, problem: str, time_s: float) -> int | None:
    """In process; lifted lazy greedy search."""
    import pymimir as engine

    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)  # it prints what it grounds
    try:
        task = engine.Problem(engine.Domain(domain), problem, mode="lifted")
        found = engine.gbfs_lazy(task, task.get_initial_state(), engine.FFHeuristic(task), max_time_seconds=time_s)
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)
    return None if found.solution is None else len(found.solution)


def pyperplan(domain: str, problem: str, _time_s: float) -> int | None:
    """In process; A* with h_add. It knows no time limit."""
    from pyperplan import planner as engine

    logging.disable(logging.INFO)
    parser = engine.Parser("", "")
    parser.domInput, parser.probInput = domain, problem
    task = engine.grounding.ground(parser.parse_problem(parser.parse_domain(read_from_file=False), read_from_file=False))
    found = engine.SEARCHES["astar"](task, engine.HEURISTICS["hadd"](task))
    return None if found is None else len(found)


def fast_downward(domain: str, problem: str, time_s: float) -> int | None:
    """Its driver, as a program."""
    driver = _folder("up_fast_downward") / "downward" / "fast-downward.py"
    search = "let(hff,ff(),lazy_greedy([hff],preferred=[hff],cost_type=plusone,reopen_closed=false))"
    words = [sys.executable, driver, "--plan-file", "plan.txt", "domain.pddl", "problem.pddl", "--search", search]
    return _program(words, {"domain.pddl": domain, "problem.pddl": problem}, "plan.txt", time_s)


def lpg(domain: str, problem: str, time_s: float) -> int | None:
    """The program."""
    words = [_folder("up_lpg") / "lpg", "-o", "domain.pddl", "-f", "problem.pddl", "-n", "1", "-seed", "1", "-out", "plan"]
    return _program(words, {"domain.pddl": domain, "problem.pddl": problem}, "plan_1.SOL", time_s)


DIRECT = {"kairos": kairos, "mimir": mimir, "pyperplan": pyperplan, "fast-downward": fast_downward, "lpg": lpg}
"""By the name of the planner."""


def _folder(module: str) -> Path:
    found = find_spec(module)
    if found is None or found.origin is None:
        raise ImportError(module)
    return Path(found.origin).parent


def _program(words: list[str | Path], files: dict[str, str], plan: str, time_s: float) -> int | None:
    with tempfile.TemporaryDirectory() as folder:
        for name, text in files.items():
            (Path(folder) / name).write_text(text)
        process = subprocess.Popen(
            words, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )
        try:
            process.wait(time_s)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, 9)
            process.wait()
        if not (Path(folder) / plan).exists():
            return None
        return sum("(" in line and not line.startswith(";") for line in (Path(folder) / plan).read_text().splitlines())
