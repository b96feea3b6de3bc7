"""Programs as planners, played by small scripts."""

import os
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from random_domains import atoms, careless_kitchen, covered_egg, kitchen

from symskill_pddl.errors import InputError
from symskill_pddl.pddl import write_plan
from symskill_pddl.planning import Builtin, Command, Limits, Status, get
from symskill_pddl.symbols import Plan, validate

from .processes import running

GOOD = write_plan(Builtin().solve(kitchen(), covered_egg()).unwrap())


def program(tmp_path, code, fields="{domain} {problem}"):
    script = tmp_path / "planner.py"
    script.write_text(f"import sys, os, time\ndomain, problem, *rest = sys.argv[1:]\nplan = {GOOD!r}\n{code}\n")
    return Command(f"{sys.executable} {script} {fields}")


def test_a_plan_that_is_printed_among_other_things(tmp_path):
    code = "print('Parsing', domain); print('(not a step)'); print(plan.upper().replace('; COST', '; cost')); print('Done (ok)')"
    result = program(tmp_path, code).solve(kitchen(), covered_egg())
    validate(kitchen(), covered_egg(), result.unwrap())
    assert result.plan.cost == 18.75


def test_a_plan_in_a_file(tmp_path):
    result = program(tmp_path, "open(rest[0], 'w').write(plan)", "{domain} {problem} {plan}").solve(kitchen(), covered_egg())
    assert len(result.unwrap()) == 8


def test_the_program_reads_what_we_wrote(tmp_path):
    code = "assert 'define (domain kitchen)' in open(domain).read() and ':goal' in open(problem).read(); print(plan)"
    assert program(tmp_path, code).solve(kitchen(), covered_egg()).status is Status.SOLVED


def test_a_wrong_plan_is_not_believed(tmp_path):
    result = program(tmp_path, "print(plan.split('\\n', 1)[1])").solve(kitchen(), covered_egg())
    assert result.status is Status.FAILED
    assert "is not a plan: plan step 1" in result.messages[0]


@pytest.mark.parametrize(
    ("code", "status", "message"),
    [
        ("print('no solution'); sys.exit(1)", Status.FAILED, "ended with status 1 and no plan; it said last: no solution"),
        ("print('Problem proven unsolvable.')", Status.UNSOLVABLE, "says 'unsolvable'"),
        ("os.abort()", Status.FAILED, "ended with status -6"),
        ("x = bytearray(400_000_000)", Status.FAILED, "MemoryError"),
    ],
)
def test_other_ends_are_kept_apart(tmp_path, code, status, message):
    result = program(tmp_path, code).solve(kitchen(), covered_egg(), Limits(memory_mb=300))
    assert result.status is status
    assert message in result.messages[0]


@pytest.mark.parametrize("dialect", ["strips", "negative"])
def test_no_plan_for_a_text_that_needs_more_proves_nothing(tmp_path, dialect):
    planner = replace(program(tmp_path, "print('Problem proven unsolvable.')"), dialect=dialect)
    result = planner.solve(careless_kitchen(at_most_one=True), covered_egg())
    assert result.status is (Status.FAILED if dialect == "strips" else Status.UNSOLVABLE)
    assert any("'place-lid' needs (none-lid-on-pan ?pan) too" in m for m in result.messages) == (dialect == "strips")
    assert planner.solve(kitchen(), covered_egg()).status is Status.UNSOLVABLE


@pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="needs /proc to look for processes")
def test_no_process_is_left_after_many_time_outs(tmp_path, monkeypatch):
    """A planner with a child of its own, both of which would sleep for a minute."""
    mark = f"SYMSKILL_TEST_{os.getpid()}"
    monkeypatch.setenv(mark, "1")
    script = tmp_path / "planner.sh"
    script.write_text("sleep 60 &\nsleep 60\n")
    planner = Command(f"sh {script} {{domain}} {{problem}}")
    for _ in range(30):
        assert planner.solve(kitchen(), covered_egg(), Limits(time_s=0.01)).status is Status.TIMEOUT
    for _ in range(40):
        if not (left := running(mark)):
            break
        time.sleep(0.05)
    assert not left


def test_a_goal_that_holds_needs_no_output(tmp_path):
    result = program(tmp_path, "").solve(kitchen(), replace(covered_egg(), goal=atoms("gripper-open")))
    assert result.plan == Plan()


def test_a_program_that_does_not_heed_what_is_forbidden_is_asked_without(tmp_path):
    result = program(tmp_path, "print(plan)").solve(kitchen(), covered_egg(), Limits(), {("pick-lid", ("lid-a", "pan-a")): 1.0})
    assert result.status is Status.SOLVED
    assert result.messages[-1].startswith("no plan without the steps that failed before (failed)")


@pytest.mark.parametrize(
    ("template", "message"),
    [
        ("popf", r"needs \{domain\} and \{problem\}"),
        ("popf {domain} {problem} {colour}", r"unknown field '\{colour\}'; there are: domain, plan, problem"),
        ("popf '{domain} {problem}", "cannot be split"),
    ],
)
def test_bad_templates(template, message):
    with pytest.raises(InputError, match=message):
        Command(template)


def test_a_program_that_is_not_there():
    with pytest.raises(InputError, match="cannot run the planner 'no-such-planner': No such file"):
        Command("no-such-planner {domain} {problem}").solve(kitchen(), covered_egg())


def test_a_shell_is_not_used(tmp_path):
    result = Command(f"echo {{domain}} {{problem}} ; touch {tmp_path}/pwned").solve(kitchen(), covered_egg())
    assert result.status is Status.FAILED
    assert list(tmp_path.iterdir()) == []


def test_by_name():
    assert get("command:popf {domain} {problem}") == Command("popf {domain} {problem}")
    assert get("command:popf {domain} {problem}").dialects == ("negative",)


def test_memory_limit_is_positive():
    with pytest.raises(InputError, match="needs memory"):
        Limits(memory_mb=0)
