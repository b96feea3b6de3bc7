import subprocess
import sys

import pytest
from fake_world import atoms
from hypothesis import given
from hypothesis import strategies as st

from symskill_pddl.execution.monitor import (
    Blame,
    Continue,
    EffectsHold,
    JumpAhead,
    Kind,
    Memory,
    OverTime,
    Stalled,
    Tick,
    Violation,
    Watch,
    check_start,
    judge,
    only_clearance_lacks,
    pending_deletes,
)
from symskill_pddl.symbols import GroundOperator

GRIPPER = frozenset({"holds"})


def op(name, pre="", add="", delete="", maintain="", absent=""):
    sets = [atoms(*filter(None, text.split(","))) for text in (pre, add, delete, maintain, absent)]
    return GroundOperator(name, ("x",), *sets)


PICK = op("pick", "gripper-open,at x counter", "holds x", "gripper-open,at x counter", "gripper-open,at x counter")
PLACE = op("place", "holds x,open door", "gripper-open,in x cabinet", "holds x", "holds x,open door", "gripper-open")
CLOSE = op("close", "gripper-open,open door", "shut door", "open door", "gripper-open,open door")
AT_COUNTER = atoms("gripper-open", "at x counter", "open door")
HELD = atoms("holds x", "open door")
PLACED = atoms("gripper-open", "in x cabinet", "open door")


def watch(step=PICK, later=(), state=AT_COUNTER, inherited="", assumed="", **changes):
    sets = {"inherited": atoms(*filter(None, [inherited])), "assumed": atoms(*filter(None, [assumed]))}
    times = {
        "exit_s": 1.0,
        "budget_s": 10.0,
        "grace_s": 1.0,
        "stall_s": 0.5,
        "blocked_s": 2.0,
        "still_speed": 0.01,
        "still_turn": 0.05,
    }
    return Watch(
        step=step,
        index=0,
        later=tuple(later),
        gripper=GRIPPER,
        start_s=0.0,
        start_state=state,
        phases=2,
        **sets,
        **times | changes,
    )


def tick(now=0.1, state=AT_COUNTER, stage=0, stage_s=0.0, settling=False, closing=False, speed=0.2, turn=0.0, rest_s=0.0):
    return Tick(now, state, stage, stage_s, settling, closing, speed, turn, rest_s)


def verdicts(w, *ticks):
    memory, found = Memory(), []
    for t in ticks:
        judgement = judge(w, t, memory)
        memory = judgement.memory
        found.append(judgement.verdict)
    return found


def last(w, *ticks):
    return verdicts(w, *ticks)[-1]


def test_under_way():
    assert last(watch(), tick()) == Continue("under way")


class TestPending:
    def test_a_pick_leaves_the_start_place_to_the_next_step(self):
        assert pending_deletes(PICK, GRIPPER) == atoms("at x counter")
        assert watch().must_fall == atoms("gripper-open")
        assert watch().pending == atoms("at x counter")

    def test_a_place_leaves_nothing(self):
        assert pending_deletes(PLACE, GRIPPER) == frozenset()
        assert pending_deletes(CLOSE, GRIPPER) == frozenset()

    def test_a_step_that_also_moves_something_has_to_do_its_deletes_itself(self):
        both = op("drag", "", "holds x,in x cabinet", "at x counter")
        assert pending_deletes(both, GRIPPER) == frozenset()

    def test_the_next_step_is_judged_for_what_is_owed(self):
        w = watch(PLACE, state=HELD | atoms("at x counter"), inherited="at x counter")
        still_there = PLACED | atoms("at x counter")
        assert isinstance(last(w, tick(state=still_there, stage=2, speed=0.0)), Continue)
        assert isinstance(last(w, tick(state=PLACED, stage=2, speed=0.0)), EffectsHold)
        assert w.pending == frozenset()

    def test_what_the_next_step_adds_again_is_not_owed(self):
        back = op("place-back", "holds x", "gripper-open,at x counter", "holds x")
        w = watch(back, state=HELD | atoms("at x counter"), inherited="at x counter")
        assert w.must_fall == atoms("holds x")

    def test_a_premotion_passes_on_what_it_inherits(self):
        w = watch(PICK, inherited="at y counter")
        assert w.must_fall == atoms("gripper-open")
        assert w.pending == atoms("at x counter", "at y counter")


class TestEffects:
    def test_a_pick_succeeds_while_the_object_is_still_at_its_place(self):
        # the paper's algorithm calls this a violation, for the maintained "gripper-open" has fallen
        held_at_counter = atoms("holds x", "at x counter", "open door")
        assert isinstance(last(watch(), tick(state=held_at_counter, stage=2, closing=True, speed=0.0)), EffectsHold)

    def test_fingers_have_to_rest_first(self):
        held = atoms("holds x", "at x counter", "open door")
        assert isinstance(last(watch(), tick(state=held, stage=2, settling=True, closing=True, speed=0.0)), Continue)

    def test_deletes_count(self):
        both = PLACED | atoms("holds x")
        assert isinstance(last(watch(PLACE, state=HELD), tick(state=both, stage=1, stage_s=5.0)), Continue)

    @pytest.mark.parametrize(
        ("moment", "ends"),
        [
            (tick(state=PLACED, stage=0, speed=0.0), False),
            (tick(state=PLACED, stage=1, stage_s=0.2), False),
            (tick(state=PLACED, stage=1, stage_s=1.0), True),
            (tick(state=PLACED, stage=1, stage_s=0.2, speed=0.0), True),
            (tick(state=PLACED, stage=2, speed=0.2), True),
            (tick(now=11.0, state=PLACED, stage=0), True),
        ],
    )
    def test_the_exit_is_finished_first(self, moment, ends):
        assert isinstance(last(watch(PLACE, state=HELD), moment), EffectsHold if ends else Continue)

    def test_effects_that_fall_during_the_exit_are_missed(self):
        gone = PLACED - atoms("in x cabinet")
        w = watch(PLACE, state=HELD)
        found = verdicts(w, tick(0.1, PLACED, 1, 0.1), tick(0.2, gone, 1, 0.2), tick(1.3, gone, 1, 1.2))
        assert isinstance(found[0], Continue)
        assert isinstance(found[1], Continue)
        assert found[2].blame is Blame.OWN

    def test_tested_before_everything_else(self):
        # the door closes behind the object in the moment in which all is done
        assert isinstance(last(watch(PLACE, state=HELD), tick(99.0, PLACED - atoms("open door"), 2, speed=0.0)), EffectsHold)


class TestJump:
    def test_to_a_later_step_whose_preconditions_hold(self):
        found = last(watch(PICK, [PLACE, CLOSE]), tick(state=PLACED))
        assert isinstance(found, JumpAhead)
        assert found.index == 2

    def test_to_the_end(self):
        found = last(watch(PICK, [PLACE, CLOSE]), tick(state=atoms("gripper-open", "in x cabinet", "shut door")))
        assert found.index == 3

    def test_not_while_the_fingers_move(self):
        assert isinstance(last(watch(PICK, [PLACE, CLOSE]), tick(state=PLACED, settling=True)), Continue)

    def test_not_without_the_earlier_effects(self):
        # the last step could start, but nothing has been put away
        assert isinstance(last(watch(PICK, [PLACE, CLOSE]), tick(state=AT_COUNTER)), Continue)

    def test_what_the_step_before_leaves_pending_is_not_asked_for(self):
        (after_place, after_pick) = watch(CLOSE, [PICK, op("box", "holds x", "gripper-open,in x box", "holds x")]).targets
        assert (after_place.index, after_pick.index) == (3, 2)
        assert after_pick.needs == atoms("shut door", "holds x")
        assert after_pick.forbids == atoms("open door", "gripper-open")
        assert after_place.forbids == atoms("open door", "holds x", "at x counter")


class TestViolation:
    def test_a_protected_atom_falls(self):
        found = last(watch(PLACE, state=HELD), tick(state=HELD - atoms("open door"), closing=True))
        assert (found.kind, found.blame) == (Kind.PROTECTED, Blame.EXTERNAL)
        assert found.atoms == tuple(atoms("open door"))
        assert "(open door)" in found.reason

    def test_a_protected_grasp_blames_the_step_that_acquired_it(self):
        carry = op("carry", "holds x", "near x cabinet", "", "holds x")
        found = last(watch(carry, state=HELD), tick(state=atoms("open door"), closing=True))
        assert (found.kind, found.blame) == (Kind.LOST_GRASP, Blame.ACQUIRING)

    def test_what_did_not_hold_at_the_start_is_not_protected(self):
        assert isinstance(last(watch(PLACE, state=atoms("holds x")), tick(state=atoms("holds x"), closing=True)), Continue)

    def test_a_lost_grasp_after_the_grace_time(self):
        lost = HELD - atoms("holds x")
        found = verdicts(watch(PLACE, state=HELD), *(tick(t, lost, closing=True) for t in (1.0, 1.9, 2.1)))
        assert isinstance(found[1], Continue)
        assert (found[2].kind, found[2].blame) == (Kind.LOST_GRASP, Blame.ACQUIRING)

    def test_an_atom_that_comes_back_starts_the_grace_time_again(self):
        lost = HELD - atoms("holds x")
        ticks = [
            tick(1.0, lost, closing=True),
            tick(1.5, HELD, closing=True),
            tick(1.6, lost, closing=True),
            tick(2.1, lost, closing=True),
        ]
        assert isinstance(last(watch(PLACE, state=HELD), *ticks), Continue)

    def test_a_release_that_missed_blames_the_step(self):
        missed = atoms("gripper-open", "open door")
        found = last(watch(PLACE, state=HELD), tick(1.0, missed, 1), tick(2.1, missed, 1))
        assert (found.kind, found.blame) == (Kind.EFFECTS, Blame.OWN)

    def test_closing_on_nothing_blames_the_step_once_the_fingers_rest(self):
        closed = AT_COUNTER - atoms("gripper-open")
        w = watch()
        found = verdicts(
            w,
            tick(1.0, closed, 2, settling=True, closing=True, speed=0.2),
            tick(2.5, closed, 2, settling=True, closing=True, speed=0.2),
            tick(3.0, closed, 2, closing=True, speed=0.2),
            tick(3.6, closed, 2, closing=True, speed=0.2),
        )
        assert [type(v) for v in found] == [Continue, Continue, Continue, Violation]
        assert found[-1].blame is Blame.OWN

    def test_an_object_taken_away_is_external(self):
        away = AT_COUNTER - atoms("at x counter")
        found = last(watch(), tick(1.0, away), tick(2.1, away))
        assert (found.kind, found.blame) == (Kind.EFFECTS, Blame.EXTERNAL)

    def test_what_is_owed_may_fall_for_good(self):
        w = watch(PLACE, state=HELD | atoms("at x counter"), inherited="at x counter")
        assert isinstance(last(w, tick(1.0, HELD, closing=True), tick(5.0, HELD, closing=True)), Continue)


class TestAssumption:
    """That x stands at the counter, where it stands in no known relation."""

    NOWHERE = atoms("gripper-open", "open door")
    ELSEWHERE = NOWHERE | atoms("in x cabinet")

    def assuming(self, step=PICK):
        return watch(step, state=self.NOWHERE, assumed="at x counter")

    def test_it_stands_while_nothing_else_is_seen(self):
        assert last(self.assuming(), tick(state=self.NOWHERE), tick(5.0, self.NOWHERE)) == Continue("under way")

    def test_it_is_dropped_at_once_when_the_thing_is_seen_elsewhere(self):
        found = last(self.assuming(), tick(state=self.NOWHERE), tick(0.15, self.ELSEWHERE))
        assert (found.kind, found.blame, found.atoms) == (Kind.PRECONDITION, Blame.EXTERNAL, tuple(atoms("at x counter")))
        assert found.reason == "(in x cabinet) is seen, where (at x counter) was assumed"

    def test_also_after_it_was_seen_to_be_true(self):
        assert last(self.assuming(), tick(state=AT_COUNTER), tick(0.15, self.ELSEWHERE)).kind is Kind.PRECONDITION

    def test_not_while_it_is_seen_to_be_true_as_well(self):
        assert last(self.assuming(), tick(state=AT_COUNTER | atoms("in x cabinet"))) == Continue("under way")

    def test_not_because_of_another_thing_or_the_hand(self):
        assert last(self.assuming(), tick(state=self.NOWHERE | atoms("in y cabinet"))) == Continue("under way")
        closing = atoms("holds x", "gripper-open", "open door")
        assert last(self.assuming(), tick(state=closing)) == Continue("under way")

    def test_not_while_the_fingers_move(self):
        assert last(self.assuming(), tick(state=self.ELSEWHERE, settling=True)) == Continue("under way")

    def test_not_where_the_step_itself_moves_the_thing(self):
        push = op("push", "at x counter", "in x cabinet", "at x counter")
        assert last(self.assuming(push), tick(state=self.NOWHERE | atoms("at x table"))) == Continue("under way")

    def test_not_where_the_step_does_not_rest_on_it(self):
        other = op("close", "open door", "shut door", "open door")
        assert last(self.assuming(other), tick(state=self.ELSEWHERE)) == Continue("under way")


class TestRest:
    def test_stall(self):
        found = verdicts(watch(), *(tick(t, speed=0.0) for t in (1.0, 1.4, 1.5)))
        assert [type(v) for v in found] == [Continue, Continue, Stalled]
        assert "(holds x)" in found[-1].reason

    def test_turning_is_no_stall(self):
        assert isinstance(last(watch(), *(tick(t, speed=0.0, turn=0.2) for t in (1.0, 2.0))), Continue)

    def test_waiting_for_the_fingers_is_no_stall(self):
        assert isinstance(last(watch(), *(tick(t, speed=0.0, settling=True) for t in (1.0, 2.0))), Continue)

    def test_a_new_phase_starts_anew(self):
        assert isinstance(last(watch(), tick(1.0, speed=0.0), tick(1.6, stage=1, speed=0.0)), Continue)

    def test_a_blocked_hand(self):
        found = last(watch(), tick(5.0, rest_s=2.0))
        assert isinstance(found, Stalled)
        assert found.blocked
        assert "blocked: told 0.20 m/s" in found.reason
        assert isinstance(last(watch(), tick(5.0, rest_s=1.9)), Continue)
        assert isinstance(last(watch(), tick(5.0, rest_s=9.0, settling=True)), Continue)
        # one that is not told to move is not blocked
        assert not last(watch(), *(tick(t, speed=0.0, rest_s=9.0) for t in (1.0, 2.0))).blocked

    def test_over_time(self):
        assert isinstance(last(watch(), tick(10.0)), Continue)
        assert isinstance(last(watch(), tick(10.1)), OverTime)


class TestStart:
    def test_may_start(self):
        assert check_start(watch(), AT_COUNTER) == Continue("preconditions hold")

    def test_missing_precondition(self):
        found = check_start(watch(PLACE, state=HELD), atoms("holds x"))
        assert (found.kind, found.blame, found.atoms) == (Kind.PRECONDITION, Blame.EXTERNAL, tuple(atoms("open door")))

    def test_assumed_precondition(self):
        found = check_start(watch(PLACE, assumed="open door"), atoms("holds x"))
        assert isinstance(found, Continue)
        assert "assuming (open door)" in found.reason

    def test_an_assumption_is_not_rested_on_where_something_else_is_seen(self):
        found = check_start(watch(PLACE, assumed="open door"), atoms("holds x", "shut door"))
        assert (found.kind, found.blame, found.atoms) == (Kind.PRECONDITION, Blame.EXTERNAL, tuple(atoms("open door")))
        assert found.reason == "(shut door) is seen, where (open door) was assumed"

    def test_forbidden_atom(self):
        found = check_start(watch(PLACE), HELD | atoms("gripper-open"))
        assert found.kind is Kind.PRECONDITION
        assert "forbids (gripper-open)" in found.reason

    def test_forbidden_atom_whose_deletion_is_owed(self):
        lift = op("lift", "holds x", "high x", "", "", "at x counter")
        state = HELD | atoms("at x counter")
        assert isinstance(check_start(watch(lift, state=state, inherited="at x counter"), state), Continue)

    def test_effects_hold_already(self):
        assert isinstance(check_start(watch(PLACE), PLACED), EffectsHold)

    def test_the_rest_has_come_about(self):
        assert check_start(watch(PICK, [PLACE]), PLACED).index == 2


UNIVERSE = sorted(PICK.pre | PLACE.pre | PLACE.add | CLOSE.add)
STATES = st.frozensets(st.sampled_from(UNIVERSE))
TICKS = st.lists(
    st.builds(
        Tick,
        now_s=st.floats(0, 20),
        state=STATES,
        stage=st.integers(0, 2),
        stage_s=st.floats(0, 5),
        settling=st.booleans(),
        closing=st.booleans(),
        speed=st.sampled_from([0.0, 0.2]),
        turn=st.sampled_from([0.0, 0.2]),
        rest_s=st.sampled_from([0.0, 3.0]),
    ),
    max_size=8,
)


@given(start=STATES, ticks=TICKS, which=st.sampled_from([PICK, PLACE, CLOSE]))
def test_laws(start, ticks, which):
    w = watch(which, [PLACE, CLOSE], state=start, inherited="at x counter")
    ticks = sorted(ticks, key=lambda t: t.now_s)
    found = verdicts(w, *ticks)
    assert found == verdicts(w, *ticks)
    for t, verdict in zip(ticks, found, strict=True):
        assert verdict.reason
        done = w.step.add <= t.state and not w.must_fall & t.state
        assert done or not isinstance(verdict, EffectsHold)
        assert not done or isinstance(verdict, EffectsHold | Continue)
        if isinstance(verdict, Violation):
            assert verdict.atoms
            assert not set(verdict.atoms) & t.state
        if isinstance(verdict, JumpAhead):
            assert 2 <= verdict.index <= 3


def test_only_clearance_lacks():
    w = watch(PLACE, state=HELD)
    assert only_clearance_lacks(w, PLACED | atoms("holds x"))
    assert not only_clearance_lacks(w, PLACED)
    assert not only_clearance_lacks(w, (PLACED | atoms("holds x")) - atoms("gripper-open"))
    assert not only_clearance_lacks(w, atoms("holds x", "gripper-open"))


def test_needs_no_numpy():
    code = "import sys; import symskill_pddl.execution.monitor; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
