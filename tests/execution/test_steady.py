"""Jitter is averaged out, motion is not, and what does not jitter passes as it is."""

import numpy as np
from fake_world import FakeWorld, at

from symskill_pddl.execution.steady import Steady
from symskill_pddl.geometry import Pose, quat_exp, quat_multiply, rotation_distance
from symskill_pddl.scene import Scene

ROW = 0  # the cheese


def scenes(n, speed=0.0, sd=0.0, start=40):
    """The cheese stands, and from `start` on moves along y; readings with errors of `sd` [m] and as many tenths of a radian."""
    rng = np.random.default_rng(0)
    for i in range(n):
        world = FakeWorld(cheese=at(0.4, speed * 0.05 * max(0, i - start), 0.03))
        scene = world.observe()
        T = scene.T_world_objects
        p, q = T.p + sd * rng.standard_normal(T.p.shape), quat_multiply(T.q, quat_exp(10 * sd * rng.standard_normal(T.p.shape)))
        yield T, Scene(i * 0.05, scene.T_world_ee, 0.08, False, scene.objects, Pose(p, q) if sd else T)


def steadied(n, **how):
    steady, found = None, []
    for truth, scene in scenes(n, **how):
        steady = steady or Steady(scene)
        found.append((truth, scene, steady(scene)))
    return found


def test_without_noise_nothing_changes():
    for _, scene, seen in steadied(80, speed=0.3):
        assert seen is scene


def test_what_stands_still_is_averaged():
    end = steadied(40, sd=0.005)[-20:]
    raw = np.array([scene.T_world_objects.p - truth.p for truth, scene, _ in end])
    left = np.array([seen.T_world_objects.p - truth.p for truth, _, seen in end])
    assert np.std(left) < 0.5 * np.std(raw)
    turned = [rotation_distance(seen.T_world_objects, truth) for truth, _, seen in end]
    assert np.mean(turned) < 0.5 * np.mean([rotation_distance(scene.T_world_objects, truth) for truth, scene, _ in end])


def test_what_moves_is_followed():
    for truth, _, seen in steadied(100, speed=0.3, sd=0.005)[45:]:
        assert abs(seen.T_world_objects.p[ROW, 1] - truth.p[ROW, 1]) < 0.035
