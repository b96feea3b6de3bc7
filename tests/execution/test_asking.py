import time
from dataclasses import replace
from itertools import count

import numpy as np
import pytest
from fake_world import OBJECTS, FakeWorld, atoms, make_library

from symskill_pddl.errors import InputError
from symskill_pddl.execution import asking
from symskill_pddl.execution.asking import BrokenPlannerError, ask
from symskill_pddl.execution.executor import execute
from symskill_pddl.execution.outcome import Category
from symskill_pddl.execution.trace import TraceWriter, read_trace
from symskill_pddl.planning import Builtin, Limits, PlanResult, Status
from symskill_pddl.symbols import Plan

LIBRARY = make_library()
IN_CABINET = atoms("food-in-cabinet cheese cabinet")
hanging = False


@pytest.fixture(autouse=True)
def clock(monkeypatch):
    """Time passes for who asks only while a planner hangs, then quickly: what comes of a run does not depend on the machine."""
    seconds = count(0.0, 1.0)
    monkeypatch.setattr(asking, "monotonic", lambda: next(seconds) if hanging else 0.0)
    monkeypatch.setitem(globals(), "hanging", False)


class Recording(FakeWorld):
    def __init__(self, **more):
        super().__init__(**more)
        self.commands = []

    def step(self, command):
        self.commands.append(command)
        return super().step(command)


class Live(Recording):
    live = True


class Fake:
    """Plans well at first; after `good` calls it does something else."""

    name, version, licence, dialects = "fake", "0", "none", ()

    def __init__(self, instead, good=0):
        self.instead, self.good = instead, good

    def solve(self, domain, problem, limits=Limits(), extra_costs=None):
        self.good -= 1
        return Builtin().solve(domain, problem, limits, extra_costs or {}) if self.good >= 0 else self.instead()


def crash():
    raise ZeroDivisionError("division by zero")


def hang():
    global hanging
    hanging = True
    time.sleep(3600)


def plan_of(*steps):
    return lambda: PlanResult(Status.SOLVED, Plan(tuple(steps), 0.0))


BROKEN = {
    "crash": (crash, "the planner crashed: ZeroDivisionError: division by zero"),
    "hang": (hang, "the planner hangs: no answer 15.5 s after it was given 10 s"),
    "late": (lambda: PlanResult(Status.TIMEOUT, messages=("the time limit of 0.1 s passed",)), "the time limit of 0.1 s passed"),
    "nothing": (lambda: None, "answers with a NoneType in place of a result"),
    "unknown step": (plan_of(("fly", ("cheese",))), "not a plan: plan step 1: unknown operator 'fly'"),
    "wrong object": (plan_of(("pick-from-counter", ("moon", "counter"))), "not a plan: plan step 1"),
    "cannot start": (plan_of(("place-in-cabinet", ("cheese", "cabinet", "door"))), "which does not hold there"),
    "too short": (plan_of(("reach-closed-door", ("door", "cabinet"))), "the plan ends without the goal"),
}


def run(world, planner, config=None, **more):
    return execute(
        world, LIBRARY, LIBRARY.domain(), IN_CABINET, planner, config, objects=OBJECTS, rng=np.random.default_rng(0), **more
    )


@pytest.mark.parametrize("case", BROKEN)
def test_a_broken_planner_leaves_the_robot_stopped_with_a_reason(case, tmp_path):
    instead, message = BROKEN[case]
    world = Recording()
    with TraceWriter(tmp_path / "trace.jsonl") as trace:
        outcome = run(world, Fake(instead), trace=trace)
    assert outcome.category is Category.PLANNER
    assert message in outcome.reason
    assert not any(np.any(c.twist) for c in world.commands)
    trace = read_trace(tmp_path / "trace.jsonl")
    assert message in " ".join(trace.of("plan")[-1].messages)
    assert trace.outcome.category == "planner failed"


@pytest.mark.parametrize("case", ["crash", "hang"])
def test_the_robot_stops_also_in_the_middle(case):
    world = Recording(angle=1.5)
    done = []

    def drop(index, step):
        if step.name == "place-in-cabinet" and not done:
            done.append(index)
            world.after(0.3, world.drop)

    outcome = run(world, Fake(BROKEN[case][0], good=1), on_step=drop)
    assert outcome.category is Category.PLANNER
    assert any(np.any(c.twist) for c in world.commands)
    assert not np.any(world.commands[-1].twist)


def test_the_last_command_of_a_run_is_to_stay():
    world = Recording()
    assert run(world, Builtin()).success
    assert not np.any(world.commands[-1].twist)


def test_a_robot_that_breaks_down_is_told_to_stay():
    class Breaking(Recording):
        def step(self, command):
            scene = super().step(command)
            if len(self.commands) == 20:
                raise RuntimeError("lost the connection")
            return scene

    world = Breaking()
    outcome = run(world, Builtin())
    assert outcome.category is Category.WORLD
    assert "lost the connection" in outcome.reason
    assert np.any(world.commands[18].twist)
    assert not np.any(world.commands[-1].twist)


def test_a_live_world_is_told_to_stay_while_the_planner_thinks():
    still, waiting = Live(), Recording()

    def slow(enough):
        while not enough():
            time.sleep(0.01)
        return PlanResult(Status.TIMEOUT)

    run(still, Fake(lambda: slow(lambda: len(still.commands) >= 3)))
    run(waiting, Fake(lambda: slow(lambda: True)))
    assert len(still.commands) >= 3
    assert not any(np.any(c.twist) for c in still.commands)
    assert waiting.commands == []


def test_what_the_planner_says_of_bad_input_is_passed_on():
    def refuse():
        raise InputError("no such dialect")

    with pytest.raises(InputError, match="no such dialect"):
        run(Recording(), Fake(refuse))


def test_an_explanation_does_not_ask_it_again():
    class Fickle(Fake):
        def solve(self, domain, problem, limits=Limits(), extra_costs=None):
            return PlanResult(Status.UNSOLVABLE) if len(problem.goal) > 1 else crash()

    library = replace(LIBRARY, operators=tuple(o for o in LIBRARY.operators if o.operator.name != "place-on-counter"))
    goal = atoms("food-in-cabinet cheese cabinet", "food-on-counter cheese counter")
    outcome = execute(FakeWorld(), library, library.domain(), goal, Fickle(crash), objects=OBJECTS, rng=np.random.default_rng(0))
    assert outcome.category is Category.UNREACHABLE
    assert "a part that can be reached: (food-in-cabinet cheese cabinet)" in outcome.reason


def test_asking():
    domain, problem = LIBRARY.domain(), None
    found = PlanResult(Status.UNSOLVABLE)
    assert ask(lambda: found, domain, problem, limit_s=1.0) is found
    waited = []
    with pytest.raises(BrokenPlannerError, match=r"hangs: no answer 5\.0 s after it was given 3 s"):
        ask(hang, domain, problem, limit_s=3.0, wait=lambda: waited.append(1), period_s=0.01)
    assert len(waited) >= 3
