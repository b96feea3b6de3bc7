"""The registry, explanations, import hygiene, and the time a call takes."""

import subprocess
import sys
from dataclasses import replace

import pytest
from random_domains import atoms, covered_egg, kitchen

from symskill_pddl.errors import InputError
from symskill_pddl.pddl import read_domain, write_domain, write_problem
from symskill_pddl.planning import Builtin, Pyperplan, Status, explain, get, nearest_goal, planners, why_not

PLAN_SCRIPT = """
import sys
from random_domains import covered_egg, kitchen
import symskill_pddl.symbols, symskill_pddl.pddl, symskill_pddl.planning
for name in ("builtin", "pyperplan"):
    plan = symskill_pddl.planning.get(name).solve(kitchen(), covered_egg()).unwrap()
    print(name, plan.steps)
print("heavy:", sorted({"numpy", "scipy", "unified_planning"} & set(sys.modules)))
"""


def run_script(hash_seed):
    folder = __file__.rsplit("/", 2)[0]
    path = ":".join([folder, folder.rsplit("/", 1)[0]])
    done = subprocess.run(
        [sys.executable, "-c", PLAN_SCRIPT],
        env={"PYTHONPATH": path, "PYTHONHASHSEED": str(hash_seed)},
        capture_output=True,
        text=True,
        check=True,
    )
    return done.stdout


def test_no_numpy_and_no_hash_order():
    first, second = run_script(1), run_script(2)
    assert first.endswith("heavy: []\n")
    assert first == second


def test_the_registry():
    names = [p.name for p in planners()]
    assert names[:4] == ["auto", "builtin", "builtin-optimal", "pyperplan"]
    assert set(names[4:]) <= {"kairos", "mimir", "fast-downward", "lpg"}
    assert get().name == "auto"
    assert get("builtin-optimal") == Builtin(optimal=True, name="builtin-optimal")
    assert get("pyperplan") == Pyperplan()
    assert get("pyperplan:gbf:hff") == Pyperplan("gbf", "hff")
    assert get("pyperplan:gbf:hff").name == "pyperplan:gbf:hff"
    for planner in planners():
        assert planner.version
        assert planner.licence
        assert {"strips", "negative"} & set(planner.dialects)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("fd", "unknown planner 'fd'; there are: auto, builtin, builtin-optimal, .*pyperplan; families: "),
        ("unified-planning:", "unknown planner"),
        ("pyperplan:dfs", "no search 'dfs'"),
    ],
)
def test_an_unknown_planner_lists_those_there_are(name, message):
    with pytest.raises(InputError, match=message):
        get(name)


def test_an_explanation_follows_the_missing_conditions():
    closed = replace(kitchen(), operators=tuple(o for o in kitchen().operators if o.name != "pick-lid"))
    problem = replace(covered_egg(), goal=atoms("lid-on-pan lid-a pan-c, gripper-open"))
    assert explain(closed, problem) == (
        "goal (lid-on-pan lid-a pan-c): (place-lid lid-a pan-c) would add it, "
        "but needs (gripper-holds-lid lid-a), which cannot be reached",
        "needed (gripper-holds-lid lid-a): no operator adds 'gripper-holds-lid', and it does not hold at the start",
    )
    assert nearest_goal(closed, problem) == atoms("gripper-open")


def test_an_explanation_without_objects():
    bare = replace(covered_egg(), objects=(("egg", "food"),), init=atoms("gripper-open"), goal=atoms("gripper-holds-food egg"))
    (line,) = explain(kitchen(), bare)
    assert "no binding of pick-food adds it" in line


def test_what_the_relaxation_reaches_is_not_blamed():
    assert explain(kitchen(), covered_egg()) == ()
    assert nearest_goal(kitchen(), covered_egg()) == covered_egg().goal


def test_goals_that_exclude_one_another():
    both = replace(covered_egg(), goal=atoms("gripper-holds-lid lid-a, gripper-holds-lid lid-b, food-in-pan egg pan-a"))
    lines = why_not(kitchen(), both)
    assert "(gripper-holds-lid lid-b) and (gripper-holds-lid lid-a) cannot hold together" in lines[0]
    assert lines[-1].startswith("the nearest goal that can be reached: (food-in-pan egg pan-a) (gripper-holds-lid lid-")


def test_many_goal_atoms_are_built_up():
    pans = [f"pan-{i}" for i in range(10)]
    problem = replace(
        covered_egg(),
        objects=(("egg", "food"), *((p, "pan") for p in pans)),
        init=atoms("gripper-open, food-in-pan egg pan-0"),
        goal=frozenset(a for p in pans for a in atoms(f"food-in-pan egg {p}")),
    )
    assert len(nearest_goal(kitchen(), problem)) == 1


@pytest.mark.parametrize("dialect", ["strips", "negative", "costs"])
def test_unified_planning_reads_what_we_write_and_finds_our_plan_valid(dialect):
    """An independent reader and validator: the text means what the symbols mean."""
    shortcuts = pytest.importorskip("unified_planning.shortcuts")
    from unified_planning.io import PDDLReader

    read = read_domain(write_domain(kitchen(), dialect=dialect))
    text, task = write_domain(kitchen(), dialect=dialect), write_problem(covered_egg(), kitchen(), dialect=dialect)
    problem = PDDLReader().parse_problem_string(text, task)
    plan = Builtin().solve(kitchen(), covered_egg()).unwrap()
    steps = "\n".join("(" + " ".join((name, *args)) + ")" for name, args in plan.steps)
    theirs = PDDLReader().parse_plan_string(problem, steps)
    with shortcuts.PlanValidator(name="sequential_plan_validator") as validator:
        assert str(validator.validate(problem, theirs).status).endswith("VALID")
        assert not validator.validate(problem, PDDLReader().parse_plan_string(problem, steps.split("\n", 1)[1]))
    assert len(problem.actions) == len(read.operators)


def test_unified_planning_reads_the_temporal_dialect():
    pytest.importorskip("unified_planning.shortcuts")
    from unified_planning.io import PDDLReader

    problem = PDDLReader().parse_problem_string(
        write_domain(kitchen(), dialect="temporal"), write_problem(covered_egg(), kitchen(), dialect="temporal")
    )
    assert len(problem.actions) == 4


def test_an_engine_that_is_not_installed():
    pytest.importorskip("unified_planning.shortcuts")
    with pytest.raises(InputError, match="no engine 'warp-drive' installed"):
        get("unified-planning:warp-drive")
    assert Status.FAILED.value == "failed"
