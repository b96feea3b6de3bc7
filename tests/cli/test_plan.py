"""symskill plan: files in, plan out, and why not."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Files = tuple[Path, Path]
PLAN = "(take ball red)\n(put ball blue)\n"


@pytest.mark.parametrize("planner", ["auto", "builtin", "pyperplan"])
def test_a_plan_is_printed_and_written(symskill: Callable[..., Any], toys: Files, tmp_path: Path, planner: str) -> None:
    done = symskill("plan", *toys, "--planner", planner)
    assert done.status == 0
    assert done.out.startswith(PLAN)
    output = tmp_path / "plan.txt"
    assert symskill("plan", *toys, "--planner", planner, "-o", output).out == ""
    assert output.read_text().startswith(PLAN)


def test_json_is_one_document(symskill: Callable[..., Any], toys: Files) -> None:
    done = symskill("plan", *toys, "--json")
    document = json.loads(done.out)
    assert document["status"] == "solved"
    assert document["steps"] == [["take", "ball", "red"], ["put", "ball", "blue"]]


def test_a_goal_that_holds_needs_no_step(symskill: Callable[..., Any], toys: Files) -> None:
    domain, problem = toys
    problem.write_text(problem.read_text().replace("(:goal (and (in ball blue)))", "(:goal (and (in ball red)))"))
    done = symskill("plan", domain, problem, "--json")
    assert done.status == 0
    assert json.loads(done.out)["steps"] == []


def test_an_unsolvable_goal_exits_with_1_and_says_why(symskill: Callable[..., Any], toys: Files, tmp_path: Path) -> None:
    domain, problem = toys
    problem.write_text(problem.read_text().replace("(in ball blue)))", "(in ball blue) (lost car)))"))
    old = tmp_path / "plan.txt"
    old.write_text("precious\n")
    done = symskill("plan", domain, problem, "-o", old, "--force")
    assert done.status == 1
    assert "unsolvable" in done.error
    assert "no operator adds 'lost'" in done.err
    assert "the nearest goal that can be reached: (in ball blue)" in done.err
    assert old.read_text() == "precious\n"
    document = json.loads(symskill("plan", domain, problem, "--json").out)
    assert document["steps"] is None
    assert document["why_not"]


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        (("(in ball blue)", "(inside ball blue)"), "tidy.pddl:4:15: unknown predicate 'inside'"),
        (("(in ball blue)", "(in ball green)"), "green"),
        (("(in ball blue)", "(in ball blue"), "never closed"),
        (("(in ball red)", "(in red ball)"), "tidy.pddl:3"),
    ],
)
def test_a_wrong_problem_is_one_line_with_its_place(
    symskill: Callable[..., Any], toys: Files, tmp_path: Path, edit: tuple[str, str], message: str
) -> None:
    domain, problem = toys
    problem.write_text(problem.read_text().replace(*edit))
    output = tmp_path / "plan.txt"
    done = symskill("plan", domain, problem, "-o", output)
    assert done.status == 2
    assert message in done.error
    assert not output.exists()


def test_missing_files_unknown_planners_and_silly_limits(symskill: Callable[..., Any], toys: Files, tmp_path: Path) -> None:
    domain, problem = toys
    assert "there is no domain" in symskill("plan", tmp_path / "no.pddl", problem).error
    assert "there is no problem" in symskill("plan", domain, tmp_path / "no.pddl").error
    assert "is a folder" in symskill("plan", tmp_path, problem).error
    assert "unknown planner 'oracle'" in symskill("plan", *toys, "--planner", "oracle").error
    assert "above zero" in symskill("plan", *toys, "--timeout", "0").error
    (tmp_path / "binary.pddl").write_bytes(b"\xff\xfe\x00")
    assert "not UTF-8" in symskill("plan", tmp_path / "binary.pddl", problem).error


def test_every_engine_in_a_table(symskill: Callable[..., Any], toys: Files, tmp_path: Path) -> None:
    done = symskill("plan", *toys, "--all-engines", "-o", tmp_path / "plan.txt", "--json")
    document = json.loads(done.out)
    assert (document["format"], document["version"]) == ("symskill-plan", 1)
    by = {answer["planner"]: answer for answer in document["engines"]}
    assert by["builtin"]["steps"] == [["take", "ball", "red"], ["put", "ball", "blue"]]
    assert (tmp_path / "plan.txt").read_text().startswith(PLAN)
    assert "builtin" in symskill("plan", *toys, "--all-engines").out
    assert "neither --planner nor --k" in symskill("plan", *toys, "--all-engines", "--k", "2").error


def test_several_plans(symskill: Callable[..., Any], toys: Files) -> None:
    done = symskill("plan", *toys, "--k", "3", "--planner", "builtin", "--json")
    plans = [answer["steps"] for answer in json.loads(done.out)["plans"]]
    assert plans[0] == [["take", "ball", "red"], ["put", "ball", "blue"]]
    assert len({json.dumps(plan) for plan in plans}) == len(plans)
    assert symskill("plan", *toys, "--k", "0").status == 2
