"""docs/editing.md as a test: export, edit as a person would, check, plan, run. The world is the scripted one of this folder."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from fake_world import OBJECTS, FakeWorld, atoms, make_library

from symskill_pddl.abstraction import abstract
from symskill_pddl.cli import main, work
from symskill_pddl.errors import InputError
from symskill_pddl.evaluation.posed import placed, unlike
from symskill_pddl.execution.executor import execute
from symskill_pddl.execution.outcome import Outcome
from symskill_pddl.planning import Builtin
from symskill_pddl.symbols import Problem

LIBRARY = make_library()
WHOLE = ["reach-closed-door", "open-door", "pick-from-counter", "place-in-cabinet"]


@dataclass(frozen=True)
class Desk:
    """A folder with an export, and what a person does with it."""

    folder: Path
    call: Callable[..., tuple[int, str, str]]

    @property
    def domain(self) -> Path:
        return self.folder / "domain.pddl"

    @property
    def problem(self) -> Path:
        return self.folder / "problem.pddl"

    def edit(self, *changes: tuple[str, str], file: str = "domain.pddl") -> None:
        text = (self.folder / file).read_text()
        for before, after in changes:
            assert before in text, before
            text = text.replace(before, after, 1)
        (self.folder / file).write_text(text)

    def check(self) -> tuple[int, str]:
        status, out, err = self.call("check", self.folder, self.domain, self.problem)
        return status, out + err

    def plan(self) -> list[str]:
        status, out, err = self.call("plan", self.domain, self.problem, "--json")
        assert status == 0, err
        return [step[0] for step in json.loads(out)["steps"]]

    def run(self, world: FakeWorld | None = None) -> Outcome:
        library, written, comparison = work.edit(LIBRARY, self.domain)
        posed = placed(work.posed_problem(self.problem, written, comparison), library.domain(), OBJECTS)
        return execute(
            world or FakeWorld(),
            library,
            library.domain(),
            posed.goal,
            Builtin(),
            objects=posed.object_types,
            rng=np.random.default_rng(0),
        )


def names(outcome: Outcome) -> list[str]:
    return [s.step.strip("()").split()[0] for s in outcome.steps]


@pytest.fixture
def call(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Callable[..., tuple[int, str, str]]:
    monkeypatch.setattr(work, "open_library", lambda _folder: LIBRARY)

    def called(*arguments: object) -> tuple[int, str, str]:
        monkeypatch.setattr(sys, "argv", ["symskill", *map(str, arguments)])
        capsys.readouterr()
        status = 0
        try:
            main()
        except SystemExit as exit_:
            status = int(exit_.code or 0)
        captured = capsys.readouterr()
        return status, captured.out, captured.err

    return called


@pytest.fixture
def desk(tmp_path: Path, call: Callable[..., tuple[int, str, str]]) -> Callable[..., Desk]:
    def export(dialect: str = "strips") -> Desk:
        domain = LIBRARY.domain("learned")
        work.write_all(work.exported_domain(LIBRARY, tmp_path, "learned", dialect, {})[1], force=False)
        init = abstract(FakeWorld().observe(), LIBRARY.classifiers, gripper=LIBRARY.gripper)
        goal = atoms("food-in-cabinet cheese cabinet")
        problem = Problem("cheese", "learned", tuple(OBJECTS.items()), init, goal)
        work.write_all(work.exported_problem(problem, domain, tmp_path / "problem.pddl", dialect, {}, ()), force=False)
        return Desk(tmp_path, call)

    return export


@pytest.mark.parametrize("dialect", ["strips", "negative", "costs", "temporal"])
def test_an_export_that_nobody_touched_runs_as_the_library(desk, dialect):
    mine = desk(dialect)
    assert mine.check()[0] == 0
    library, _, comparison = work.edit(LIBRARY, mine.domain)
    assert comparison.findings == ()
    assert [o.operator for o in library.operators] == [o.operator for o in LIBRARY.operators]
    assert mine.plan() == WHOLE
    assert names(mine.run()) == WHOLE


def test_1_rename_an_action(desk):
    mine = desk()
    mine.edit(("(:action open-door", "(:action swing-the-door"))
    status, said = mine.check()
    assert status == 0
    assert "note: action 'swing-the-door': was 'open-door', known by its effects" in said
    renamed = ["reach-closed-door", "swing-the-door", "pick-from-counter", "place-in-cabinet"]
    assert mine.plan() == renamed
    outcome = mine.run()
    assert outcome.success
    assert names(outcome) == renamed


def test_2_drop_a_precondition(desk):
    """Who says that the door may be shut gets a plan that leaves it shut; and the monitor no longer minds."""
    mine = desk()
    mine.edit(("      (door-open ?door ?cabinet)\n      (gripper-holds-food ?food)", "      (gripper-holds-food ?food)"))
    status, said = mine.check()
    assert status == 0
    assert "warning: action 'place-in-cabinet': no longer needs (door-open ?door ?cabinet)" in said
    assert mine.plan() == ["pick-from-counter", "place-in-cabinet"]
    world = FakeWorld()
    outcome = mine.run(world)
    assert outcome.success
    assert names(outcome) == ["pick-from-counter", "place-in-cabinet"]
    assert world.angle == 0.0


def test_3_add_a_precondition(desk):
    """Open the door before anything is picked up: the condition brings parameters of its own, which the skill need not know."""
    mine = desk()
    mine.edit(
        (
            "(:action pick-from-counter\n    :parameters (?food - food ?counter - counter)\n    :precondition (and\n",
            "(:action pick-from-counter\n    :parameters (?door - door ?food - food ?counter - counter ?cabinet - cabinet)\n"
            "    :precondition (and\n      (door-open ?door ?cabinet)\n",
        )
    )
    status, said = mine.check()
    assert status == 0
    assert "note: action 'pick-from-counter': also needs (door-open ?door ?cabinet)" in said
    assert "the parameter ?door is new, its skill does not know it" in said
    assert mine.plan() == WHOLE
    outcome = mine.run()
    assert outcome.success
    assert outcome.steps[2].step == "(pick-from-counter door cheese counter cabinet)"


def test_4_write_costs(desk):
    """What a step costs is the person's to say; a cost in the text is the cost that the executor plans with."""
    mine = desk("costs")
    mine.edit(("(:action open-door", "; slow: it squeaks\n  (:action open-door"))
    head, _, tail = mine.domain.read_text().partition("(:action open-door")
    mine.domain.write_text(head + "(:action open-door" + tail.replace("(total-cost) 100)", "(total-cost) 950)", 1))
    status, said = mine.check()
    assert status == 0
    assert "note: action 'open-door': its cost was 100, is 950" in said
    library, _, _ = work.edit(LIBRARY, mine.domain)
    assert {o.operator.name: o.operator.cost for o in library.operators}["open-door"] == 9.5
    assert mine.run().success


def test_5_delete_an_action(desk):
    mine = desk()
    text = mine.domain.read_text()
    start = text.index("(:action place-on-counter")
    mine.domain.write_text(text[:start] + text[text.index("(:action", start + 1) :])
    status, said = mine.check()
    assert status == 0
    assert "note: action 'place-on-counter': removed; its skill will not be used" in said
    library, _, _ = work.edit(LIBRARY, mine.domain)
    assert "place-on-counter" not in {o.operator.name for o in library.operators}
    assert names(mine.run()) == WHOLE


def test_5_delete_an_action_that_is_needed(desk):
    mine = desk()
    text = mine.domain.read_text()
    start = text.index("(:action open-door")
    mine.domain.write_text(text[:start].rstrip() + "\n)\n")
    assert mine.check()[0] == 0
    status, _, err = mine.call("plan", mine.domain, mine.problem)
    assert status == 1
    assert "no operator adds 'door-open'" in err
    outcome = mine.run()
    assert not outcome.success
    assert "no operator adds 'door-open'" in outcome.reason


def test_6_types_above_and_below(desk):
    """Dairy may be put away, other foods not; and things that open have a name."""
    mine = desk()
    mine.edit(
        ("    food - object\n", "    food - object\n    dairy - food\n    thing-that-opens - object\n"),
        ("    door - object\n", "    door - thing-that-opens\n"),
        (
            "(:action place-in-cabinet\n    :parameters (?food - food",
            "(:action place-in-cabinet\n    :parameters (?food - dairy",
        ),
    )
    status, said = mine.check()
    assert status == 0
    assert "warning: type 'dairy': added, below 'food'" in said
    assert "note: action 'place-in-cabinet': the parameter ?food was a food, is a dairy" in said
    status, _, err = mine.call("plan", mine.domain, mine.problem)
    assert status == 1  # the problem still calls it a food
    assert "no binding of place-in-cabinet adds it" in err
    mine.edit(("cheese - food", "cheese - dairy"), file="problem.pddl")
    assert mine.plan() == WHOLE
    assert names(mine.run()) == WHOLE


def test_7_reorder_reformat_and_comment(desk):
    mine = desk()
    head, *actions = mine.domain.read_text().rstrip().removesuffix(")").split("(:action ")
    tidied = ["(:action " + " ".join(line.partition(";")[0].strip() for line in a.splitlines()) for a in reversed(actions)]
    types, predicates = head.index("(:types"), head.index("(:predicates")
    head = f"; my own order\n(DEFINE (DOMAIN Learned)\n{head[predicates:]}{head[types:predicates]}"
    mine.domain.write_text("\n".join([head, *tidied, ") ; the end"]).replace("GRIPPER", "gripper").upper())
    status, said = mine.check()
    assert status == 0, said
    assert "as learned, 6 actions, each with its skill" in said
    assert mine.plan() == WHOLE
    assert names(mine.run()) == WHOLE


def test_8_another_goal_and_another_start(desk):
    mine = desk()
    mine.edit(("(food-in-cabinet cheese cabinet-1)", "(door-open door-1 cabinet-1)"), file="problem.pddl")
    mine.edit(("    (gripper-open)\n", "    (gripper-open)\n    (food-in-cabinet cheese cabinet-1)\n"), file="problem.pddl")
    assert mine.check()[0] == 0
    assert mine.plan() == WHOLE[:2]
    outcome = mine.run()
    assert outcome.success
    assert names(outcome) == WHOLE[:2]
    # the robot believes its eyes, and says so
    library, written, comparison = work.edit(LIBRARY, mine.domain)
    posed = placed(work.posed_problem(mine.problem, written, comparison), library.domain(), OBJECTS)
    seen = abstract(FakeWorld().observe(), library.classifiers, gripper=library.gripper)
    assert unlike(posed.init, seen) == ("the problem says, and it is not seen: (food-in-cabinet cheese cabinet)",)


def rename_everywhere(mine, words):
    """As an editor's search and replace would."""
    for before, after in words:
        for file in (mine.domain, mine.problem):
            text = file.read_text().replace(f"({before} ", f"({after} ").replace(f"- {before}", f"- {after}")
            text = text.replace(f"    {before} - object", f"    {after} - object").replace(
                f"(:action {before}\n", f"(:action {after}\n"
            )
            file.write_text(text)


def test_9_rename_predicates_and_types(desk):
    mine = desk()
    rename_everywhere(mine, (("gripper-holds-food", "holding"), ("food", "snack")))
    status, said = mine.check()
    assert status == 0, said
    assert "note: type 'snack': was 'food', known by its uses" in said
    assert "note: predicate 'holding': was 'gripper-holds-food', known by its uses" in said
    assert mine.plan() == WHOLE
    assert names(mine.run()) == WHOLE


def test_9_rename_for_good(desk):
    """A name in names.json binds whatever else the action, the predicate or the type looks like."""
    mine = desk()
    words = (("gripper-holds-food", "holding"), ("food", "snack"), ("pick-from-counter", "grab"))
    for before, after in words:
        mine.edit((f'"{before}": "{before}"', f'"{before}": "{after}"'), file="names.json")
    rename_everywhere(mine, words)
    status, said = mine.check()
    assert status == 0, said
    assert "as learned" in said
    assert mine.plan() == ["reach-closed-door", "open-door", "grab", "place-in-cabinet"]
    # what the person gave a name in names.json, the library still calls by its own
    assert names(mine.run()) == WHOLE


def test_10_two_actions_with_one_skill(desk):
    """The same skill under two names, for two kinds of food."""
    mine = desk("costs")
    text = mine.domain.read_text()
    start = text.index("(:action pick-from-counter")
    action = text[start : text.index("(:action", start + 1)]
    action = action[: action.rindex("))") + 2]
    dear = action.replace("pick-from-counter", "pick-with-care").replace("(total-cost) 100)", "(total-cost) 50)")
    mine.domain.write_text(text.replace(action, f"{action}\n  {dear}"))
    status, said = mine.check()
    assert status == 0, said
    assert "action 'pick-with-care': a second action of the skill of 'pick-from-counter'" in said
    outcome = mine.run()
    assert outcome.success
    assert names(outcome)[2] == "pick-with-care"


REFUSED = {
    "an action that no skill belongs to": (
        ("(:action open-door", "(:action oil-the-hinge :parameters (?door - door) :effect (gripper-open))\n  (:action open-door"),
        "action 'oil-the-hinge': no skill belongs to it; skills there are: open-door, ",
    ),
    "an effect that nobody has shown": (
        ("(door-open ?door ?cabinet)\n      (gripper-open)\n", "(door-open ?door ?cabinet)\n"),
        "action 'open-door': no longer adds (gripper-open), which the demonstrations show",
    ),
    "a condition that nothing sees": (
        ("    (gripper-open)\n", "    (gripper-open)\n    (oiled ?door - door)\n"),
        "action 'open-door' needs 'oiled', which the library has no classifier for, so it cannot be seen; what can be seen: ",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_does_not_run_is_one_line(desk, name):
    mine = desk()
    change, message = REFUSED[name]
    if name.startswith("a condition"):
        mine.edit(
            (
                "    :precondition (and\n      (gripper-holds-door",
                "    :precondition (and (oiled ?door)\n      (gripper-holds-door",
            )
        )
    if name.startswith("an effect"):
        text = mine.domain.read_text()
        start = text.index("(:action open-door")
        mine.domain.write_text(text[:start] + text[start:].replace(*change, 1))
    else:
        mine.edit(change)
    status, _, err = mine.call("run", "library", "--task", "OpenSingleDoor", "--domain", mine.domain)
    assert status == 2
    assert err.count("\n") == 1
    assert f"symskill: error: {mine.domain}: {message}" in err


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("cheese - food", "cheese - food ham - food"), "the scene has no object 'ham'; it has: cabinet, cheese, counter, door"),
        (("cheese - food", "cheese - door"), "needs the type"),
    ],
)
def test_a_problem_that_is_not_of_this_scene(desk, change, message):
    mine = desk()
    mine.edit(change, file="problem.pddl")
    with pytest.raises(InputError, match=message):
        mine.run()


def test_a_problem_needs_its_domain(desk):
    mine = desk()
    status, _, err = mine.call("run", "library", "--task", "OpenSingleDoor", "--problem", mine.problem)
    assert status == 2
    assert "--problem needs --domain" in err
