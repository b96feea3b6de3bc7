"""`symskill replay` on a trace made by hand: a step that comes about, and one whose protected atom falls."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from symskill_pddl.execution.lines import Header, OutcomeLine, PlanLine, RecoveryLine, step_line, tick_line
from symskill_pddl.execution.monitor import Memory, Tick, Watch, check_start, judge
from symskill_pddl.execution.trace import TraceWriter
from symskill_pddl.symbols import Atom, GroundOperator, State


def atoms(*texts: str) -> State:
    return frozenset(Atom(words[0], tuple(words[1:])) for words in map(str.split, texts))


OPEN, THERE, HELD, DOOR = "gripper-open", "on cheese counter", "holds cheese", "door-open"
PICK = GroundOperator("pick", ("cheese",), atoms(OPEN, THERE), atoms(HELD), atoms(OPEN, THERE))
PLACE = GroundOperator("place", ("cheese",), atoms(HELD, DOOR), atoms(OPEN), atoms(HELD), maintain=atoms(HELD, DOOR))
START = atoms(OPEN, THERE, DOOR)
RUNS = (
    (PICK, (START, START, atoms(THERE, DOOR, HELD), atoms(THERE, DOOR, HELD))),
    (PLACE, (atoms(DOOR, HELD), atoms(DOOR, HELD), atoms(HELD))),
)


def watch_of(step: GroundOperator, index: int, start: float, state: State) -> Watch:
    later = (PLACE,) if step is PICK else ()
    return Watch(
        step=step,
        index=index,
        later=later,
        gripper=frozenset({"holds"}),
        start_s=start,
        start_state=state,
        inherited=frozenset(),
        assumed=frozenset(),
        phases=1,
        exit_s=1.0,
        budget_s=9.0,
        grace_s=1.0,
        stall_s=0.5,
        blocked_s=2.0,
        still_speed=0.01,
        still_turn=0.05,
    )


@pytest.fixture
def trace(tmp_path: Path) -> Path:
    path, now = tmp_path / "trace.jsonl", 0.0
    with TraceWriter(path) as writer:
        writer.write(Header(task="Store", seed=3, goal=(("on", "cheese", "shelf"),)))
        plan = (("pick", ("cheese",)), ("place", ("cheese",)))
        writer.write(PlanLine(time=0, reason="start", status="solved", steps=plan, state=()))
        for index, (step, states) in enumerate(RUNS):
            watch = watch_of(step, index, now, RUNS[index][1][0])
            writer.write(step_line(watch, check_start(watch, states[0]), attempt=index, shift=None))
            memory, before = Memory(), states[0]
            for i, state in enumerate(states[1:]):
                now += 0.05
                stage = int(i == 2)
                tick = Tick(now, state, stage, 0.0, False, True, 0.1, 0.0)
                judgement = judge(watch, tick, memory)
                writer.write(tick_line(tick, before, judgement.verdict, {}))
                memory, before = judgement.memory, state
        writer.note(now, "disturbance close-door@op=1")
        writer.write(RecoveryLine(time=now, name="recover-observe", reason="no plan", result="a way on"))
        failed = OutcomeLine(time=now, success=False, category="time limit", reason="over", replans=0, recoveries=1)
        writer.write(failed)
    return path


def edit(path: Path, event: str, which: int, change: Callable[[dict[str, Any]], None]) -> None:
    lines = [json.loads(line) for line in path.read_text().splitlines()]
    change([line for line in lines if line["event"] == event][which])
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))


def test_a_run_is_told_in_order(symskill: Callable[..., Any], trace: Path) -> None:
    done = symskill("replay", trace)
    assert done.status == 0, done.err
    assert done.err == ""
    parts = (
        "Store, seed 3, goal (on cheese shelf)",
        "1: (place cheese)",
        "preconditions hold",
        "+ (holds cheese)",
        "- (gripper-open)",
        "EffectsHold",
        "(place cheese), try 2",
        "- (door-open)",
        "Violation",
        "disturbance close-door@op=1",
        "recover-observe",
        "time limit",
        "the monitor decides all 7 the same",
    )
    at = [done.out.index(part) for part in parts]
    assert at == sorted(at)


def test_json_holds_the_same(symskill: Callable[..., Any], trace: Path) -> None:
    document = json.loads(symskill("replay", trace, "--json").out)
    assert (document["decisions"], document["different"]) == (7, 0)
    assert (document["complete"], document["success"]) == (True, False)
    assert [m["event"] for m in document["moments"]] == [
        *("plan", "step", "tick", "tick", "tick"),
        *("step", "tick", "tick", "note", "recovery", "outcome"),
    ]
    fallen = document["moments"][7]
    assert (fallen["step"], fallen["verdict"], fallen["removed"]) == (1, "Violation", ["(door-open)"])


def test_one_step_and_every_tick(symskill: Callable[..., Any], trace: Path) -> None:
    edit(trace, "tick", 1, lambda line: line.update(added=[], removed=[]))
    edit(trace, "tick", 1, lambda line: line.update(verdict={"kind": "Continue", "reason": "under way"}))
    few, all_ = (
        json.loads(symskill("replay", trace, "--step", 0, "--json", *more).out)["moments"] for more in ((), ("--ticks",))
    )
    assert {m["step"] for m in all_} == {0}
    assert len(all_) == 4
    assert len(few) < 4


@pytest.mark.parametrize(("number", "has"), [(2, "its steps are 0 to 1"), (-1, "its steps are 0 to 1")])
def test_a_step_that_is_not_there(symskill: Callable[..., Any], trace: Path, number: int, has: str) -> None:
    done = symskill("replay", trace, "--step", number)
    assert done.status == 2
    assert has in done.error


def test_another_verdict_is_marked_wherever_one_looks(symskill: Callable[..., Any], trace: Path) -> None:
    edit(trace, "tick", 4, lambda line: line.update(verdict={"kind": "Continue", "reason": "all is well"}))
    done = symskill("replay", trace)
    assert done.status == 1
    assert "DIFFERS, now: Violation" in done.out
    assert "1 of 7 decisions differ" in done.out
    # even where another step is looked at
    other = symskill("replay", trace, "--step", 0, "--json")
    assert other.status == 1
    assert json.loads(other.out)["different"] == 1


def test_a_run_without_monitor(symskill: Callable[..., Any], trace: Path) -> None:
    edit(trace, "header", 0, lambda line: line.update(monitor=False, obstacles=False))
    done = symskill("replay", trace)
    assert done.status == 0
    assert "without monitor, obstacles" in done.out
    assert "nothing to decide again" in done.out


def test_a_trace_that_was_cut_off(symskill: Callable[..., Any], trace: Path) -> None:
    whole = trace.read_text()
    trace.write_text(whole[:-30])
    done = symskill("replay", trace)
    assert done.status == 0
    assert "the last line (12) was cut off" in done.err
    assert done.err.count("\n") == 1
    assert "decides all 7 the same" in done.out
    trace.write_text("".join(line + "\n" for line in whole.splitlines()[:5]))
    done = symskill("replay", trace)
    assert "the run has no end" in done.err
    assert done.err.count("\n") == 1


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a trace starts with a header"),
        ("no trace\n", ":1: not a line of a trace"),
        ('{"event": "header"}\n{"event": "note", "time": "soon", "text": ""}\n', ":2: not a line of a trace: note.time"),
        ('{"event": "header", "goal": [[]]}\n', "goal.0"),
    ],
)
def test_what_is_no_trace(symskill: Callable[..., Any], tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "trace.jsonl"
    path.write_text(text)
    done = symskill("replay", path)
    assert (done.status, done.out) == (2, "")
    assert message in done.error


def test_a_tick_without_its_step(symskill: Callable[..., Any], trace: Path) -> None:
    lines = [line for line in trace.read_text().splitlines() if '"event":"step"' not in line]
    trace.write_text("\n".join(lines) + "\n")
    done = symskill("replay", trace)
    assert done.status == 2
    assert "belongs to no step, lines are missing" in done.error
    assert str(trace) in done.error


def test_there_is_no_file(symskill: Callable[..., Any], tmp_path: Path) -> None:
    done = symskill("replay", tmp_path / "none.jsonl")
    assert done.status == 2
    assert "there is no trace" in done.error
