import pytest

from symskill_pddl.execution.lines import Header, StepLine
from symskill_pddl.execution.trace import Trace
from symskill_pddl.report.run import view_run
from symskill_pddl.report.timeline import LABEL, RIGHT, WIDTH, timeline


def test_a_run_is_told_in_order(trace):
    run = view_run(trace)
    assert (run.task, run.seed, run.planner, run.success, run.replans, run.recoveries) == ("StoreCheese", 3, "gbfs", True, 1, 1)
    assert run.duration_s == pytest.approx(8.05)
    assert [(a.number, a.plan, a.step.split()[0], a.verdict, a.tone) for a in run.attempts] == [
        (1, 1, "(pick-food", "done", "good"),
        (2, 1, "(place-food-in-cabinet", "violation", "bad"),
        (3, 2, "(pick-food", "jumped ahead", "skip"),
        (4, 2, "(place-food-in-cabinet", "done", "good"),
    ]
    lost = run.attempts[1]
    assert (lost.reason, lost.blame, lost.atoms) == ("the grasp was lost", "acquiring step", "(gripper-holds-food cheese)")
    assert (lost.start, lost.end) == pytest.approx((2.05, 3.1))
    assert [a.resampled for a in run.attempts] == [False, False, True, False]
    assert [(e.kind, e.text) for e in run.events] == [
        ("note", "cheese was pushed by 6 cm"),
        ("recovery", "retreat: a lost grasp (clear)"),
    ]
    assert [(p.number, p.reason, p.ms) for p in run.plans] == [
        (1, "start", pytest.approx(12)),
        (2, "lost grasp", pytest.approx(20)),
    ]
    assert run.plans[0].steps == ("(pick-food cheese)", "(place-food-in-cabinet cheese cabinet door)")


def test_the_goal_is_looked_up_in_the_last_state(trace):
    assert [(g.atom, g.holds) for g in view_run(trace).goal] == [
        ("(food-in-cabinet cheese cabinet)", True),
        ("(door-closed-at-cabinet door cabinet)", False),
    ]


def test_timing_counts_every_tick_and_call(trace):
    timing = {t.name: t for t in view_run(trace).timing}
    assert list(timing) == [
        "tick: observe + abstract + monitor + skill + obstacles + controller",
        "abstract",
        "skill",
        "first plan",
        "replanning",
    ]
    assert timing["replanning"].count == 1
    assert timing["replanning"].longest == pytest.approx(20)
    assert timing["abstract"].count == len(trace.of("tick"))
    assert timing["skill"].median == pytest.approx(0.4)


def test_a_trace_that_was_cut_off_is_told_as_far_as_it_goes(new_trace):
    whole = new_trace(outcome=False)
    cut = Trace(whole.header, whole.lines[:30], "the last line (31) was cut off and is left out")
    run = view_run(cut)
    assert run.success is None
    assert run.reason == "the trace ends without an outcome"
    assert [(a.verdict, a.tone) for a in run.attempts] == [("interrupted", "idle")]
    assert run.note.startswith("the last line")


def test_a_step_that_may_not_start_has_its_verdict_and_no_length(new_trace):
    whole = new_trace()
    place = next(x for x in whole.lines if isinstance(x, StepLine) and x.index == 1)
    lost = next(x.verdict for x in whole.of("tick") if x.verdict.kind == "Violation")
    run = view_run(Trace(whole.header, (place.model_copy(update={"verdict": lost}),)))
    assert [(a.verdict, a.plan, a.end - a.start) for a in run.attempts] == [("violation", 0, 0.0)]


def test_without_a_monitor_a_step_lasts_until_the_next_line(trace):
    steps = [line for line in trace.lines if line.event in ("plan", "step", "outcome")]
    run = view_run(Trace(trace.header.model_copy(update={"monitor": False}), tuple(steps)))
    assert [(a.start, a.end) for a in run.attempts] == [(0, 2.05), (2.05, 4.0), (4.05, 6.1), (6.1, 8.05)]
    assert {(a.verdict, a.tone) for a in run.attempts} == {("not judged", "idle")}


def test_an_empty_trace():
    run = view_run(Trace(Header(), ()))
    assert (run.attempts, run.plans, run.timing, run.duration_s) == ((), (), (), 0.0)
    drawing = timeline(run)
    assert drawing.bars == ()
    assert drawing.height > 0


def test_the_drawing_keeps_time_order_and_stays_inside(trace):
    drawing = timeline(view_run(trace))
    assert [row for row, _ in drawing.rows] == ["(pick-food cheese)", "(place-food-in-cabinet cheese cabinet door)"]
    assert [b.tone for b in drawing.bars] == ["good", "bad", "skip", "good"]
    assert drawing.bars[0].y == drawing.bars[2].y != drawing.bars[1].y
    for before, after in zip(drawing.bars, drawing.bars[1:], strict=False):
        assert before.x + before.width <= after.x + 1e-6
    for bar in drawing.bars:
        assert bar.x >= LABEL
        assert bar.x + bar.width <= WIDTH - RIGHT + 1e-6
    assert [line.kind for line in drawing.lines] == ["plan", "plan", "note", "recovery"]
    assert [label for _, label in drawing.ticks][:3] == ["0 s", "1 s", "2 s"]
