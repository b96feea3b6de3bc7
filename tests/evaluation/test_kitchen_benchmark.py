"""benchmarks/kitchen.py: what it would measure, and the page it makes of made-up results."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from symskill_pddl.evaluation.ablations import without
from symskill_pddl.evaluation.results import EpisodeResult, Results, summarise
from symskill_pddl.evaluation.suite import of_kind
from symskill_pddl.kitchen import TASKS
from symskill_pddl.kitchen.arena import ARENA
from symskill_pddl.kitchen.disturbances import KINDS

FOLDER = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def modules(monkeypatch: pytest.MonkeyPatch) -> tuple[Any, Any]:
    monkeypatch.syspath_prepend(str(FOLDER))
    import kitchen_page
    import kitchen_suites

    return kitchen_suites, kitchen_page


def test_everything_the_kitchen_has_is_measured_when_it_is_recorded(modules: tuple[Any, Any]) -> None:
    suites, _ = modules
    found, missing = suites.entries(set(TASKS))
    names = [e.name for e in found]
    assert len(set(names)) == len(names)
    assert all("the kitchen has no such task" in text for text in missing)
    covered = {task for e in found for task in e.tasks}
    assert covered >= set(of_kind(ARENA, "atomic", "play goal"))
    assert {f"with-{kind}" for kind in KINDS} <= set(names)
    for entry in found:
        small, whole = entry.suite(0.01, 7), entry.suite(1.0, 7)
        assert small.trials == 1
        assert whole.seed == 7
        assert len(whole.episodes) >= 30
        for mechanism in entry.against:
            without(whole, mechanism)
        assert f"--seed 7 {' '.join(f'--disturb {d}' for d in entry.disturbances)}".strip() in entry.command(1.0, 7)


def test_what_nobody_has_recorded_is_left_out_and_said(modules: tuple[Any, Any]) -> None:
    suites, _ = modules
    found, missing = suites.entries({"OpenSingleDoor"})
    assert {task for e in found for task in e.tasks} == {"OpenSingleDoor"}
    assert "StoreCheese: no recording of PnPCabToCounter, CloseSingleDoor is shipped" in missing
    assert "PlayServe: no recording of Play is shipped" in missing


def test_the_page_tells_rates_differences_and_every_failure(
    modules: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    suites, pages = modules
    monkeypatch.setattr(pages, "ROBOCASA", tmp_path / "none.md")
    found, missing = suites.entries(set(TASKS))

    def made_up(entry: Any, bad: int, mechanism: str = "") -> Results:
        suite = entry.suite(0.1, 5000)
        suite = without(suite, mechanism) if mechanism else suite

        def episode(i: int) -> EpisodeResult:
            cause = "grasp" if i < bad else ""
            return EpisodeResult(
                seed=5000 + i, success=not cause, category="replan limit" if cause else "success", cause=cause,
                troubles={"motion": 1}, reason="a | b" if cause else "", replans=1, recoveries=0, steps=1, time_s=10.0,
                touched_s=0.5,
            )  # fmt: skip

        return Results(
            settings=suite.settings("abc"), tasks=tuple(summarise(t, map(episode, range(suite.trials))) for t in suite.tasks)
        )

    measured = []
    for entry in found[:-1]:
        others = {mechanism: made_up(entry, 2, mechanism) for mechanism in entry.against}
        measured.append(pages.Measured(entry, made_up(entry, int(entry.name == "store")), others))
    text = pages.page(measured, [*missing, "Fly: no wings"], found[-1:], "the command", 0.1, 5000)
    assert text.count("\n## ") == len({e.figure for e in found}) + 3
    assert "| StoreCheese | 4 of 5 | 0.80 | 0.38-0.96 | 10 | 1.0 | 0.0 | 5 motion | 1 grasp |" in text
    assert "| StoreCheese, door shut, no replanning | 1 of 3 | 0.33 |" in text
    assert "| door shut, replanning | 3, 1 of 3 | +0.67 | -0.06 to +0.94 | 0.5 | 1.0, 1.0 | 0.5, 0.5 |" in text
    assert "| obstacle, no monitor, obstacles | 3, 1 of 3 |" in text
    assert "| store | StoreCheese | 5000 | grasp | replan limit: a / b |" in text
    assert f"Not finished: {found[-1].name}." in text
    assert "- Fly: no wings" in text
    assert "**At 0.1 of the full number of episodes.**" in text


def test_the_page_has_robocasa_s_table_where_it_was_measured(
    modules: tuple[Any, Any], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    _, pages = modules
    import robocasa_kitchens

    monkeypatch.setattr(pages, "ROBOCASA", tmp_path / "results-robocasa.md")
    assert "RoboCasa" not in pages.page([], [], [], "the command", 1.0, 5000)

    def episode(seed: int, success: bool) -> EpisodeResult:
        return EpisodeResult(
            seed=seed, success=success, category="success" if success else "replan limit", cause="", reason="", replans=0,
            recoveries=0, steps=1, time_s=9.0,
        )  # fmt: skip

    found = {
        ("OpenDrawer", True): [episode(i, i > 0) for i in range(4)],
        ("OpenDrawer", False): [episode(i, i > 1) for i in range(4)],
        ("StoreCheese", True): [episode(0, True)],
    }
    other = robocasa_kitchens.page(found, [], "the other command", "One library.", "A thumb was in the way.")
    row = "| OpenDrawer | 100 % | 100 % | 3 of 4 | 75 | 30-95 | 2 of 4 | 50 | 1 | 9 | 0.0 |"
    assert row in other
    assert "| **the paper's tasks** | - | - | 3 of 4 | 75 | 30-95 | 2 of 4 | 50 | - | - | - |" in other
    assert "| **mean** | 85 % | 65 % | 1 tasks | 75.0 |" in other
    assert "- OpenDrawer, with monitor: 1 replan limit (seeds 0)\n" in other
    assert "A thumb was in the way." in other
    (tmp_path / "results-robocasa.md").write_text(other)
    text = pages.page([], [], [], "the command", 1.0, 5000)
    assert row in text
    assert "thumb" not in text


def test_it_lists_what_there_is_and_refuses_what_there_is_not() -> None:
    listed = subprocess.run([sys.executable, FOLDER / "kitchen.py", "--list"], capture_output=True, text=True, check=True)
    assert "atomic" in listed.stdout
    wrong = subprocess.run([sys.executable, FOLDER / "kitchen.py", "--only", "moon"], capture_output=True, text=True, check=False)
    assert wrong.returncode == 2
    assert "there is no 'moon'" in wrong.stderr
