"""The main job through the commands: shipped demonstrations in, PDDL out, a task nobody demonstrated carried out."""

from __future__ import annotations

import filecmp
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from symskill_pddl.cli.work import learn_from, shipped_demos
from symskill_pddl.errors import MissingDependencyError
from symskill_pddl.execution.replay import replay
from symskill_pddl.execution.trace import read_trace
from symskill_pddl.kitchen.film import check_film, encoder

ROOT = Path(__file__).parent.parent.parent
pytestmark = pytest.mark.simulation


@pytest.fixture(scope="module")
def kitchen(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The library of the shipped demonstrations. Not to be changed."""
    folder = tmp_path_factory.mktemp("kitchen") / "library"
    learn_from(shipped_demos(), folder)
    return folder


def test_the_examples_in_the_repository_are_what_the_commands_make(tmp_path: Path) -> None:
    environment = {**os.environ, "SYMSKILL": str(Path(sys.executable).parent / "symskill")}
    subprocess.run([ROOT / "scripts" / "make_examples.sh", tmp_path], check=True, env=environment, capture_output=True)
    for folder in ("domains/kitchen", "domains/play", "problems/kitchen", "problems/play"):
        made, stored = (
            sorted(str(p.relative_to(root / folder)) for p in (root / folder).rglob("*.*")) for root in (tmp_path, ROOT)
        )
        assert made == stored
        _, different, missing = filecmp.cmpfiles(tmp_path / folder, ROOT / folder, made, shallow=False)
        assert (different, missing) == ([], [])
    assert (tmp_path / "README.md").read_text() == (ROOT / "README.md").read_text()


@pytest.mark.parametrize("problem", sorted((ROOT / "problems" / "kitchen").glob("*.pddl")), ids=lambda p: p.stem)
@pytest.mark.parametrize("planner", ["builtin", "pyperplan"])
def test_every_example_is_solved_and_its_plan_binds(
    symskill: Callable[..., Any], kitchen: Path, tmp_path: Path, problem: Path, planner: str
) -> None:
    domain, plan = ROOT / "domains" / "kitchen" / "domain.pddl", tmp_path / "plan.txt"
    done = symskill("plan", domain, problem, "--planner", planner, "-o", plan)
    assert done.status == 0, done.err
    checked = symskill("check", kitchen, domain, problem, plan, "--json")
    assert checked.status == 0, checked.err
    document = json.loads(checked.out)
    assert document["runs"]
    assert document["findings"] == []
    assert len(document["plan"]) == len(plan.read_text().strip().splitlines()) - plan.read_text().count(";")


def test_a_domain_edited_by_hand_is_checked(symskill: Callable[..., Any], kitchen: Path, tmp_path: Path) -> None:
    text = (ROOT / "domains" / "kitchen" / "domain.pddl").read_text()
    edited = tmp_path / "domain.pddl"
    action = text.split("(:action ")[1].split()[0]
    edited.write_text(text.replace(f"(:action {action}", "(:action my-action"))
    done = symskill("check", kitchen, edited)
    assert done.status == 0
    assert f"was '{action}', known by its effects" in done.out
    edited.write_text(text.replace("(not (gripper-open))", ""))
    done = symskill("check", kitchen, edited)
    assert done.status == 1
    assert "no longer deletes (gripper-open)" in done.out


def test_a_domain_edited_by_hand_runs(symskill: Callable[..., Any], kitchen: Path, tmp_path: Path) -> None:
    domain, problem, results = tmp_path / "domain.pddl", tmp_path / "problem.pddl", tmp_path / "results.json"
    episode = ("--task", "CloseDrawer", "--seed", 0)
    assert symskill("export", kitchen, "-o", tmp_path).status == 0
    assert symskill("problem", kitchen, *episode, "-o", problem).status == 0
    domain.write_text(domain.read_text().replace("(:action close-drawer", "(:action push-it-shut"))
    problem.write_text(problem.read_text().replace("    bread - food\n", "").replace("(food-in-cabinet bread cabinet-1)", ""))
    done = symskill("run", kitchen, *episode, "--domain", domain, "--problem", problem, "--json")
    document = json.loads(done.out)
    assert (done.status, document["success"]) == (0, True), document["reason"]
    assert [s["step"].split()[0].strip("(") for s in document["steps"]] == ["reach-drawer-open", "push-it-shut"]
    assert "was 'close-drawer', known by its effects" in done.err
    call = (
        "evaluate",
        kitchen,
        "--tasks",
        "CloseDrawer",
        "--trials",
        1,
        "--seed",
        0,
        "--domain",
        domain,
        "--json",
        "-o",
        results,
    )
    edited = json.loads(symskill(*call).out)
    assert edited["tasks"][0]["successes"] == 1
    without = [a for a in call if a not in ("--domain", domain)]
    other = symskill(*without)
    assert (other.status, "holds the results of another evaluation (library " in other.error) == (2, True)
    plain = json.loads(symskill(*without, "--force").out)
    assert edited["settings"]["library"] != plain["settings"]["library"]


@pytest.mark.parametrize(
    ("goal", "message"),
    [
        ("(food-beside-moon cheese)", "unknown predicate 'food-beside-moon'"),
        ("(gripper-holds-food gouda)", "unknown object 'gouda'"),
        ("(gripper-holds-food", "never closed"),
    ],
)
def test_a_wrong_goal(symskill: Callable[..., Any], kitchen: Path, tmp_path: Path, goal: str, message: str) -> None:
    old = tmp_path / "old"
    old.write_text("precious")
    for command, option in (("problem", "-o"), ("run", "--trace")):
        done = symskill(command, kitchen, "--task", "StoreCheese", "--goal", goal, option, old, "--force")
        assert done.status == 2
        assert message in done.error
        assert done.error.startswith("--goal:1:")
    assert old.read_text() == "precious"


def test_a_goal_that_cannot_be_reached(symskill: Callable[..., Any], kitchen: Path, tmp_path: Path) -> None:
    goal = "(gripper-holds-food cheese) (gripper-holds-food bread)"
    problem = tmp_path / "problem.pddl"
    symskill("export", kitchen, "-o", tmp_path)
    assert symskill("problem", kitchen, "--task", "StoreCheese", "--goal", goal, "-o", problem).status == 0
    done = symskill("plan", tmp_path / "domain.pddl", problem)
    assert done.status == 1
    assert "the nearest goal that can be reached: (gripper-holds-food" in done.err
    trace, off = tmp_path / "trace.jsonl", ("--no-resampling", "--no-replanning", "--no-obstacles")
    done = symskill("run", kitchen, "--task", "StoreCheese", "--goal", goal, *off, "--trace", trace, "--json")
    assert done.status == 1
    assert json.loads(done.out)["category"] == "goal unreachable"
    header = read_trace(trace).header
    assert (header.monitor, header.resampling, header.replanning, header.obstacles) == (True, False, False, False)


def test_a_run_is_filmed(symskill: Callable[..., Any], kitchen: Path, tmp_path: Path) -> None:
    try:
        check_film()
    except MissingDependencyError as error:
        pytest.skip(str(error))
    video, trace = tmp_path / "run.mp4", tmp_path / "trace.jsonl"
    # a goal that holds already: one picture
    call = ("run", kitchen, "--task", "OpenDrawer", "--goal", "(gripper-open)", "--trace", trace)
    done = symskill(*call, "--video", video)
    assert (done.status, f"{video}: written" in done.err) == (0, True), done.err
    assert sum(1 for _ in encoder().read_frames(str(video))) == 2  # what it is, then the picture
    filmed = [line.model_dump(exclude={"seconds", "ms"}) for line in read_trace(trace).lines]
    assert symskill(*call).status == 0
    assert [line.model_dump(exclude={"seconds", "ms"}) for line in read_trace(trace).lines] == filmed


def test_store_cheese_survives_a_door_shut_in_the_middle(symskill: Callable[..., Any], kitchen: Path, tmp_path: Path) -> None:
    trace = tmp_path / "trace.jsonl"
    call = ("run", kitchen, "--task", "StoreCheese", "--seed", 0, "--disturb", "close-door@op=2", "--trace", trace, "--json")
    done = symskill(*call)
    document = json.loads(done.out)
    assert (done.status, document["success"]) == (0, True), document["reason"]
    assert document["replans"] >= 1
    recorded = read_trace(trace)
    assert any("close-door" in note.text for note in recorded.of("note"))
    assert all(decision.same for decision in replay(recorded))
    assert not list(tmp_path.glob("*.partial"))
    page = tmp_path / "report.html"
    assert symskill("report", trace, "-o", page).status == 0
    assert "StoreCheese" in page.read_text()


def test_a_task_is_evaluated(symskill: Callable[..., Any], kitchen: Path, tmp_path: Path) -> None:
    results, page = tmp_path / "results.json", tmp_path / "results.html"
    call = ("evaluate", kitchen, "--tasks", "CloseSingleDoor", "--trials", 2, "--seed", 1000, "--json")
    one = symskill(*call, "--jobs", 1, "-o", results)
    assert one.status == 0
    (task,) = json.loads(one.out)["tasks"]
    assert (task["trials"], len(task["episodes"])) == (2, 2)
    first = results.read_bytes()
    assert symskill(*call, "--jobs", 2, "-o", results).status == 0
    assert results.read_bytes() == first
    assert symskill("report", results, "-o", page).status == 0
    assert "CloseSingleDoor" in page.read_text()
