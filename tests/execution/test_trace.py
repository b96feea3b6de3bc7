import json

import pytest
from fake_world import atoms

from symskill_pddl.errors import FormatError, InputError
from symskill_pddl.execution.lines import Header, OutcomeLine, load_tick, load_watch, step_line, tick_line, verdict_line
from symskill_pddl.execution.monitor import (
    Blame,
    Continue,
    EffectsHold,
    JumpAhead,
    Kind,
    OverTime,
    Stalled,
    Tick,
    Violation,
    Watch,
)
from symskill_pddl.execution.replay import replay
from symskill_pddl.execution.trace import TraceWriter, read_trace
from symskill_pddl.symbols import GroundOperator

STEP = GroundOperator("pick", ("x",), atoms("a x"), atoms("holds x"), atoms("a x"), atoms("b"), atoms("c x y"), 2.5)
WATCH = Watch(
    step=STEP,
    index=1,
    later=(STEP,),
    gripper=frozenset({"holds"}),
    start_s=0.1 + 0.2,
    start_state=atoms("a x", "b"),
    inherited=atoms("d"),
    assumed=atoms("a x"),
    phases=2,
    exit_s=1 / 3,
    budget_s=10.0,
    grace_s=1.0,
    stall_s=0.5,
    blocked_s=2.0,
    still_speed=0.01,
    still_turn=0.05,
)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "trace.jsonl"


def write(path, *lines):
    with TraceWriter(path) as trace:
        trace.write(Header(task="StoreCheese", seed=3))
        for line in lines:
            trace.write(line)


def test_watch_and_tick_survive_json_bit_by_bit(path):
    tick = Tick(1 / 3, atoms("b", "holds x"), 1, 0.1 + 0.2, True, False, 1e-17, 3.14159, 0.7)
    write(
        path,
        step_line(WATCH, Continue("go"), attempt=1, shift=(0.1,) * 7),
        tick_line(tick, WATCH.start_state, Continue("go"), {"skill": 0.1}),
    )
    trace = read_trace(path)
    assert load_watch(trace.lines[0]) == WATCH
    assert trace.lines[1].removed == (("a", "x"),)
    assert load_tick(trace.lines[1], tick.state) == tick
    assert trace.header.task == "StoreCheese"
    assert trace.note == ""


@pytest.mark.parametrize(
    "verdict",
    [
        Continue("a"),
        EffectsHold("b"),
        JumpAhead(4, "c"),
        Violation(Kind.LOST_GRASP, tuple(atoms("holds x")), Blame.ACQUIRING, "d"),
        Stalled("e"),
        Stalled("e", blocked=True),
        OverTime("f"),
    ],
)
def test_every_verdict_is_written_with_its_reason(path, verdict):
    write(path, step_line(WATCH, verdict, attempt=0, shift=None))
    line = read_trace(path).lines[0].verdict
    assert line == verdict_line(verdict)
    assert (line.kind, line.reason) == (type(verdict).__name__, verdict.reason)


def test_verdicts_differ_in_their_lines():
    a = Violation(Kind.PROTECTED, tuple(atoms("p")), Blame.EXTERNAL, "r")
    b = Violation(Kind.PROTECTED, tuple(atoms("q")), Blame.EXTERNAL, "r")
    assert verdict_line(a) != verdict_line(b)


def test_replay_notices_another_decision(path):
    write(path, step_line(WATCH, Continue("made up"), attempt=0, shift=None))
    (again,) = replay(read_trace(path))
    assert not again.same
    assert again.again.kind == "Continue"


def test_a_line_is_on_the_disk_as_soon_as_it_is_written(path):
    trace = TraceWriter(path)
    trace.write(Header())
    trace.note(1.5, "the door was closed")
    assert read_trace(path).lines[0].text == "the door was closed"
    trace.close()


def test_a_cut_last_line_is_left_out_and_noted(path):
    write(path, OutcomeLine(time=1, success=True, category="success", reason="", replans=0, recoveries=0))
    whole = path.read_text()
    path.write_text(whole + '{"event": "tick", "time": 1.')
    trace = read_trace(path)
    assert "line (3) was cut off" in trace.note
    assert trace.outcome.success


def test_the_listener_gets_every_line(path):
    heard = []
    with TraceWriter(path, heard.append) as trace:
        trace.write(Header())
        trace.note(0.0, "x")
    assert [line.event for line in heard] == ["header", "note"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "starts with a header"),
        ('{"event": "note", "time": 0, "text": ""}\n', "starts with a header"),
        ('{"event": "header"}\n{"event": "nonsense"}\n{"event": "note", "time": 0, "text": ""}\n', ":2: not a line of a trace"),
        ('{"event": "header", "schema_version": 99}\n', "version 99, this program reads version 2"),
        ('{"event": "header"}\n{"event": "note"\n', ":2: not a line"),
        ('{"event": "header", "colour": "red"}\n', ":1: not a line of a trace: header.colour"),
        ("{", ":1: not a line of a trace"),
    ],
)
def test_what_is_no_trace_is_refused(path, text, message):
    path.write_text(text)
    with pytest.raises(FormatError) as error:
        read_trace(path)
    assert message in str(error.value)
    assert "\n" not in str(error.value)


def test_missing_file_and_folder(tmp_path):
    with pytest.raises(InputError, match="there is no trace"):
        read_trace(tmp_path / "none.jsonl")
    with pytest.raises(InputError, match="cannot write the trace"):
        TraceWriter(tmp_path / "no" / "folder.jsonl")
    (tmp_path / "binary").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not UTF-8 text, a trace is needed"):
        read_trace(tmp_path / "binary")


def test_lines_are_plain_json(path):
    write(path, step_line(WATCH, Continue("go"), attempt=0, shift=None))
    for row in path.read_text().splitlines():
        assert json.loads(row)["event"] in ("header", "step")
