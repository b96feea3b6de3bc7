"""Costs from runs: what counts, what it costs, and a case where the plan changes and more runs succeed."""

from dataclasses import replace

import numpy as np
import pytest
from fake_world import COUNTER, DOWN, OBJECTS, FakeWorld, atoms, make_library, phase

from symskill_pddl.abstraction import abstract
from symskill_pddl.errors import InputError
from symskill_pddl.execution.config import ExecutionConfig
from symskill_pddl.execution.executor import execute
from symskill_pddl.execution.experience import experience_of, with_experience
from symskill_pddl.execution.trace import TraceWriter, read_trace
from symskill_pddl.geometry import Pose
from symskill_pddl.library import Experience
from symskill_pddl.pddl import read_domain, write_domain
from symskill_pddl.planning import Builtin
from symskill_pddl.skills import Skill
from symskill_pddl.symbols import Problem

LIBRARY = make_library()
HELD = atoms("gripper-holds-food cheese")
IN_CABINET = atoms("food-in-cabinet cheese cabinet")


def recorded(path, world, library=LIBRARY, goal=IN_CABINET, seed=0, **rest):
    with TraceWriter(path) as writer:
        outcome = execute(
            world,
            library,
            library.domain(),
            goal,
            Builtin(),
            objects=OBJECTS,
            rng=np.random.default_rng(seed),
            trace=writer,
            **rest,
        )
    return outcome, read_trace(path)


def when(world, step, action, delay):
    done = []

    def on_step(index, ground):
        if ground.name == step and not done:
            done.append(index)
            world.after(delay, action)

    return on_step


class TestCounting:
    def test_a_run_in_which_all_goes_well(self, tmp_path):
        outcome, trace = recorded(tmp_path / "t", FakeWorld())
        found = experience_of(trace)
        assert {n: (e.tries, e.successes) for n, e in found.items()} == dict.fromkeys(
            ["open-door", "pick-from-counter", "place-in-cabinet", "reach-closed-door"], (1, 1)
        )
        for record in outcome.steps:
            name = record.step.strip("()").split()[0]
            assert found[name].seconds == pytest.approx(record.stop_s - record.start_s)

    def test_a_grasp_that_slips_is_a_failure_of_the_pick(self, tmp_path):
        world = FakeWorld(angle=1.5)
        world.slippery = 1
        _, trace = recorded(tmp_path / "t", world)
        found = experience_of(trace)
        assert (found["pick-from-counter"].tries, found["pick-from-counter"].successes) == (2, 1)
        assert (found["place-in-cabinet"].tries, found["place-in-cabinet"].successes) == (1, 1)

    def test_a_grasp_that_is_lost_on_the_way_was_no_success_of_the_pick(self, tmp_path):
        world = FakeWorld(angle=1.5)
        _, trace = recorded(tmp_path / "t", world, on_step=when(world, "place-in-cabinet", world.drop, 0.2))
        found = experience_of(trace)
        assert (found["pick-from-counter"].tries, found["pick-from-counter"].successes) == (2, 1)
        assert found["place-in-cabinet"].tries == 1  # only the one that was carried out to its end

    def test_what_others_do_counts_neither_way(self, tmp_path):
        world = FakeWorld(angle=1.5)
        _, trace = recorded(tmp_path / "t", world, on_step=when(world, "place-in-cabinet", world.shut, 0.3))
        found = experience_of(trace)
        assert (found["place-in-cabinet"].tries, found["place-in-cabinet"].successes) == (1, 1)

    def test_a_run_without_monitor_says_nothing(self, tmp_path):
        _, trace = recorded(tmp_path / "t", FakeWorld(angle=1.5), monitor=False)
        with pytest.raises(InputError, match="without monitor"):
            experience_of(trace)


class TestCosts:
    def costs(self, library):
        return {o.operator.name: o.operator.cost for o in library.operators}

    def test_the_rule_of_succession(self):
        assert Experience().success == 0.5
        assert Experience(1, 1).success == pytest.approx(2 / 3)
        assert Experience(8, 0).success == pytest.approx(0.1)
        assert Experience(2, 1, 3.0) + Experience(1, 1, 4.5) == Experience(3, 2, 7.5)

    def test_time_until_it_has_worked(self):
        found = with_experience(LIBRARY, {"open-door": Experience(3, 3, 15.0), "pick-from-counter": Experience(4, 0)}, ["a"])
        costs = self.costs(found)
        assert costs["open-door"] == 6.2  # 5 s each, works with 4/5
        assert costs["pick-from-counter"] == 24.0  # 4 s in the demonstrations, works with 1/6
        assert costs["place-on-counter"] == 8.0  # never tried: a coin toss
        assert found.runs == ("a",)

    def test_runs_add_up_and_none_counts_twice(self):
        run = {"open-door": Experience(1, 1, 5.0)}
        once = with_experience(LIBRARY, run, ["a"])
        twice = with_experience(once, run, ["b"])
        assert twice.learned("open-door").experience == Experience(2, 2, 10.0)
        assert twice.runs == ("a", "b")
        with pytest.raises(InputError, match="the run a is counted in the library already"):
            with_experience(twice, run, ["a"])

    def test_without_runs_nothing_changes(self):
        assert with_experience(LIBRARY, {}) is LIBRARY


def two_ways():
    """The food may also be snatched: that is quicker, but the hand closes beside the middle."""
    library = make_library()
    pick = library.learned("pick-from-counter")
    beside = Pose(np.array([0.025, 0.0, 0.0]), DOWN)
    snatch = replace(
        pick,
        operator=replace(pick.operator, name="snatch-from-counter", cost=2.0),
        skill="snatch",
        duration_s=(2.0, 3.0),
    )
    operators = tuple(replace(o, operator=replace(o.operator, cost=4.0)) for o in library.operators)
    wide = [c if c.predicate.name != "gripper-holds-food" else replace(c, cov_p=c.cov_p * 4.0) for c in library.classifiers]
    return replace(
        library,
        classifiers=tuple(wide),
        operators=(*operators, snatch),
        skills={**library.skills, "snatch": Skill((phase("?food", beside, False, 0.8),), True)},
    )


class Slick(FakeWorld):
    """What is not taken in its middle slips away three times out of four."""

    def __init__(self, seed):
        rng = np.random.default_rng(seed)
        super().__init__(angle=1.5, cheese=Pose(COUNTER + np.array([rng.uniform(-0.03, 0.03), 0.0, 0.03]), [1.0, 0, 0, 0]))
        self.slips = rng.random() < 0.75

    def _fingers(self, close):
        if close and not self.closed:
            self.slippery = int(self.slips and np.linalg.norm((self.ee.p - self.cheese.p)[:2]) > 0.015)
        super()._fingers(close)


def succeed(library, folder, seeds):
    """How many of the first plans bring the cheese into the cabinet, and how those begin."""
    good, first = 0, set()
    for seed in seeds:
        outcome, trace = recorded(folder / "t", Slick(seed), library, seed=seed, config=ExecutionConfig(max_replans=0))
        good += outcome.success
        first |= {trace.of("plan")[0].steps[0][0]}
    return good, first


def test_the_plan_changes_and_more_runs_succeed(tmp_path):
    """Runs that may plan again try both ways; what they saw makes the first plan of later runs the reliable one."""
    library, learned = two_ways(), two_ways()
    assert succeed(library, tmp_path, range(10)) == (4, {"snatch-from-counter"})
    for seed in range(10, 16):
        outcome, trace = recorded(tmp_path / "t", Slick(seed), library, seed=seed)
        assert outcome.success
        learned = with_experience(learned, experience_of(trace), [str(seed)])
    snatch, pick = (learned.learned(f"{way}-from-counter") for way in ("snatch", "pick"))
    assert snatch.operator.cost > pick.operator.cost
    assert pick.experience.successes == pick.experience.tries > 0
    assert succeed(learned, tmp_path, range(10)) == (10, {"pick-from-counter"})


def test_the_costs_dialect_carries_what_was_learned():
    library = with_experience(two_ways(), {"snatch-from-counter": Experience(6, 0)}, ["a"])
    domain = library.domain()
    text = write_domain(domain, dialect="costs")
    start = FakeWorld(angle=1.5)
    init = abstract(start.observe(), library.classifiers, gripper=library.gripper)
    problem = Problem("p", domain.name, tuple(OBJECTS.items()), init, IN_CABINET)
    assert Builtin().solve(read_domain(text), problem).unwrap().steps[0][0] == "pick-from-counter"
    assert Builtin().solve(two_ways().domain(), problem).unwrap().steps[0][0] == "snatch-from-counter"
