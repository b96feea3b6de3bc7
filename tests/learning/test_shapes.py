import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symskill_pddl.geometry import Pose, quat_exp, quat_multiply
from symskill_pddl.learning.shapes import ShapeConfig, clusters, fit_shape, free_yaw, narrowed
from symskill_pddl.symbols import Predicate

UP = np.array([0.0, 0.0, 1.0])


def distances(values):
    values = np.asarray(values, float)
    return np.abs(values[:, None] - values[None])


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([1.0], [0]),
        ([0, 51, 95], [0, 1, 2]),
        ([0, 1, 50, 52, 95, 99, 92], [0, 0, 1, 1, 2, 2, 2]),
        ([75, 80, 84, 90, 95, 100, 51, 49], [0, 0, 0, 0, 0, 0, 1, 1]),
        ([0, 6, 11, 18, 25], [0, 0, 0, 0, 0]),
        ([3, 3, 3], [0, 0, 0]),
    ],
)
def test_clusters_are_cut_at_clear_gaps(values, expected):
    assert clusters(distances(values), 12, 2.5, 2).tolist() == expected


FEW = [0, 0, 50, 51, 84, 100]
"""A door's angles in two demonstrations: shut, half open and open, with no gap that is clear by itself."""


@pytest.mark.parametrize(
    ("apart", "expected"),
    [
        ([], [0, 0, 0, 0, 0, 0]),
        ([(0, 2), (3, 5), (4, 2), (3, 1)], [0, 0, 1, 1, 2, 2]),
        # too near each other to be a witness: a nudge
        ([(2, 3)], [0, 0, 0, 0, 0, 0]),
        # one odd pair in ten is no reason to cut lower
        ([(0, 2)] * 10 + [(4, 5)], [0, 0, 1, 1, 1, 1]),
    ],
)
def test_where_a_motion_began_and_ended_are_two_places(apart, expected):
    assert clusters(distances(FEW), 18, 2.5, 2, apart).tolist() == expected


@given(st.lists(st.floats(-200, 200), min_size=1, max_size=12), st.randoms())
def test_clusters_do_not_depend_on_the_order(values, random):
    order = list(range(len(values)))
    random.shuffle(order)
    a = clusters(distances(values), 12, 2.5, 2)
    b = clusters(distances([values[i] for i in order]), 12, 2.5, 2)
    same_a = a[order][:, None] == a[order][None]
    assert np.array_equal(same_a, b[:, None] == b[None])


@settings(max_examples=30)
@given(st.integers(1, 15), st.integers(0, 1000), st.floats(0.001, 0.2), st.floats(0.0, 0.4))
def test_a_shape_holds_what_it_is_made_from(n, seed, spread, turn):
    rng = np.random.default_rng(seed)
    base = Pose.from_rotvec(rng.normal(size=3), np.pi * np.array([0.6, 0.0, 0.8]))  # half a turn: nothing may wrap
    small = Pose.from_rotvec(rng.normal(0, spread, (n, 3)), rng.normal(0, turn, (n, 3)))
    poses = Pose(base.p + small.p, quat_multiply(base.q, small.q))
    flipped = Pose(poses.p, poses.q * np.where(rng.random(n) < 0.5, -1, 1)[:, None])
    shape = fit_shape(flipped, n, ShapeConfig())
    classifier = shape.classifier(Predicate("p", ("a", "b")), "a", "b")
    assert (classifier.margin(poses) >= 0).all()


def test_few_observations_give_wider_shapes():
    rng = np.random.default_rng(0)
    poses = Pose(rng.normal(0, 0.002, (20, 3)), np.tile([1.0, 0, 0, 0], (20, 1)))
    reach = [
        np.sqrt(fit_shape(poses[:n], n, ShapeConfig()).cov_p[0, 0]) * fit_shape(poses[:n], n, ShapeConfig()).enter_p
        for n in (1, 5, 20)
    ]
    assert reach[0] > 1.5 * reach[1] > 1.5 * reach[2]
    assert reach[0] < 0.2


def test_heights_are_taken_more_exactly_than_places():
    shape = fit_shape(Pose(np.zeros((1, 3)), np.array([[1.0, 0, 0, 0]])), 1, ShapeConfig(), up_in_parent=UP)
    assert shape.cov_p[2, 2] < 0.25 * shape.cov_p[0, 0]


def test_yaw_is_free_where_it_spreads():
    angles = np.linspace(-3, 3, 9)
    spread = Pose.from_rotvec(np.zeros((9, 3)), np.outer(angles, UP))
    tight = Pose.from_rotvec(np.zeros((9, 3)), np.outer(0.1 * angles, UP))
    assert free_yaw(spread, UP, ShapeConfig()) is not None
    assert free_yaw(tight, UP, ShapeConfig()) is None
    assert free_yaw(tight[:2], UP, ShapeConfig()) is not None  # two say nothing about it
    shape = fit_shape(spread, 9, ShapeConfig(), UP)
    classifier = shape.classifier(Predicate("p", ("a", "b")), "a", "b")
    tilt = quat_exp(np.array([0.9, 0.0, 0.0]))
    assert classifier.margin(Pose.from_rotvec(np.zeros(3), 2.2 * UP)) > 0.5
    assert classifier.margin(Pose(np.zeros(3), quat_multiply(quat_exp(1.0 * UP), tilt))) < 0


def test_a_rival_is_kept_out_but_no_observation():
    poses = Pose(np.linspace(-0.03, 0.03, 5)[:, None] * [1.0, 0, 0], np.tile([1.0, 0, 0, 0], (5, 1)))
    shape = fit_shape(poses, 5, ShapeConfig())
    rival = Pose(np.array([3.5 * np.sqrt(shape.cov_p[0, 0]), 0.0, 0.0]), np.array([1.0, 0, 0, 0]))
    before, after = (s.classifier(Predicate("p", ("a", "b")), "a", "b") for s in (shape, narrowed(shape, rival)))
    assert before.margin(rival) > 0
    assert after.margin(rival) < 0
    assert (after.margin(poses) >= 0).all()
