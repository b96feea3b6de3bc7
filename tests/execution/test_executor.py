from dataclasses import replace

import numpy as np
import pytest
from fake_world import CABINET, COUNTER, DOWN, HINGE, HOME, OBJECTS, FakeWorld, at, atoms, handle, make_library, operator, phase

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.execution.config import ExecutionConfig, MotionConfig
from symskill_pddl.execution.executor import execute
from symskill_pddl.execution.outcome import Category, Cause
from symskill_pddl.execution.replay import replay
from symskill_pddl.execution.trace import TraceWriter, read_trace
from symskill_pddl.geometry import Pose
from symskill_pddl.library import LearnedOperator
from symskill_pddl.planning import Builtin, get
from symskill_pddl.scene import Command
from symskill_pddl.skills import Skill

LIBRARY = make_library()
IN_CABINET = atoms("food-in-cabinet cheese cabinet")
ON_COUNTER = atoms("food-on-counter cheese counter")


def run(world, goal=IN_CABINET, library=LIBRARY, config=None, **rest):
    return execute(
        world, library, library.domain(), goal, Builtin(), config, objects=OBJECTS, rng=np.random.default_rng(0), **rest
    )


def names(outcome):
    return [s.step.strip("()").split()[0] for s in outcome.steps]


def verdicts(outcome):
    return [s.verdict for s in outcome.steps]


def when(world, step, action, delay=0.0):
    """A listener that does something to the world after the first start of a step."""
    done = []

    def on_step(index, ground):
        if ground.name == step and not done:
            done.append(index)
            world.after(delay, action)

    return on_step


def without(library, *operators):
    return replace(library, operators=tuple(o for o in library.operators if o.operator.name not in operators))


ALL = ["reach-closed-door", "open-door", "pick-from-counter", "place-in-cabinet"]


class Slippery(FakeWorld):
    """An open hand at the handle pushes the door, but slips off the first time."""

    slips = 1

    def _fingers(self, close):
        super()._fingers(close)
        near = np.linalg.norm(handle(self.angle).p - self.ee.p) < 0.04
        self.on_door = near and not self.slips
        behind = (self.ee.p - handle(self.angle).p) @ handle(self.angle).rotate([1.0, 0.0, 0.0]) > 0.1
        if self.slips and behind and abs(self.ee.p[2] - HINGE[2]) < 0.02:
            self.slips -= 1


def pushing():
    """A library that shuts the door with the open hand."""
    shut = tuple(phase("?cabinet", Pose(handle(a).p - CABINET, DOWN), False) for a in (1.0, 0.5, 0.0))
    retreat = phase("?cabinet", Pose(handle(0.0).p - CABINET + [0, 0, 0.15], DOWN), False)
    skills = {"reach": replace(LIBRARY.skills["reach-door"], close_gripper_at_end=False), "push": Skill((*shut, retreat), False)}
    at_door, free = "gripper-holds-door ?door", "gripper-open"
    opened, closed = "door-open ?door ?cabinet", "door-closed ?door ?cabinet"
    table = (
        ("reach-open-door", "reach", "reach", {free, opened}, {at_door}, {opened}, {free, opened}),
        ("push-door", "move", "push", {free, at_door}, {closed}, {at_door}, {free, at_door}),
    )
    operators = tuple(
        LearnedOperator(operator(name, "door cabinet", *sets, ()), atoms(*sets[0]), skill, kind, (), (4.0, 5.0))
        for name, kind, skill, *sets in table
    )
    return replace(LIBRARY, operators=operators, skills=skills)


class TestSuccess:
    def test_opens_the_door_and_puts_the_food_away(self):
        world = FakeWorld()
        outcome = run(world)
        assert outcome.success
        assert outcome.category is Category.SUCCESS
        assert names(outcome) == ALL
        assert set(verdicts(outcome)) == {"EffectsHold"}
        assert outcome.replans == 0
        assert not outcome.recoveries
        assert world.grasp is None
        assert outcome.state >= IN_CABINET
        assert len(outcome.plan_seconds) == 1
        # the fake world does not say what it spends on observing, so that all of its step counts as the world's own
        assert list(outcome.times) == ["tick", "abstract", "monitor", "skill", "world", "first plan"]
        assert all(0 <= t.p50 <= t.p95 <= t.max for t in outcome.times.values())

    def test_the_exit_is_carried_out_before_the_next_step(self):
        world = FakeWorld(angle=1.5)
        run(world)
        # the retreat ends 20 cm above the cabinet's frame; the effects hold much earlier
        assert world.ee.p[2] == pytest.approx(CABINET[2] + 0.2, abs=0.01)

    def test_nothing_to_do(self):
        outcome = run(FakeWorld(), ON_COUNTER)
        assert outcome.success
        assert outcome.steps == ()

    def test_same_seed_same_run(self):
        a, b = run(FakeWorld()), run(FakeWorld())
        assert a.steps == b.steps

    def test_the_gripper_starts_closed_on_nothing(self):
        outcome = run(FakeWorld(closed=True))
        assert outcome.success
        assert outcome.recoveries == ("recover-open",)

    def test_the_goal_holds_but_the_object_is_still_held(self):
        world = FakeWorld(ee=Pose(COUNTER + np.array([0.02, 0, 0.03]), HOME.q))
        for _ in range(10):
            world.step(_closed())
        assert world.grasp is not None
        outcome = run(world, ON_COUNTER)
        assert outcome.success
        assert world.grasp is None


def _closed():
    return Command.hold(True)


class TestDisturbances:
    def test_the_door_is_shut_while_carrying(self):
        world = FakeWorld(angle=1.5)
        outcome = run(world, on_step=when(world, "place-in-cabinet", world.shut, 0.3))
        assert outcome.success
        # food down, door open again, food away
        assert names(outcome) == ["pick-from-counter", "place-in-cabinet", "place-on-counter", *ALL]
        assert verdicts(outcome)[1] == "Violation"
        assert "door-open" in outcome.steps[1].reason
        assert (outcome.cause, outcome.troubles) == (None, (Cause.EXTERNAL,))

    def test_a_thing_that_falls_where_it_belongs_is_left_there(self):
        world = FakeWorld(angle=1.5)
        free = world.step

        def slippery(command):
            scene = free(command)
            if world.grasp is not None and np.linalg.norm((world.cheese.p - CABINET)[:2]) < 0.14:
                world.grasp, world.cheese = None, Pose(CABINET + np.array([0, 0, 0.05]), [1.0, 0, 0, 0])
            return scene

        world.step = slippery
        outcome = run(world, config=ExecutionConfig(grace_s=0.1))
        assert outcome.success
        assert names(outcome) == ["pick-from-counter", "place-in-cabinet"]
        assert outcome.troubles == (Cause.GRASP,)
        assert outcome.recoveries == ("recover-leave",)
        # the hand does not stay where it was about to let go
        assert np.linalg.norm(world.ee.p - world.cheese.p) > 0.08

    def test_a_lost_grasp_blames_the_pick_which_is_resampled(self):
        world, lines = FakeWorld(angle=1.5), []
        outcome = run(world, on_step=when(world, "place-in-cabinet", world.drop, 0.2), on_event=lines.append)
        assert outcome.success
        assert names(outcome) == ["pick-from-counter", "place-in-cabinet", "pick-from-counter", "place-in-cabinet"]
        assert verdicts(outcome)[1] == "Violation"
        assert [s.attempt for s in outcome.steps] == [0, 0, 1, 0]
        steps = [line for line in lines if line.event == "step"]
        assert [s.shift is not None for s in steps] == [False, False, True, False]
        assert outcome.recoveries == ("recover-open",)
        assert outcome.troubles == (Cause.GRASP,)

    def test_the_object_is_moved_before_it_is_picked(self):
        world = FakeWorld(angle=1.5)

        def move():
            world.cheese = at(*(world.cheese.p + np.array([0.06, -0.05, 0.0])))

        outcome = run(world, on_step=when(world, "pick-from-counter", move, 0.3))
        # a stable field in the object's frame needs no symbolic recovery
        assert outcome.success
        assert outcome.replans == 0

    def test_somebody_does_it(self):
        world = FakeWorld(angle=1.5)

        def put_away():
            world.cheese = Pose(CABINET + np.array([0, 0, 0.05]), [1.0, 0, 0, 0])

        outcome = run(world, on_step=when(world, "pick-from-counter", put_away, 0.3))
        assert outcome.success
        assert verdicts(outcome) == ["JumpAhead"]

    def test_a_precondition_falls_between_two_steps(self):
        world = FakeWorld(angle=1.5)
        # nothing protects the door during the pick; the place needs it
        outcome = run(world, on_step=when(world, "pick-from-counter", world.shut, 0.3))
        assert outcome.success
        assert names(outcome)[0] == "pick-from-counter"
        assert names(outcome)[-4:] == ALL

    def test_a_door_that_is_still_moving_is_waited_for(self):
        world = FakeWorld(angle=1.5)

        def slowly():
            world.shut(0.7)
            world.after(1.0, world.shut)

        outcome = run(world, on_step=when(world, "pick-from-counter", slowly, 0.3), library=without(LIBRARY, "place-on-counter"))
        assert outcome.success
        assert "recover-observe" in outcome.recoveries

    def test_the_hand_leaves_what_somebody_else_has_done(self):
        world = FakeWorld()
        before = []

        def help_out():
            world.on_door, world.angle = False, 1.5
            before.append(world.ee.p)

        outcome = run(world, atoms("door-open door cabinet"), on_step=when(world, "reach-closed-door", help_out, 0.5))
        assert outcome.success
        assert outcome.recoveries == ("recover-leave",)
        assert world.ee.p[2] > before[0][2] + 0.1


class TestFailures:
    def test_a_grasp_that_slips_is_resampled(self):
        world = FakeWorld(angle=1.5)
        world.slippery = 1
        outcome = run(world)
        assert outcome.success
        assert outcome.steps[0].verdict in ("Violation", "Stalled")
        assert [s.attempt for s in outcome.steps if "pick" in s.step] == [0, 1]

    def test_effects_that_never_come_stall_and_a_shift_helps(self):
        # the field's goal is 17 cm off; samples of the effect predicate are where the food has to be
        off = Skill(
            (phase("?counter", Pose([0.17, 0, 0.03], DOWN), True), phase("?counter", Pose([0.17, 0, 0.2], DOWN), False)), False
        )
        library = replace(LIBRARY, skills={**LIBRARY.skills, "place-counter": off})
        world = FakeWorld(cheese=Pose(CABINET + np.array([0, 0, 0.05]), [1.0, 0, 0, 0]), angle=1.5)
        outcome = run(world, ON_COUNTER, library)
        assert "place-on-counter" in names(outcome)
        assert next(s.verdict for s in outcome.steps if "place-on" in s.step) in ("Stalled", "Violation")
        assert outcome.success

    def test_a_hand_that_stays_too_near_backs_off(self):
        # a skill without an exit: the food is in its place, the fingers are open, and the hand is still around it
        short = Skill((phase("?cabinet", Pose([0, 0, 0.05], DOWN), True),), False)
        library = replace(LIBRARY, skills={**LIBRARY.skills, "place-cabinet": short})
        outcome = run(FakeWorld(angle=1.5), library=library)
        assert outcome.success
        assert outcome.recoveries == ("recover-clear",)
        assert verdicts(outcome) == ["EffectsHold", "Stalled"]

    def test_an_open_hand_that_slips_off_takes_hold_elsewhere(self):
        world, lines = Slippery(angle=1.5), []
        config = ExecutionConfig(stall_s=10.0)
        outcome = run(world, atoms("door-closed door cabinet"), pushing(), config, on_event=lines.append)
        assert outcome.success
        assert names(outcome) == ["reach-open-door", "push-door"] * 2
        assert verdicts(outcome) == ["EffectsHold", "Violation", "EffectsHold", "EffectsHold"]
        # both may have been at fault, and both are tried otherwise, from where the hand is clear of the door
        assert [s.attempt for s in outcome.steps] == [0, 0, 1, 1]
        assert [line.shift is not None for line in lines if line.event == "step"] == [False, False, True, True]
        assert outcome.recoveries == ("recover-clear",)
        assert outcome.troubles == (Cause.GRASP,)

    def test_obstacles_are_flowed_around(self):
        on_the_way = at(0.325, 0.125, 0.475)
        nearest = {}
        for avoid in (True, False):
            world = FakeWorld(cheese=on_the_way)
            config = ExecutionConfig(motion=MotionConfig(avoid=avoid))
            gaps = []
            outcome = run(
                world,
                atoms("door-open door cabinet"),
                replace(LIBRARY, extents={"food": (0.02, 0.02, 0.02)}),
                config,
                on_event=lambda line, world=world, gaps=gaps: gaps.append(np.linalg.norm(world.ee.p - on_the_way.p)),
            )
            assert outcome.success
            nearest[avoid] = min(gaps)
        assert nearest[False] < 0.03 < 0.06 < nearest[True]

    def test_a_hand_that_cannot_move_runs_out_of_time_and_of_plans(self):
        world = FakeWorld()
        world.frozen = True
        outcome = run(world, config=ExecutionConfig(max_replans=2, budget_margin_s=0.5, budget_factor=0.5, blocked_s=99.0))
        assert outcome.category is Category.REPLANS
        assert outcome.replans == 2
        assert verdicts(outcome) == ["OverTime"] * 3
        assert [s.attempt for s in outcome.steps] == [0, 1, 2]
        assert outcome.recoveries == ()
        assert "reach-closed-door" in outcome.reason
        assert (outcome.cause, outcome.troubles) == (Cause.TIMEOUT, (Cause.TIMEOUT,) * 3)

    def test_a_blocked_hand_goes_back_and_tries_again(self):
        world = FakeWorld(angle=1.5)
        free = world.step

        def walled(command):
            # a wall across the way, until somebody takes it away
            before = world.ee
            scene = free(command)
            if world.time < 4.0 and world.ee.p[1] < -0.25:
                world.ee = before
                scene = world.observe()
            return scene

        world.step = walled
        outcome = run(world)
        assert outcome.success
        assert verdicts(outcome)[0] == "Stalled"
        assert "blocked" in outcome.steps[0].reason
        # the next try begins where the motion was to pass
        assert outcome.recoveries == ("recover-retreat", "recover-approach")
        assert outcome.troubles == (Cause.MOTION,)

    def test_a_blocked_hand_that_holds_a_door_lets_go(self):
        world = FakeWorld()
        free = world.step

        def walled(command):
            before = world.ee
            scene = free(command)
            if world.on_door and world.angle > 0.6:
                world.ee = before
                scene = world.observe()
            return scene

        world.step = walled
        outcome = run(world, config=ExecutionConfig(max_replans=0))
        assert verdicts(outcome)[-1] == "Stalled"
        # going back along its path it would shut the door again
        assert outcome.recoveries == ("recover-open",)
        assert world.angle > 0.6
        assert not world.on_door

    def test_time_limit(self):
        world = FakeWorld()
        world.frozen = True
        outcome = run(world, config=ExecutionConfig(max_time_s=5.0, budget_margin_s=0.5, budget_factor=0.5, blocked_s=99.0))
        assert (outcome.category, outcome.cause) == (Category.TIME, Cause.TIMEOUT)

    def test_unreachable_goal_says_why(self):
        outcome = run(FakeWorld(), library=without(LIBRARY, "open-door"))
        assert (outcome.category, outcome.cause) == (Category.UNREACHABLE, Cause.PLANNING)
        assert not outcome.success
        assert "food-in-cabinet" in outcome.reason
        assert "door-open" in outcome.reason
        assert outcome.recoveries == ("recover-observe", "recover-retreat")

    def test_fingers_that_never_settle_are_waited_for_with_a_bound(self):
        world = FakeWorld(angle=1.5)
        outcome = run(
            world,
            on_step=when(world, "pick-from-counter", lambda: setattr(world, "stuck_fingers", True)),
            config=ExecutionConfig(max_replans=0),
        )
        # closed by command although they never rest, and nothing grasped
        assert outcome.category is Category.REPLANS
        assert outcome.time_s < 10

    def test_an_alternative_is_preferred_to_what_failed(self):
        costs = []

        class Spy(Builtin):
            def session(self, domain, objects):
                opened.append(objects)
                inner = super().session(domain, objects)

                class Session:
                    def solve(self, init, goal, limits, extra_costs):
                        costs.append(dict(extra_costs))
                        return inner.solve(init, goal, limits, extra_costs)

                return Session()

        opened = []
        world = FakeWorld(angle=1.5)
        world.slippery = 1
        execute(world, LIBRARY, LIBRARY.domain(), IN_CABINET, Spy(), objects=OBJECTS, rng=np.random.default_rng(0))
        assert costs[0] == {}
        assert costs[-1] == {("pick-from-counter", ("cheese", "counter")): 10.0}
        assert len(opened) == 1  # one session for the whole run

    @pytest.mark.parametrize("name", ["pyperplan", "kairos", "mimir"])
    def test_an_engine_without_costs_of_steps_tries_again_where_there_is_no_other_way(self, name):
        try:
            planner = get(name)
        except MissingDependencyError as error:
            pytest.skip(str(error))
        world, lines = FakeWorld(angle=1.5), []
        world.slippery = 1
        outcome = execute(
            world,
            LIBRARY,
            LIBRARY.domain(),
            IN_CABINET,
            planner,
            objects=OBJECTS,
            rng=np.random.default_rng(0),
            on_event=lines.append,
        )
        assert outcome.success
        again = [line for line in lines if line.event == "plan"][-1]
        assert any("so none was left out: (pick-from-counter cheese counter)" in m for m in again.messages)


class TestAssumptions:
    def test_a_door_left_ajar_is_taken_for_closed(self):
        world = FakeWorld(angle=0.7)
        outcome = run(world)
        assert outcome.success
        assert "recover-assume" in outcome.recoveries
        assert names(outcome) == ALL

    def test_an_assumption_does_not_satisfy_the_goal(self):
        world = FakeWorld(angle=1.1)
        outcome = run(world, atoms("door-open door cabinet"))
        assert outcome.success
        assert world.angle == pytest.approx(1.5, abs=0.15)
        assert names(outcome) == ["reach-closed-door", "open-door"]

    @pytest.mark.parametrize("extents", [{}, {"food": (0.02, 0.02, 0.02)}])
    def test_a_thing_that_fell_over_is_taken_by_another_face(self, extents):
        lying = Pose.from_rotvec(COUNTER + np.array([0.02, 0, 0.03]), [np.pi / 2, 0, 0])
        outcome = run(FakeWorld(cheese=lying, angle=1.5), library=replace(LIBRARY, extents=extents))
        assert outcome.success
        # without sizes it is only assumed to stand as things do, and the hand comes from the side
        assert ("recover-face" in outcome.recoveries) is bool(extents)
        assert ("recover-assume" in outcome.recoveries) is not bool(extents)

    def test_off(self):
        outcome = run(FakeWorld(angle=0.7), config=ExecutionConfig(assume=False))
        assert outcome.category is Category.UNREACHABLE

    def test_what_is_held_goes_back_when_there_is_no_other_way(self):
        # nobody has learned to put food on the counter
        world = FakeWorld(angle=1.5)
        library = without(LIBRARY, "place-on-counter")
        outcome = run(world, library=library, on_step=when(world, "place-in-cabinet", world.shut, 0.6))
        assert outcome.success
        assert "recover-return" in outcome.recoveries


class TestOpenLoop:
    def test_undisturbed(self):
        outcome = run(FakeWorld(), monitor=False)
        assert outcome.success
        assert names(outcome) == ALL

    def test_disturbed(self):
        world = FakeWorld(angle=1.5)
        outcome = run(world, monitor=False, on_step=when(world, "place-in-cabinet", world.drop, 0.2))
        assert outcome.category is Category.MISSED
        assert not outcome.success
        assert outcome.replans == 0
        assert "food-in-cabinet" in outcome.reason
        # the monitor is not obeyed, but it knows what went wrong first
        assert (outcome.cause, outcome.troubles) == (Cause.GRASP, (Cause.GRASP,))

    def test_time_is_bounded(self):
        world = FakeWorld()
        world.frozen = True
        outcome = run(world, monitor=False, config=ExecutionConfig(budget_margin_s=0.5, budget_factor=0.1))
        assert outcome.category is Category.MISSED
        assert outcome.time_s < 10

    def test_no_plan(self):
        assert run(FakeWorld(angle=0.7), monitor=False).category is Category.UNREACHABLE


class TestTrace:
    @pytest.mark.parametrize("case", ["plain", "drop", "shut", "slip", "ajar", "open loop"])
    def test_every_decision_can_be_replayed(self, tmp_path, case):
        world = FakeWorld(angle={"plain": 0.0, "ajar": 0.7}.get(case, 1.5))
        world.slippery = int(case == "slip")
        action = {"drop": world.drop, "shut": world.shut}.get(case)
        listener = when(world, "place-in-cabinet", action, 0.3) if action else None
        with TraceWriter(tmp_path / "trace.jsonl") as trace:
            outcome = run(world, trace=trace, on_step=listener, monitor=case != "open loop")
        assert outcome.success
        trace = read_trace(tmp_path / "trace.jsonl")
        again = replay(trace)
        decisions = len(trace.of("step")) + len(trace.of("tick"))
        assert len(again) == (0 if case == "open loop" else decisions)
        assert all(r.same for r in again)
        assert trace.outcome.success
        assert len(trace.of("plan")) == len(outcome.plan_seconds)
        assert tuple(r.name for r in trace.of("recovery")) == outcome.recoveries
        assert trace.header.goal == (("food-in-cabinet", "cheese", "cabinet"),)


class TestRefused:
    def test_an_operator_without_a_skill(self):
        library = replace(LIBRARY, skills={k: v for k, v in LIBRARY.skills.items() if k != "pick"})
        with pytest.raises(InputError, match="'pick-from-counter' needs the skill 'pick'"):
            run(FakeWorld(), library=library)

    def test_an_operator_the_library_does_not_have(self):
        library = without(LIBRARY, "open-door")
        with pytest.raises(InputError, match="unknown operator 'open-door'"):
            execute(FakeWorld(), library, LIBRARY.domain(), IN_CABINET, Builtin(), objects=OBJECTS, rng=np.random.default_rng(0))

    def test_an_atom_nothing_can_observe(self):
        library = replace(LIBRARY, classifiers=LIBRARY.classifiers[:-1])
        with pytest.raises(InputError, match="'door-open', which nothing can observe"):
            execute(FakeWorld(), library, LIBRARY.domain(), IN_CABINET, Builtin(), objects=OBJECTS, rng=np.random.default_rng(0))

    @pytest.mark.parametrize(
        ("goal", "message"),
        [
            ("food-in-cabinet bread cabinet", "unknown object 'bread'"),
            ("food-in-cabinet cheese", "is no atom"),
            ("food-in-sink cheese cabinet", "unknown predicate 'food-in-sink'"),
        ],
    )
    def test_goals(self, goal, message):
        with pytest.raises(InputError, match=message):
            run(FakeWorld(), atoms(goal))

    def test_an_object_the_scene_does_not_have(self):
        with pytest.raises(InputError, match="unknown object 'bread'"):
            execute(
                FakeWorld(),
                LIBRARY,
                LIBRARY.domain(),
                IN_CABINET,
                Builtin(),
                objects={**OBJECTS, "bread": "food"},
                rng=np.random.default_rng(0),
            )

    @pytest.mark.parametrize(
        ("setting", "message"),
        [
            ({"max_time_s": 0.0}, "max_time_s has to be positive"),
            ({"grace_s": -1.0}, "grace_s must not be negative"),
            ({"debounce_s": -0.1}, "debounce_s has to be at least 0"),
        ],
    )
    def test_settings(self, setting, message):
        with pytest.raises(InputError, match=message):
            ExecutionConfig(**setting)


def test_a_control_period_that_is_not_certified_is_refused_before_anything_moves():
    world = FakeWorld()
    world.period_s = 1.01 * LIBRARY.max_period_s
    with pytest.raises(InputError, match="skills are certified for periods below"):
        run(world)
    assert world.time == 0.0


def test_handle_is_where_the_door_says():
    assert np.allclose(handle(0.0).p, [0.45, 0.35, 0.5])
