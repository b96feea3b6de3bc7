"""Each mechanism of recovery switched off: what then no longer works, and what still does."""

from dataclasses import replace

import numpy as np
import pytest
from fake_world import CABINET, DOWN, OBJECTS, FakeWorld, at, atoms, make_library, phase

from symskill_pddl.execution.config import ExecutionConfig, MotionConfig
from symskill_pddl.execution.executor import execute
from symskill_pddl.execution.outcome import Category
from symskill_pddl.geometry import Pose
from symskill_pddl.planning import Builtin
from symskill_pddl.skills import Skill

LIBRARY = make_library()
IN_CABINET = atoms("food-in-cabinet cheese cabinet")
ON_COUNTER = atoms("food-on-counter cheese counter")


def run(world, goal=IN_CABINET, library=LIBRARY, config=None, **rest):
    lines = []
    outcome = execute(
        world,
        library,
        library.domain(),
        goal,
        Builtin(),
        config,
        objects=OBJECTS,
        rng=np.random.default_rng(0),
        on_event=lines.append,
        **rest,
    )
    return outcome, lines


def shut_while_placing(world):
    done = []

    def on_step(index, ground):
        if ground.name == "place-in-cabinet" and not done:
            done.append(index)
            world.after(0.3, world.shut)

    return on_step


class TestNoReplanning:
    @pytest.mark.parametrize("replan", [True, False])
    def test_a_door_shut_on_the_way_needs_a_new_plan(self, replan):
        world = FakeWorld(angle=1.5)
        outcome, lines = run(world, config=ExecutionConfig(replan=replan), on_step=shut_while_placing(world))
        assert outcome.success is replan
        assert (len([line for line in lines if line.event == "plan"]) > 1) is replan
        if not replan:
            assert outcome.category is Category.MISSED
            assert outcome.replans == 0
            assert "the only plan was left" in outcome.reason
            assert "door-open" in outcome.reason

    def test_a_step_that_failed_is_tried_again_resampled(self):
        world = FakeWorld(angle=1.5)
        world.slippery = 1
        outcome, lines = run(world, config=ExecutionConfig(replan=False))
        assert outcome.success
        assert [s.attempt for s in outcome.steps if "pick" in s.step] == [0, 1]
        assert len([line for line in lines if line.event == "plan"]) == 1

    def test_it_is_not_tried_for_ever(self):
        world = FakeWorld()
        world.frozen = True
        config = ExecutionConfig(replan=False, max_replans=3, budget_margin_s=0.5, budget_factor=0.1, blocked_s=99.0)
        outcome, _ = run(world, config=config)
        assert outcome.category is Category.MISSED
        assert [s.attempt for s in outcome.steps] == [0, 1, 2, 3]

    def test_a_first_plan_is_still_looked_for(self):
        outcome, _ = run(FakeWorld(angle=0.7), config=ExecutionConfig(replan=False))
        assert outcome.success
        assert "recover-assume" in outcome.recoveries


class TestNoResampling:
    @pytest.mark.parametrize("resample", [True, False])
    def test_a_goal_that_is_off_needs_samples(self, resample):
        # the field's goal is 17 cm off; samples of the effect predicate are where the food has to be
        off = Skill(
            (phase("?counter", Pose([0.17, 0, 0.03], DOWN), True), phase("?counter", Pose([0.17, 0, 0.2], DOWN), False)), False
        )
        library = replace(LIBRARY, skills={**LIBRARY.skills, "place-counter": off})
        world = FakeWorld(cheese=Pose(CABINET + np.array([0, 0, 0.05]), [1.0, 0, 0, 0]), angle=1.5)
        outcome, lines = run(world, ON_COUNTER, library, ExecutionConfig(resample=resample, max_replans=5))
        assert outcome.success is resample
        steps = [line for line in lines if line.event == "step"]
        assert any(s.attempt > 0 for s in steps)
        assert any(s.shift is not None for s in steps) is resample


class TestNoObstacles:
    @pytest.mark.parametrize("avoid", [True, False])
    def test_the_hand_goes_around_or_through(self, avoid):
        on_the_way = at(0.325, 0.125, 0.475)
        world = FakeWorld(cheese=on_the_way)
        library = replace(LIBRARY, extents={"food": (0.02, 0.02, 0.02)})
        gaps = []
        free = world.step

        def step(command):
            scene = free(command)
            gaps.append(np.linalg.norm(world.ee.p - on_the_way.p))
            return scene

        world.step = step
        outcome, _ = run(world, atoms("door-open door cabinet"), library, ExecutionConfig(motion=MotionConfig(avoid=avoid)))
        assert outcome.success
        assert min(gaps) > 0.06 if avoid else min(gaps) < 0.03


def test_the_header_says_what_was_switched_off():
    config = ExecutionConfig(resample=False, replan=False, motion=MotionConfig(avoid=False))
    _, (header, *_) = run(FakeWorld(), config=config)
    assert (header.resampling, header.replanning, header.obstacles) == (False, False, False)
    _, (header, *_) = run(FakeWorld())
    assert (header.resampling, header.replanning, header.obstacles) == (True, True, True)


class TestNoTracking:
    @pytest.mark.parametrize("track", [True, False])
    def test_a_thing_that_is_moved_is_followed_by_the_field_alone(self, track):
        world, done = FakeWorld(angle=1.5), []

        def move():
            world.cheese = at(*(world.cheese.p + np.array([0.06, -0.05, 0.0])))

        def on_step(index, ground):
            if ground.name == "pick-from-counter" and not done:
                done.append(index)
                world.after(0.3, move)

        outcome, lines = run(world, config=ExecutionConfig(motion=MotionConfig(track=track)), on_step=on_step)
        # without it the grasp misses, and planning again makes up for it
        assert outcome.success
        assert (outcome.replans == 0) is track
        assert lines[0].tracking is track
