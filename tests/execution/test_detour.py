"""Around what was never shown, back to the shown way, or waiting in front of it."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from compiled import forms
from fake_world import COUNTER, DOWN, HOME, OBJECTS, FakeWorld, atoms, make_library
from scipy.ndimage import gaussian_filter1d

from symskill_pddl.execution.around import Obstacles, Strangers
from symskill_pddl.execution.config import MotionConfig
from symskill_pddl.execution.executor import execute
from symskill_pddl.execution.runner import SkillRun
from symskill_pddl.geometry import Array, Pose, quat_multiply
from symskill_pddl.planning import Builtin
from symskill_pddl.scene import Scene
from symskill_pddl.skills import FitConfig, OrientationField, Phase, PositionField, Skill, Trajectory, rollout, warm
from symskill_pddl.skills.field import Field, fit_field
from symskill_pddl.skills.lpv import Lpv
from symskill_pddl.skills.mixture import Mixture
from symskill_pddl.skills.pairing import Pairing

CONFIG = MotionConfig()
PERIOD = 0.05
AWAY = np.array([0.0, 0.0, 9.0])
START = np.array([0.0, 0.0, -0.5])


@pytest.fixture(scope="module")
def field() -> Field:
    """Half a metre up, then as far ahead to the origin: the corner is what keeps the hand out of something."""
    rng = np.random.default_rng(0)
    shown = []
    for _ in range(3):
        corners = np.array([START, [0, 0, 0], [0.5, 0, 0]]) - [0.5, 0, 0] + rng.normal(0, 0.005, (3, 3))
        t = np.linspace(0.0, 1.0, 60)[:, None]
        x = gaussian_filter1d(np.concatenate([a + (b - a) * t for a, b in pairwise(corners)]), 4, axis=0, mode="nearest")
        shown.append(Trajectory(PERIOD * np.arange(len(x)), Pose(x, np.tile(DOWN, (len(x), 1)))))
    return fit_field(shown, FitConfig())


class Hand:
    """Goes where it is told, through everything but `walls`; one strange ball is where `ball` says."""

    def __init__(self, field: Field, ball, walls=lambda before, after: after) -> None:
        self.field, self.ball, self.walls = field, np.asarray(ball, float), walls
        self.ee, self.time = Pose(START - [0.5, 0, 0], DOWN), 0.0
        objects, extents = {"place": "place", "ball": "ball"}, {"ball": (0.04, 0.04, 0.04)}
        self.strangers = Strangers(objects, extents, frozenset(), CONFIG)
        skill = Skill((Phase("?place", field, False, 0.01, 0.1, 6.0),), False)
        known = Obstacles(objects, {}, frozenset(), CONFIG)
        self.run = SkillRun(skill, {"?place": "place"}, self.scene, CONFIG, obstacles=known, strange=self.strangers)
        self.way = rollout(field, Pose.stack([self.ee]), 12.0, PERIOD)[0].p

    @property
    def scene(self) -> Scene:
        poses = Pose(np.array([np.zeros(3), self.ball]), np.tile([1.0, 0, 0, 0], (2, 1)))
        return Scene(self.time, self.ee, 0.08, False, {"place": "place", "ball": "ball"}, poses)

    def drive(self, seconds: float) -> tuple[Array, Array, list[float]]:
        """Tips (n, 3), levels of the hand (n,), and how long the monitor is told that it rests."""
        tips, levels, rests = [], [], []
        for _ in range(round(seconds / PERIOD)):
            motion = self.run.tick(self.scene)
            if motion.stage == 1:
                break
            v, w = motion.command.twist[:3], motion.command.twist[3:]
            turn = Pose.from_rotvec(np.zeros(3), PERIOD * w)
            p = self.walls(self.ee.p, self.ee.p + PERIOD * v)
            self.ee, self.time = Pose(p, quat_multiply(turn.q, self.ee.q)), round(self.time + PERIOD, 9)
            tips.append(self.ee.p)
            levels.append(float(self.strangers.levels(self.scene, Pose.stack([self.ee]))[0]))
            rests.append(motion.rest_s)
        return np.array(tips), np.array(levels), rests

    def off(self, tips: Array) -> Array:
        """Distances (n,) from the way [m]."""
        return np.linalg.norm(tips[:, None] - self.way, axis=-1).min(1)

    @property
    def arrived(self) -> bool:
        return self.run.stage == 1


def test_nothing_in_the_way_changes_nothing(field):
    hand = Hand(field, AWAY)
    tips, _, _ = hand.drive(12.0)
    assert hand.arrived
    assert hand.off(tips).max() < 0.002


@pytest.mark.parametrize("ball", [(-0.5, 0.0, -0.1), (-0.48, 0.03, -0.15), (-0.3, 0.02, 0.05)])
def test_around_what_stands_on_the_way_and_back_to_it(field, ball):
    hand = Hand(field, ball)
    tips, levels, _ = hand.drive(20.0)
    assert hand.arrived
    assert levels.min() >= 1.0 - 1e-6
    assert hand.off(tips).max() > 0.05
    # where the way is free it is followed: before the obstacle, and behind it up to the goal
    assert hand.off(tips[:4]).max() < 0.02
    assert hand.off(tips[-10:]).max() < 0.025


def test_what_stands_on_the_goal_is_waited_for_and_the_way_is_kept(field):
    hand = Hand(field, [0.0, 0.0, 0.05])
    before, levels, rests = hand.drive(15.0)
    assert not hand.arrived
    assert levels.min() >= 1.0 - 1e-6
    assert np.linalg.norm(before[-20:] - before[-1], axis=1).max() < 0.005
    # this is no hand that is blocked
    assert max(rests) < 1.0
    hand.ball = AWAY
    after, _, rests = hand.drive(10.0)
    assert hand.arrived
    assert max(hand.off(before).max(), hand.off(after).max()) < 0.03
    assert max(rests) < 1.0


def test_what_comes_upon_the_hand_pushes_it_only_as_far_as_it_must(field):
    hand = Hand(field, AWAY)
    while hand.ee.p[0] < -0.1:
        hand.drive(PERIOD)
    left = hand.ee.p
    # the goal is in it as well: there is nothing to go around for
    hand.ball = np.array([-0.05, 0.02, 0.05])
    tips, levels, _ = hand.drive(3.0)
    assert levels[0] < 1.0
    assert levels[round(1.0 / PERIOD) :].min() >= 1.0 - 1e-6
    assert levels.max() < 1.1
    assert np.linalg.norm(tips[-20:] - tips[-1], axis=1).max() < 1e-6
    hand.ball = AWAY
    tips, _, _ = hand.drive(12.0)
    assert hand.arrived
    assert np.linalg.norm(tips - left, axis=1).min() < 0.025


def test_a_hand_that_cannot_go_around_goes_back_and_waits(field):
    # what nobody told of: the hand cannot go aside, and the way beneath the ball is too low for it
    hand = Hand(field, [-0.5, 0.0, -0.1], walls=lambda before, after: after * [0, 0, 1] + before * [1, 1, 0])
    tips, levels, rests = hand.drive(12.0)
    assert not hand.arrived
    assert levels.min() >= 1.0 - 1e-6
    assert np.linalg.norm(tips[-20:] - tips[-1], axis=1).max() < 0.005
    assert max(rests) < CONFIG.rest_s + 2.0
    hand.ball, hand.walls = AWAY, lambda before, after: after
    tips, _, _ = hand.drive(12.0)
    assert hand.arrived
    assert hand.off(tips).max() < 0.03


class Littered(FakeWorld):
    """With a ball of a type that nobody knows between the hand and the cheese."""

    def observe(self) -> Scene:
        scene = super().observe()
        objects, ball = {**OBJECTS, "ball": "ball"}, 0.5 * (HOME.p + scene.pose("cheese").p)
        poses = Pose.stack([*scene.T_world_objects, Pose(ball, [1.0, 0, 0, 0])])
        return replace(scene, objects=objects, T_world_objects=poses)


def pulls_to(goal: Pose) -> Field:
    """Straight to the goal, compiled as a learned field is, in an unusual memory layout."""
    lpv = Lpv(Mixture.single(), np.asfortranarray(-3.0 * np.eye(3)[None]), np.array([0.5]))
    return Field(PositionField(lpv, goal.p), OrientationField(lpv, goal.q), np.eye(3), Pairing.none())


def test_a_run_with_something_strange_in_the_way_compiles_nothing():
    library = make_library()
    skills = {
        name: replace(skill, phases=tuple(replace(p, field=pulls_to(p.field.T_goal)) for p in skill.phases))
        for name, skill in library.skills.items()
    }
    library, told = replace(library, skills=skills), {"rng": np.random.default_rng(0), "objects": OBJECTS}
    told |= {"goal": atoms("gripper-holds-food cheese"), "extents": {"ball": (0.03, 0.03, 0.03)}}
    warm()
    before, world, tips = forms(), Littered(), []
    outcome = execute(world, library, library.domain(), planner=Builtin(), **told, on_event=lambda _: tips.append(world.ee.p))
    assert forms() == before
    assert outcome.success
    # it was a detour: the straight way leads through the ball
    along = (COUNTER - HOME.p) / np.linalg.norm(COUNTER - HOME.p)
    off = np.array(tips) - HOME.p
    assert np.linalg.norm(off - np.outer(off @ along, along), axis=1).max() > 0.05
