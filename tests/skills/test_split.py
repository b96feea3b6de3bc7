from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose
from symskill_pddl.skills import FitConfig, Trajectory, fit_fields, fit_phases, fit_reported

from .conftest import execute, grasp, reach, u_shape

DATA = Path(__file__).parent.parent / "data" / "robottasks9"


def test_a_reach_is_one_field(reaches):
    fields, report = fit_reported(reaches)
    assert len(fields) == 1
    assert report.deviations[0] <= 1.0
    assert report.retreat < 0.05
    assert report.stray_m < 0.015
    assert report.durations_s == (pytest.approx(5.0),)


@pytest.mark.parametrize("turn", [0.0, 1.0])
@pytest.mark.parametrize("count", [1, 5])
def test_a_u_is_split_and_followed(turn, count):
    demos = [u_shape(seed, turn) for seed in range(count)]
    fields, report = fit_reported(demos)
    assert 2 <= len(fields) <= 4
    assert report.retreat > 0.15
    assert len(report.durations_s) == len(fields)
    assert sum(report.durations_s) == pytest.approx(demos[0].duration_s, rel=0.01)
    for demo in demos:
        way, arrived = execute(fields, demo.T_frame_ee[0], FitConfig(), 1.5 * demo.duration_s)
        assert arrived
        corridor = np.linalg.norm(way.p[:, None] - demo.T_frame_ee.p[None], axis=-1)
        # within 2.5 cm of its own demonstration all the way; the obstacle above the bottom would be hit 15 cm off it
        assert corridor.min(1).max() < 0.025
        assert corridor.min(0).max() < 0.025


def test_one_field_could_not_follow_the_u():
    (field,), report = fit_reported([u_shape(0)], replace(FitConfig(), max_fields=1))
    assert report.deviations[0] > 2.0
    assert field.max_period_s >= 0.99 * FitConfig().period_s


def test_different_timing_and_starts():
    demos = []
    for seed in range(4):
        base, rng = u_shape(seed), np.random.default_rng(seed)
        # a pause somewhere, half the speed for some
        at, wait = int(rng.integers(20, 100)), int(rng.integers(10, 40))
        x = np.concatenate([base.T_frame_ee.p[:at], np.repeat(base.T_frame_ee.p[at][None], wait, 0), base.T_frame_ee.p[at:]])
        q = np.tile([1.0, 0, 0, 0], (len(x), 1))
        demos.append(Trajectory((0.05 + 0.05 * (seed % 2)) * np.arange(len(x)), Pose(x + rng.normal(0, 2e-4, x.shape), q)))
    fields = fit_fields(demos)
    for demo in demos:
        way, arrived = execute(fields, demo.T_frame_ee[0], FitConfig(), 20.0)
        assert arrived
        assert np.linalg.norm(way.p[:, None] - demo.T_frame_ee.p[None], axis=-1).min(1).max() < 0.025


@pytest.mark.parametrize("count", [1, 3, 8])
def test_a_grasp_from_above_comes_from_above_from_anywhere(count):
    fields, report = fit_reported([grasp(seed) for seed in range(1, count + 1)])
    assert len(fields) == 2
    assert report.retreat < 0.05
    assert report.stray_m > FitConfig().max_stray_m
    for start in ([0.3, 0.2, 0.3], [0.2, -0.3, 0.3], [-0.3, 0.2, 0.3], [-0.3, -0.1, 0.2], [0, 0.3, 0.1]):
        way, arrived = execute(fields, Pose(np.array(start), np.array([1.0, 0, 0, 0])), FitConfig(), 15.0)
        assert arrived
        low = way.p[way.p[:, 2] < 0.035]
        assert np.linalg.norm(low[:, :2] - fields[-1].T_goal.p[:2], axis=1).max() < 0.012


def test_phases_have_loose_tolerances_in_between():
    phases = fit_phases([u_shape(0)], "?food", True, 0.004, 0.02)
    assert len(phases) >= 2
    assert [p.tolerance_p for p in phases] == [0.01] * (len(phases) - 1) + [0.004]
    assert phases[-1].tolerance_r == 0.02
    assert all(p.frame == "?food" and p.close_gripper for p in phases)


def test_order_of_the_demonstrations_does_not_matter_much(reaches):
    one, two = fit_fields(reaches), fit_fields(reaches[::-1])
    assert np.allclose(one[0].T_goal.p, two[0].T_goal.p, atol=1e-12)
    T = reaches[0].T_frame_ee
    assert np.abs(one[0].twist(T) - two[0].twist(T)).max() < 1e-3


def test_nothing_to_fit_is_refused():
    with pytest.raises(InputError, match="at least one trajectory"):
        fit_fields([])


def robot_task(name: str, demos: int) -> list[Trajectory]:
    data = np.load(DATA / f"{name}.npy", allow_pickle=False)[:demos].astype(float)
    return [Trajectory(np.linspace(0, 10, len(d)), Pose(0.01 * d[:, :3], d[:, 3:])) for d in data]


@pytest.mark.parametrize(
    ("name", "demos", "most_cm", "most_deg"),
    [("bottle2shelf", 9, 1.6, 4.0), ("bottle2shelf", 1, 0.5, 2.0), ("obstaclerotate", 1, 0.8, 2.0)],
)
def test_real_demonstrations_are_followed(name, demos, most_cm, most_deg):
    shown = robot_task(name, demos)
    fields = fit_fields(shown)
    position, rotation = [], []
    for t in shown[:3]:
        way, arrived = execute(fields, t.T_frame_ee[0], FitConfig(), 30.0)
        assert arrived
        gaps = np.linalg.norm(way.p[:, None] - t.T_frame_ee.p[None], axis=-1)
        angles = 2 * np.arccos(np.clip(np.abs(way.q @ t.T_frame_ee.q.T), 0, 1))
        position.append(0.5 * (gaps.min(0).mean() + gaps.min(1).mean()))
        rotation.append(0.5 * (angles.min(0).mean() + angles.min(1).mean()))
    assert 100 * np.mean(position) < most_cm
    assert np.degrees(np.mean(rotation)) < most_deg


def test_a_rotation_that_turns_away_is_cut_at_its_turn():
    # the wrist turns 55 deg away and back, while the position goes on: a single field would never turn
    shown = robot_task("obstaclerotate", 9)
    fields, report = fit_reported(shown)
    assert report.retreat > 0.5
    assert max(report.deviations) <= 1.0
    turned = [np.linalg.norm((fields[-1].T_goal.inverse() @ f.T_goal).rotvec()) for f in fields[:-1]]
    assert np.degrees(max(turned)) > 45


def test_a_large_disturbance_is_survived():
    shown = robot_task("obstaclerotate", 9)
    fields = fit_fields(shown)
    rng = np.random.default_rng(0)
    for t in shown[:4]:
        d = rng.normal(size=3)
        start = Pose(t.T_frame_ee.p[0] + 0.3 * d / np.linalg.norm(d), rng.normal(size=4))
        assert execute(fields, start, FitConfig(), 30.0, (0.005, np.radians(3)))[1]


def test_helpers_agree_on_what_a_reach_is():
    # guards the shared fixture: ends at the origin, unturned
    assert np.allclose(reach(0).end.vector(), [0, 0, 0, 1, 0, 0, 0], atol=1e-12)
