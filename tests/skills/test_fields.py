"""The checklist for fields: attractor, equivariance, double cover, angle pi, far field, speed cap, odd data, units."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symskill_pddl.errors import CertificateError, InputError
from symskill_pddl.geometry import Pose, quat_exp, quat_log, quat_multiply
from symskill_pddl.skills import Field, FitConfig, OrientationField, Trajectory, fit_fields, rollout
from symskill_pddl.skills.field import fit_field
from symskill_pddl.skills.lpv import Lpv, attraction
from symskill_pddl.skills.mixture import Mixture
from symskill_pddl.skills.pairing import SLOWEST
from symskill_pddl.skills.position import fit_position
from symskill_pddl.skills.stability import certify

from .conftest import reach

SEEDS = st.integers(0, 10**6)


def random_poses(seed: int, n: int, spread: float = 0.5) -> Pose:
    rng = np.random.default_rng(seed)
    return Pose(rng.normal(0, spread, (n, 3)), rng.normal(size=(n, 4)))


def test_attractor_is_exact(field: Field, reaches):
    assert np.array_equal(field.twist(field.T_goal), np.zeros(6))
    assert np.allclose(field.T_goal.p, np.mean([t.end.p for t in reaches], axis=0), atol=1e-12)


def test_one_and_many_poses_agree(field: Field):
    T = random_poses(0, 50)
    many = field.twist(T)
    assert many.shape == (50, 6)
    for i in range(50):
        assert np.allclose(field.twist(T[i]), many[i], rtol=1e-12, atol=1e-12)


def test_both_signs_of_a_quaternion_give_the_same(field: Field):
    T = random_poses(1, 100)
    for q in T.q:
        assert np.array_equal(field.orientation.angular_velocity(q), field.orientation.angular_velocity(-q))
    assert np.array_equal(field.orientation.angular_velocity(T.q), field.orientation.angular_velocity(-T.q))


def test_defined_at_half_a_turn_and_at_the_goal(field: Field):
    goal = field.orientation.goal
    for axis in np.vstack([np.eye(3), -np.eye(3), [[0.6, 0.8, 0]]]):
        q = quat_multiply(np.concatenate([[0.0], axis]), goal)
        omega = field.orientation.angular_velocity(q)
        assert np.all(np.isfinite(omega))
        assert np.linalg.norm(omega) > 0.1
        assert np.array_equal(omega, field.orientation.angular_velocity(-q))
    assert np.array_equal(field.orientation.angular_velocity(goal), np.zeros(3))
    assert np.array_equal(field.orientation.angular_velocity(-goal), np.zeros(3))
    assert np.allclose(
        OrientationField(field.orientation.lpv, np.array([1.0, 0, 0, 0])).error(np.array([0, 0, 0, -1.0])), [0, 0, np.pi]
    )


def test_far_away_it_is_finite_and_leads_home(field: Field):
    x = field.position.goal + 1e6 * np.random.default_rng(2).normal(size=(50, 3))
    v = field.position.velocity(x)
    assert np.all(np.isfinite(v))
    P = field.P
    assert np.all(np.einsum("ni,ij,nj->n", v, P, x - field.position.goal) < 0)


@settings(max_examples=50, deadline=None)
@given(seed=SEEDS)
def test_both_distances_fall_everywhere(field: Field, seed: int):
    T = random_poses(seed, 20, 1.0)
    twist = field.twist(T)
    e, r = T.p - field.position.goal, field.orientation.error(T.q)
    assert np.all(np.einsum("ni,ij,nj->n", twist[:, :3], field.P, e) < 0)
    assert np.all(np.einsum("ni,ni->n", twist[:, 3:], r) < 0)


@settings(max_examples=6, deadline=None)
@given(seed=SEEDS)
def test_explicit_euler_is_stable_from_any_start(field: Field, seed: int):
    way = rollout(field, random_poses(seed, 20, 0.4), 50.0, 0.05)
    P = field.P
    e = way.p - field.position.goal
    distance = np.sqrt(np.einsum("nti,ij,ntj->nt", e, P, e))
    angle = np.linalg.norm(field.orientation.error(way.q), axis=-1)
    assert np.all(np.diff(distance, axis=1) <= 1e-12)
    assert np.all(np.diff(angle, axis=1) <= 1e-9)
    assert distance[:, -1].max() < 1e-3
    assert angle[:, -1].max() < 1e-3


def test_speed_cap_scales_and_never_turns(field: Field):
    T = random_poses(3, 200, 1.0)
    lpv = field.position.lpv
    free = Lpv(lpv.mixture, lpv.matrices, np.full(lpv.pace.shape, 1e9))
    e = T.p - field.position.goal
    capped, uncapped = lpv.velocity(e), free.velocity(e)
    speed = np.linalg.norm(capped, axis=1)
    assert speed.max() <= field.position.max_speed * (1 + 1e-12)
    assert np.all(speed <= np.linalg.norm(uncapped, axis=1) * (1 + 1e-12))
    cosine = np.einsum("ni,ni->n", capped, uncapped) / speed / np.linalg.norm(uncapped, axis=1)
    assert np.allclose(cosine, 1.0, atol=1e-12)


def test_as_fast_as_shown_and_not_slower_at_the_end(field: Field, reaches):
    for t in reaches:
        way = rollout(field, t.T_frame_ee[[0]], 1.5 * t.duration_s, 0.05)[0]
        assert np.linalg.norm(way.p[-1] - field.position.goal) < 0.005
        assert np.linalg.norm(field.orientation.error(way.q[-1])) < 0.05
        assert np.linalg.norm(way.p[int(0.4 * t.duration_s / 0.05)] - field.position.goal) > 0.05


def test_turning_keeps_step_with_moving():
    # a door handle on an arc: the rotation belongs to the position all the way
    th = 1.4 * np.linspace(0, 1, 120)
    x = 0.35 * np.stack([np.cos(th), np.sin(th), 0 * th], 1)
    t = Trajectory(0.05 * np.arange(120), Pose.from_rotvec(x, np.stack([0 * th, 0 * th, th], 1)))
    (field,) = fit_fields([t], replace(FitConfig(), max_stray_m=np.inf))
    way = rollout(field, t.T_frame_ee[[0]], 12.0, 0.05)[0]
    assert np.abs(np.linalg.norm(way.p, axis=1) - 0.35).max() < 0.01
    assert np.abs(np.arctan2(way.p[:, 1], way.p[:, 0]) - way.rotvec()[:, 2]).max() < np.radians(4)


def test_fitting_in_a_moved_frame_moves_the_field(field: Field, reaches):
    G = Pose.from_rotvec([0.3, -1.0, 0.5], [0.4, -1.1, 0.9])
    moved = fit_field([Trajectory(t.times, G @ t.T_frame_ee) for t in reaches], FitConfig())
    plain = fit_field(reaches, FitConfig())
    way = rollout(plain, reaches[0].T_frame_ee[[0]], 5.0, 0.05)
    other = rollout(moved, G @ reaches[0].T_frame_ee[[0]], 5.0, 0.05)
    assert np.abs((G @ way).p - other.p).max() < 1e-3


def test_centimetres_and_metres_give_the_same_motion(reaches):
    large = [Trajectory(t.times, Pose(100 * t.T_frame_ee.p, t.T_frame_ee.q)) for t in reaches]
    config = FitConfig()
    one, _ = fit_position(reaches, np.zeros(3), config)
    two, P = fit_position(large, np.zeros(3), replace(config, min_motion_m=0.1, min_speed_m_s=5.0))
    three, _ = fit_position(large, np.zeros(3), config)
    x = np.random.default_rng(0).normal(0, 0.3, (100, 3))
    assert np.allclose(100 * one.velocity(x), two.velocity(100 * x), rtol=1e-5, atol=1e-7)
    # the path is the same without any setting being told of the units
    assert np.allclose(one.lpv.matrices, three.lpv.matrices, atol=1e-6)
    certify(two.lpv.matrices, P).demand(config.rate_hz, config.period_s, slack=1e-4)


def test_same_data_same_bits(reaches):
    one, two = fit_field(reaches, FitConfig()), fit_field(reaches, FitConfig())
    T = random_poses(5, 20)
    assert np.array_equal(one.twist(T), two.twist(T))


LINE = np.linspace(0.3, 0.0, 40)[:, None] * np.array([1.0, 2.0, 0.0])
FLAT = np.tile([1.0, 0.0, 0, 0], (40, 1))


@pytest.mark.parametrize(
    "T",
    [
        Pose(LINE, FLAT),  # collinear, constant orientation
        Pose(np.tile([0.1, 0.2, 0.3], (40, 1)), FLAT),  # stationary
        Pose(np.repeat(LINE[::2], 2, axis=0), FLAT),  # duplicates
        Pose(LINE[:1], FLAT[:1]),  # one sample
        Pose(LINE[:2], FLAT[:2]),
        Pose(LINE, np.where(np.arange(40)[:, None] % 2 == 0, -1, 1) * FLAT),  # flipped quaternions
        Pose.from_rotvec(np.zeros((40, 3)), np.linspace(1, 0, 40)[:, None] * np.array([0, 0, 2.0])),  # turning on the spot
        Pose.from_rotvec(LINE, np.linspace(1, 0, 40)[:, None] * np.array([0, 0, 3.1415])),  # half a turn
        Pose(np.concatenate([LINE, LINE[::-1]]), np.concatenate([FLAT, FLAT])),  # there and back: ends where it started
    ],
    ids=["collinear", "stationary", "duplicate", "one sample", "two samples", "flipped", "turn", "half turn", "loop"],
)
@pytest.mark.parametrize("count", [1, 3])
def test_odd_data_give_certified_fields(T: Pose, count: int):
    fields = fit_fields([Trajectory(0.05 * np.arange(len(T)), T)] * count)
    for field in fields:
        for certificate, slowest in zip(field.certificates, SLOWEST, strict=True):
            certificate.demand(0.9 * slowest, FitConfig().period_s)
    goal = fields[-1].T_goal
    assert np.allclose(goal.p, T.p[-1], atol=1e-9)
    assert np.linalg.norm((goal.inverse() @ T[-1]).rotvec()) < 1e-6
    away = Pose(goal.p + np.array([0.1, 0.1, -0.1]), quat_multiply(quat_exp([0.5, 0.2, 0.1]), goal.q))
    way = rollout(fields[-1], away[None], 30.0, 0.05)
    assert np.linalg.norm(way.p[0, -1] - goal.p) < 1e-3
    assert np.linalg.norm(fields[-1].orientation.error(way.q[0, -1])) < 1e-3


def test_one_demonstration_is_followed():
    t = reach(3)
    (field,) = fit_fields([t])
    way = rollout(field, t.T_frame_ee[[0]], 8.0, 0.05)[0]
    gaps = np.linalg.norm(way.p[:, None] - t.T_frame_ee.p[None], axis=-1).min(0)
    assert gaps.max() < 0.01
    assert gaps.mean() < 0.005


@settings(max_examples=50, deadline=None)
@given(seed=SEEDS)
def test_the_field_that_runs_keeps_its_certified_rates(field: Field, seed: int):
    """Also where the pairing slows one of the two down."""
    T = random_poses(seed, 200, 0.4)
    twist = field.twist(T)
    e, r = T.p - field.T_goal.p, field.orientation.error(T.q)
    slow_p = np.linalg.norm(twist[:, :3], axis=1) < 0.999 * SLOWEST[0] * field.position.lpv.pace.min()
    slow_q = np.linalg.norm(twist[:, 3:], axis=1) < 0.999 * SLOWEST[1] * field.orientation.lpv.pace.min()
    of_p, of_q = field.certificates
    falls_p = -np.einsum("ni,ij,nj->n", twist[:, :3], field.P, e) / np.einsum("ni,ij,nj->n", e, field.P, e)
    falls_q = -np.einsum("ni,ni->n", twist[:, 3:], r) / np.einsum("ni,ni->n", r, r)
    assert np.all(falls_p[slow_p] >= of_p.rate_hz - 1e-9)
    assert np.all(falls_q[slow_q] >= of_q.rate_hz - 1e-9)


def test_every_period_below_the_certified_one_arrives(field: Field):
    way = rollout(field, random_poses(3, 50, 0.4), 100.0, 0.99 * field.max_period_s)
    e = way.p - field.T_goal.p
    distance = np.sqrt(np.einsum("nti,ij,ntj->nt", e, field.P, e))
    assert np.all(np.diff(distance, axis=1) <= 1e-12)
    assert np.all(np.diff(np.linalg.norm(field.orientation.error(way.q), axis=-1), axis=1) <= 1e-9)


def test_bad_parts_are_refused():
    with pytest.raises(InputError, match="unit quaternion"):
        OrientationField(attraction(3.0, 1.0), np.array([1.0, 1.0, 0, 0]))
    with pytest.raises(InputError, match=r"\(1, 3, 3\)"):
        Lpv(Mixture.single(), np.zeros((2, 3, 3)), np.ones(1))
    with pytest.raises(InputError, match="at least one trajectory"):
        fit_field([], FitConfig())


def test_step_on_the_group_is_no_longer_than_in_the_tangent_space():
    # what the certificate of the orientation rests on
    rng = np.random.default_rng(0)
    e = rng.normal(size=(500, 3))
    e *= (rng.uniform(0, np.pi, 500) / np.linalg.norm(e, axis=1))[:, None]
    step = rng.normal(size=(500, 3))
    after = quat_log(quat_multiply(quat_exp(step), quat_exp(e)))
    assert np.all(np.linalg.norm(after, axis=1) <= np.linalg.norm(e + step, axis=1) + 1e-9)


def test_a_turn_in_place_does_not_wait_for_a_position_that_is_held():
    """A knob holds the hand a few millimetres from where it was held in the demonstrations: it has to be turned all the same."""

    def twist(seed: int) -> Trajectory:
        rng = np.random.default_rng(seed)
        times = np.linspace(0, 3, 60)
        s = np.linspace(0, 1, 60)
        p = np.outer(1 - s, rng.uniform(-0.007, 0.007, 3)) + 0.001 * np.sin(3 * s)[:, None]
        return Trajectory(times, Pose(p, quat_exp(np.outer(1.6 * (1 - s), [0, 0, 1.0]))))

    (turning,) = fit_fields([twist(seed) for seed in range(6)], FitConfig())
    p = turning.T_goal.p + np.array([0.004, 0.0, 0.0])
    for angle in (1.5, 1.0, 0.5, 0.1):
        assert turning.twist(Pose(p, quat_exp([0.0, 0.0, angle])))[5] < -0.2, angle


@pytest.mark.parametrize(
    ("matrix", "message"),
    [
        (0.5 * np.eye(3), r"A\^T P \+ P A is not negative definite enough, rate -0\.5 1/s"),
        (-60.0 * np.eye(3), r"steps of up to 0\.0333 s shrink the error, not of 0\.1 s"),
        (np.full((3, 3), np.nan), "the matrices are not finite"),
    ],
)
def test_a_fit_that_cannot_be_certified_says_which_condition_fails_and_by_how_much(reaches, monkeypatch, matrix, message):
    # whatever the solver claims, the certificate looks at the numbers themselves
    def solver(x, v, weights, *others, **more):
        return np.stack([matrix] * weights.shape[1])

    monkeypatch.setattr("symskill_pddl.skills.convex.fit_matrices", solver)
    with pytest.raises(CertificateError, match=message):
        fit_fields(reaches)


def test_a_hundred_times_the_units_give_the_same_rollout(reaches):
    large = [Trajectory(t.times, Pose(100 * t.T_frame_ee.p, t.T_frame_ee.q)) for t in reaches]
    config = FitConfig(max_fields=1)
    (one,) = fit_fields(reaches, config)
    changed = {"min_motion_m": 100 * config.min_motion_m, "min_speed_m_s": 100 * config.min_speed_m_s}
    changed |= {
        "tolerance_m": 100 * config.tolerance_m,
        "disturbance_m": 100 * config.disturbance_m,
        "final_m": 100 * config.final_m,
    }
    (two,) = fit_fields(large, replace(config, **changed))
    start = reaches[0].T_frame_ee[[0]]
    way, other = rollout(one, start, 6.0, 0.05), rollout(two, Pose(100 * start.p, start.q), 6.0, 0.05)
    assert np.allclose(100 * way.p, other.p, atol=1e-2)
    assert np.allclose(np.abs((way.q * other.q).sum(-1)), 1.0, atol=1e-6)
