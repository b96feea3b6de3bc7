import logging
from dataclasses import replace

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from random_domains import atoms, breadth_first, careless_kitchen, covered_egg, domains, kitchen, problems

from symskill_pddl.errors import InputError
from symskill_pddl.planning import Limits, Pyperplan, Status
from symskill_pddl.symbols import Plan, validate


@settings(max_examples=50, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.data())
def test_it_agrees_with_breadth_first_search(data):
    domain = data.draw(domains())  # with negative conditions that no text for pyperplan can say
    problem = data.draw(problems(domain))
    try:
        shortest = breadth_first(domain, problem, 200)
    except OverflowError:
        assume(False)
    result = Pyperplan("astar", "hmax").solve(domain, problem)
    assert result.status is (Status.UNSOLVABLE if shortest is None else Status.SOLVED), result
    if result.plan is not None:
        validate(domain, problem, result.plan)
        assert len(result.plan) == shortest


@pytest.mark.parametrize(("search", "heuristic"), [("astar", "hadd"), ("gbf", "hadd"), ("wastar", "hff"), ("astar", "lmcut")])
def test_the_egg(search, heuristic):
    result = Pyperplan(search, heuristic).solve(kitchen(), covered_egg())
    validate(kitchen(), covered_egg(), result.unwrap())


def test_a_goal_that_holds_needs_no_step():
    assert Pyperplan().solve(kitchen(), replace(covered_egg(), goal=atoms("gripper-open"))).plan == Plan((), 0.0)


def test_names_that_pddl_cannot_take():
    odd = replace(
        covered_egg(),
        objects=tuple((f"My {o}" if o == "egg" else o, t) for o, t in covered_egg().objects),
        init=frozenset(a.substitute({"egg": "My egg"}) for a in covered_egg().init),
        goal=frozenset(a.substitute({"egg": "My egg"}) for a in covered_egg().goal),
    )
    plan = Pyperplan().solve(kitchen(), odd).unwrap()
    validate(kitchen(), odd, plan)
    assert any("My egg" in args for _, args in plan.steps)


def test_what_strips_cannot_say_is_planned_on_ground_steps():
    domain = careless_kitchen(at_most_one=False)
    result = Pyperplan().solve(domain, covered_egg())
    validate(domain, covered_egg(), result.unwrap())
    assert any("ground steps" in message for message in result.messages)
    assert not any("ground steps" in message for message in Pyperplan().solve(kitchen(), covered_egg()).messages)
    # nor can it say it just as it is where it states a condition
    both = replace(covered_egg(), goal=atoms("lid-on-pan lid-a pan-c, lid-on-pan lid-b pan-c"))
    assert Pyperplan().solve(careless_kitchen(at_most_one=True), both).status is Status.SOLVED
    gone = replace(domain, operators=domain.operators[1:])
    assert Pyperplan().solve(gone, replace(covered_egg(), goal=atoms("gripper-holds-lid lid-a"))).status is Status.UNSOLVABLE


def test_an_ill_formed_problem_is_refused():
    with pytest.raises(InputError, match="unknown object 'wok'"):
        Pyperplan().solve(kitchen(), replace(covered_egg(), goal=atoms("food-in-pan egg wok")))


def test_unsolvable():
    both = replace(covered_egg(), goal=atoms("gripper-holds-lid lid-a, gripper-holds-lid lid-b"))
    assert Pyperplan().solve(kitchen(), both).status is Status.UNSOLVABLE


def test_it_says_that_it_ignores_costs():
    result = Pyperplan().solve(kitchen(), covered_egg())
    assert "ignores costs" in result.messages[0]
    same = replace(kitchen(), operators=tuple(replace(o, cost=1.0) for o in kitchen().operators))
    assert Pyperplan().solve(same, covered_egg()).messages == ()


def test_limits():
    crowd = replace(covered_egg(), objects=(*covered_egg().objects, *((f"pan-{i}", "pan") for i in range(30))))
    assert Pyperplan().solve(kitchen(), crowd, Limits(ground_operators=50)).status is Status.FAILED
    result = Pyperplan("astar", "blind").solve(kitchen(), crowd, Limits(time_s=0.3))
    assert result.status is Status.TIMEOUT


def test_unknown_search():
    with pytest.raises(InputError, match="pyperplan has no search 'dfs'; there are: astar, gbf, wastar"):
        Pyperplan("dfs")
    with pytest.raises(InputError, match="pyperplan has no heuristic 'hx'"):
        Pyperplan("astar", "hx")


def test_it_is_quiet_and_writes_no_file(tmp_path, monkeypatch, capfd):
    monkeypatch.chdir(tmp_path)
    root = logging.getLogger()
    before, filters, level = list(root.handlers), list(root.filters), root.level
    root.setLevel(logging.DEBUG)
    try:
        Pyperplan().solve(kitchen(), covered_egg()).unwrap()
    finally:
        root.setLevel(level)
    assert (root.handlers, root.filters) == (before, filters)
    assert list(tmp_path.iterdir()) == []
    assert capfd.readouterr() == ("", "")


def test_same_input_same_plan():
    assert Pyperplan().solve(kitchen(), covered_egg()).plan == Pyperplan().solve(kitchen(), covered_egg()).plan
