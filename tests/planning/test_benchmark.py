"""The benchmark's problems are those it says they are, and a row of it can be measured."""

import importlib.util
import sys
from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import pytest

from symskill_pddl.pddl import read_domain, read_problem
from symskill_pddl.planning import Builtin
from symskill_pddl.symbols import check_problem

FOLDER = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture(scope="module")
def benchmark():
    spec = importlib.util.spec_from_file_location("planning_benchmark", FOLDER / "planning.py")
    path = list(sys.path)
    module = sys.modules["planning_benchmark"] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    sys.path[:] = path
    return module


@pytest.fixture(scope="module")
def table():
    return read_domain((FOLDER / "data" / "planning" / "domain.pddl").read_text(), "domain.pddl")


def test_the_maker_gives_the_stored_problem(benchmark, table):
    stored = read_problem((FOLDER / "data" / "planning" / "example.pddl").read_text(), table, "example.pddl")
    made = benchmark.table_problem(table, 5, "g12")
    assert (made.init, made.goal, made.object_types) == (stored.init, stored.goal, stored.object_types)


@pytest.mark.parametrize("size", [2, 5, 10, 100])
def test_problems_are_well_formed(benchmark, table, size):
    for goal in ("g12", "gall"):
        problem = benchmark.table_problem(table, size, goal)
        check_problem(table, problem)
        assert sum(kind == "thing" for _, kind in problem.objects) == size
        assert not problem.goal <= problem.init


def test_a_row(benchmark, table):
    row = benchmark.measure(Builtin(), table, benchmark.table_problem(table, 2, "g12"), "12 steps", 2)
    assert row.steps == 12
    assert row.direct_ms is None
    assert 0.0 < row.warm_ms < row.cold_ms
    assert "| builtin | 2 | 12 |  |" in benchmark.markdown([row], 1.0)
    drawing = benchmark.drawn([row, replace(row, size=20)])
    assert ElementTree.fromstring(drawing).tag.endswith("svg")
    assert "12 steps" in drawing


def test_what_the_protocol_adds(benchmark, table):
    """About 2 ms of processor time, twelve steps, from the symbols to a plan that was checked; no bound, as machines differ."""
    added = benchmark.overhead(table, benchmark.table_problem(table, 20, "g12"), "12 steps", 20)
    assert added.steps == 13
    assert 0.0 < added.warm_ms < added.cold_ms
    assert "| 12 steps, 20 things | 13 |" in benchmark.markdown([], 1.0, [added])
