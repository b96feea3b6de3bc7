"""The engines of the extra `[planners]`, alike: statuses kept apart, plans checked, nothing left behind."""

import random
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from random_domains import atoms, breadth_first, careless_kitchen, covered_egg, domains, kitchen, problems

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.planning import LPG, FastDownward, Kairos, Limits, Mimir, Status, get, session
from symskill_pddl.planning.protocol import PlanResult
from symskill_pddl.planning.text import Answer, Text, TextSession
from symskill_pddl.symbols import Plan, Problem, validate

from .processes import running

ENGINES = (Kairos(), Mimir(), Mimir(mode="grounded"), FastDownward(), LPG())


def here(engine):
    if not engine.installed():
        pytest.skip(f"{engine.package} is not installed; pip install 'symskill-pddl[planners]'")
    return engine


@pytest.fixture(params=ENGINES, ids=lambda e: f"{e.name}-{getattr(e, 'mode', '')}".rstrip("-"))
def engine(request):
    return here(request.param)


def crowded(n):
    """A problem that no engine solves in a few milliseconds: everything in the wrong, covered pan."""
    pans, lids, foods = ([f"{kind}-{i}" for i in range(n)] for kind in ("pan", "lid", "food"))
    objects = (*((o, "pan") for o in pans), *((o, "lid") for o in lids), *((o, "food") for o in foods), ("spare", "pan"))
    init = "gripper-open, " + ", ".join(
        f"lid-on-pan {lid} {pan}, food-in-pan {f} {pan}" for lid, pan, f in zip(lids, pans, foods, strict=True)
    )
    goal = ", ".join(
        f"lid-on-pan {lid} {pan}, food-in-pan {f} {pan}" for lid, pan, f in zip(lids[1:], pans, foods[2:], strict=False)
    )
    return Problem("crowded", "kitchen", objects, atoms(init), atoms(goal))


def test_a_plan_is_valid_and_knows_its_cost(engine):
    result = engine.solve(kitchen(), covered_egg())
    plan = result.unwrap()
    validate(kitchen(), covered_egg(), plan)
    assert plan.cost == sum(s.cost for s in plan.ground(kitchen(), covered_egg().object_types))
    assert result.planner == engine.name


def test_an_unsolvable_goal_is_called_unsolvable(engine):
    both = replace(covered_egg(), goal=atoms("gripper-holds-lid lid-a, gripper-holds-lid lid-b"))
    result = engine.solve(kitchen(), both)
    assert result.status is Status.UNSOLVABLE
    assert result.messages


def test_a_goal_that_holds_is_an_empty_plan(engine):
    result = engine.solve(kitchen(), replace(covered_egg(), goal=atoms("gripper-open")))
    assert result.plan == Plan()
    assert result.messages[0] == "the goal holds already"


def test_time_that_runs_out_is_called_so(engine):
    result = engine.solve(kitchen(), crowded(12), Limits(time_s=0.005))
    assert result.status is Status.TIMEOUT
    assert "0.005 s" in result.messages[0]


def test_an_ill_formed_problem_is_refused(engine):
    with pytest.raises(InputError, match="unknown object 'ghost'"):
        engine.solve(kitchen(), replace(covered_egg(), goal=atoms("food-in-pan ghost pan-a")))


def test_names_that_no_planner_takes(engine):
    """Identifiers are not PDDL names; the engine sees other ones, and the plan comes back in ours."""
    spelled = {name: f"3 {name.upper()}!" for name, _ in covered_egg().objects}
    egg = covered_egg()

    def rename(state):
        return frozenset(replace(a, args=tuple(spelled[x] for x in a.args)) for a in state)

    strange = replace(egg, objects=tuple((spelled[o], t) for o, t in egg.objects), init=rename(egg.init), goal=rename(egg.goal))
    validate(kitchen(), strange, engine.solve(kitchen(), strange).unwrap())


def test_a_session_replans_from_every_state_of_a_plan(engine):
    problem = covered_egg()
    warm = session(engine, kitchen(), problem.objects)
    state, goal = problem.init, problem.goal
    for step in engine.solve(kitchen(), problem).unwrap().ground(kitchen(), problem.object_types):
        validate(kitchen(), replace(problem, init=state), warm.solve(state, goal).unwrap())
        state = step.apply(state)
    assert warm.solve(state, goal).plan == Plan()


def test_a_session_meets_another_goal_and_another_world(engine):
    problem = covered_egg()
    warm = session(engine, kitchen(), problem.objects)
    warm.solve(problem.init, problem.goal)
    held = atoms("gripper-holds-food egg")  # no lid anywhere, which no step from the first state leads to
    for init, goal in ((held, problem.goal - atoms("lid-on-pan lid-a pan-a")), (problem.init, atoms("gripper-holds-lid lid-a"))):
        goal = frozenset(a for a in goal if a.predicate != "lid-on-pan")
        validate(kitchen(), replace(problem, init=init, goal=goal), warm.solve(init, goal).unwrap())


@given(st.data())
@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
def test_engines_and_the_semantics_agree(engine, data):
    """What has a plan by breadth-first search is solved; and what has none is never solved; from one session, for two states."""
    if isinstance(engine, LPG):  # breaks on degenerate operators; see the next test
        return
    domain = data.draw(domains())
    problem = data.draw(problems(domain))
    other = data.draw(problems(domain))
    assume({a for atom in other.init for a in atom.args} <= {o for o, _ in problem.objects})
    warm = session(engine, domain, problem.objects)
    for init in (problem.init, other.init):
        asked = replace(problem, init=init)
        try:
            length = breadth_first(domain, asked)
            result = warm.solve(init, problem.goal, Limits(time_s=600.0))
        except (OverflowError, InputError):
            continue
        assert result.status is (Status.UNSOLVABLE if length is None else Status.SOLVED)
        if result.plan is not None:
            validate(domain, asked, result.plan)


@given(st.data())
@settings(max_examples=5, deadline=None)
def test_lpg_is_never_wrong(data):
    domain = data.draw(domains())
    problem = data.draw(problems(domain))
    try:
        length = breadth_first(domain, problem)
    except OverflowError:
        return
    status = here(LPG()).solve(domain, problem, Limits(time_s=1.0)).status
    assert status in ({Status.UNSOLVABLE} if length is None else {Status.SOLVED}) | {Status.FAILED, Status.TIMEOUT}


@pytest.mark.parametrize("dialect", ["negative", "costs", "strips", "temporal"])
def test_kairos_reads_every_dialect(dialect):
    validate(kitchen(), covered_egg(), here(get_or_skip(f"kairos:{dialect}")).solve(kitchen(), covered_egg()).unwrap())


def get_or_skip(name):
    try:
        return get(name)
    except MissingDependencyError as error:
        pytest.skip(str(error))


def test_optimal_search_of_fast_downward():
    engine = get_or_skip("fast-downward:strips:optimal")
    assert engine.name == "fast-downward:strips:optimal"
    assert len(engine.solve(kitchen(), covered_egg()).unwrap()) == 8


def test_quantified_conditions_that_the_optimal_search_refuses():
    result = get_or_skip("fast-downward:optimal").solve(kitchen(), covered_egg())
    assert result.status is Status.FAILED
    assert "quantified conditions" in result.messages[0]


def test_mimir_prints_nothing(capfd):
    here(Mimir()).solve(kitchen(), covered_egg())
    assert capfd.readouterr().out == ""


def test_mimir_gives_up_after_so_many_states():
    result = here(Mimir(max_states=3)).solve(kitchen(), crowded(5))
    assert result.status is Status.FAILED
    assert "out_of_states" in result.messages[0]


@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="needs /proc to look for processes")
@pytest.mark.parametrize("engine", [FastDownward(), FastDownward("strips", optimal=True), LPG()], ids=lambda e: e.name)
def test_no_process_is_left_after_twenty_time_outs(engine, monkeypatch, tmp_path):
    here(engine)
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    mark = f"SYMSKILL_TEST_{random.getrandbits(64):x}"
    monkeypatch.setenv(mark, "1")
    for i in range(20):
        limits = Limits(time_s=0.01 + 0.015 * i)  # ends the translator as well as the search
        assert engine.solve(kitchen(), crowded(25), limits).status is Status.TIMEOUT
    for _ in range(20):
        if not (left := running(mark)):
            break
        time.sleep(0.05)
    assert not left
    assert not list(tmp_path.iterdir())


def answering(answer, domain=None, dialect="negative"):
    egg = covered_egg()
    text = Text(domain or kitchen(), egg.objects, dialect)
    return TextSession("liar", text, lambda _problem, _limits: answer, shorten=False)(egg.init, egg.goal, Limits())


@pytest.mark.parametrize(
    ("plan", "message"),
    [
        ("(fly egg)", "unknown operator 'fly'"),
        ("(pick-food egg pan-a)", "plan step 1"),
        (Plan((("pick-lid", ("lid-a", "pan-a")),)), "ends without the goal"),
        ("", "ends without the goal"),
    ],
)
def test_a_wrong_plan_is_not_believed(plan, message):
    result = answering(Answer(Status.SOLVED, plan))
    assert result.status is Status.FAILED
    assert message in result.messages[0]
    assert result.messages[0].startswith("what liar gives is not a plan")


@pytest.mark.parametrize("status", [Status.UNSOLVABLE, Status.TIMEOUT, Status.FAILED])
def test_other_answers_pass(status):
    result = answering(Answer(status, messages=("why",)))
    assert isinstance(result, PlanResult)
    assert result.status is status
    assert "why" in result.messages


@pytest.mark.parametrize("dialect", ["strips", "negative"])
def test_no_plan_for_a_text_that_needs_more_proves_nothing(dialect):
    result = answering(Answer(Status.UNSOLVABLE), careless_kitchen(at_most_one=True), dialect)
    assert result.status is (Status.FAILED if dialect == "strips" else Status.UNSOLVABLE)


def test_an_engine_that_is_not_installed(monkeypatch):
    for family in (Kairos, Mimir, FastDownward, LPG):
        monkeypatch.setattr(family, "module", "no_such_module")
        with pytest.raises(MissingDependencyError, match=r"symskill-pddl\[planners\]"):
            get(family.family)


def test_a_dialect_that_an_engine_does_not_read():
    with pytest.raises(InputError, match="'mimir' does not read the dialect 'temporal'; it reads: negative"):
        Mimir("temporal")
