"""What the hand flows around: with its tip, or with all of it."""

from dataclasses import replace

import numpy as np
import pytest
from fake_world import DOWN, OBJECTS, FakeWorld
from hypothesis import given, settings
from hypothesis import strategies as st

from symskill_pddl.execution.around import Obstacles, Strangers, around_hand
from symskill_pddl.execution.config import MotionConfig
from symskill_pddl.geometry import Pose
from symskill_pddl.scene import Scene
from symskill_pddl.skills import Superellipsoids, modulate

CONFIG = MotionConfig()
WIDTH, LENGTH = CONFIG.hand


def one(T_world: Pose, radii: np.ndarray, hand: Pose) -> Superellipsoids:
    T, wide, power = around_hand(Pose.stack([T_world]), radii[None], hand, CONFIG.hand)
    return Superellipsoids(T, wide, np.zeros((1, 3)), power)


def test_obstacles_are_the_small_things_one_has_nothing_to_do_with():
    scene: Scene = FakeWorld().observe()
    extents = {"food": (0.03, 0.02, 0.02), "door": (0.2, 0.01, 0.2), "counter": (0.1, 0.1, 0.1)}
    found = Obstacles(OBJECTS, extents, frozenset({"counter"}), CONFIG)(scene)
    assert len(found) == 1
    assert np.allclose(found.T_world.p, scene.pose("cheese").p)
    assert np.all(found.radii > np.array(extents["food"]) + CONFIG.obstacle_clearance)
    assert np.all(found.velocity == 0)
    assert len(Obstacles(OBJECTS, extents, frozenset(OBJECTS), CONFIG)(scene)) == 0
    velocities = np.array([[0.1, 0, 0], *np.zeros((3, 3))])
    moving = Obstacles(OBJECTS, extents, frozenset({"counter"}), CONFIG, lambda: velocities)(scene)
    assert np.allclose(moving.velocity, [[0.1, 0, 0]])


def test_around_a_strange_thing_the_whole_hand_counts():
    scene = FakeWorld(ee=Pose([0.4, -0.4, 0.3], DOWN)).observe()
    extents = {"food": (0.02, 0.02, 0.02)}
    # beside the wrist: 10 cm above the finger tips, to the side along the opening of the fingers
    y = scene.T_world_ee.rotate(np.array([0, 1.0, 0]))

    def level(aside: float, kind: type[Obstacles]) -> float:
        things = Pose.stack([Pose(scene.T_world_ee.p + [0, 0, 0.1] + aside * y, [1.0, 0, 0, 0])] * 4)
        return float(
            kind(OBJECTS, extents, frozenset(), CONFIG)(replace(scene, T_world_objects=things)).levels([0.4, -0.4, 0.3])[0]
        )

    reach = 1.3 * 0.02 + CONFIG.obstacle_clearance
    assert level(WIDTH / 2 + 0.8 * reach, Strangers) < 1.0 < level(WIDTH / 2 + 1.1 * reach, Strangers)
    assert level(WIDTH / 2 + 0.8 * reach, Obstacles) > 1.5
    assert len(Strangers(OBJECTS, extents, frozenset(OBJECTS), CONFIG)(scene)) == 0


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 10**6), ball=st.booleans())
def test_the_whole_hand_is_outside_where_its_tip_is(seed, ball):
    rng = np.random.default_rng(seed)
    T_world, hand = Pose(rng.normal(size=3), rng.normal(size=4)), Pose(rng.normal(size=3), rng.normal(size=4))
    radii = np.full(3, rng.uniform(0.02, 0.3)) if ball else rng.uniform(0.02, 0.3, 3)
    obstacle = one(T_world, radii, hand)
    # where a point of the hand touches a point of the ellipsoid, the tip is not outside
    u = rng.normal(size=(200, 3))
    touched = T_world.apply(radii * u / np.linalg.norm(u, axis=1, keepdims=True))
    edge = rng.choice([-1.0, 0.0, 1.0], (200, 1))
    points = np.concatenate([np.zeros((200, 1)), edge * WIDTH / 2, -rng.choice([0.0, 0.5, 1.0], (200, 1)) * LENGTH], axis=1)
    assert max(obstacle.levels(tip)[0] for tip in touched - hand.rotate(points)) <= 1.0 + 1e-9
    # and it is no wider than it has to be along its axes
    if ball:
        assert np.all(obstacle.radii[0] <= 1.03 * (radii + np.array([0.0, WIDTH / 2, LENGTH / 2])))


def test_levels_of_many_hands_are_those_of_each():
    rng = np.random.default_rng(0)
    scene = FakeWorld().observe()
    extents = {"food": (0.02, 0.03, 0.02), "counter": (0.1, 0.1, 0.1)}
    strangers = Strangers(OBJECTS, extents, frozenset(), CONFIG)
    hands = Pose(rng.normal(size=(20, 3)), rng.normal(size=(20, 4)))
    each = [strangers(replace(scene, T_world_ee=hand)).levels(hand.p).min() for hand in hands]
    assert strangers.levels(scene, hands) == pytest.approx(each)
    base = Pose(rng.normal(size=3), rng.normal(size=4))
    assert strangers.levels(scene, base.inverse() @ hands, base) == pytest.approx(each)
    assert np.all(np.isinf(Strangers(OBJECTS, {}, frozenset(), CONFIG).levels(scene, hands)))


@pytest.mark.parametrize("radii", [(0.09, 0.09, 0.09), (0.05, 0.05, 0.05), (0.12, 0.05, 0.07)])
def test_no_pit_in_front_of_the_flat_side_of_a_hand(radii):
    # the hand looks down and meets the obstacle with the flat of it; from there, and from all around, it arrives behind
    rng = np.random.default_rng(0)
    obstacle = one(Pose([0.4, 0.0, 0.2], rng.normal(size=4)), np.array(radii), Pose(np.zeros(3), DOWN))
    goal, centre = np.zeros(3), obstacle.T_world.p[0]
    u = rng.normal(size=(300, 3))
    x = np.concatenate(
        [[2.0 * centre, centre + np.array([0.25, 0, 0])], centre + 0.35 * u / np.linalg.norm(u, axis=1, keepdims=True)]
    )
    assert min(obstacle.levels(p)[0] for p in (goal, *x)) > 1.0
    for _ in range(600):
        away = goal - x
        v = 3.0 * away * np.minimum(1.0, 0.2 / np.maximum(3.0 * np.linalg.norm(away, axis=1, keepdims=True), 1e-12))
        x = x + 0.05 * modulate(v, x, obstacle, locality=8.0)
        assert np.all(obstacle.levels(x[0]) >= 1.0 - 1e-9)
    assert np.linalg.norm(x - goal, axis=1).max() < 1e-3
