from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symskill_pddl.demos import Demo
from symskill_pddl.demos.noise import freezes, jitter, without_freezes
from symskill_pddl.geometry import Pose, quat_exp, quat_multiply


def carried(*, sigma_m: float, sigma_rad: float, hz: float = 20.0, seed: int = 0) -> Demo:
    """A thing rests for 4 s, goes 30 cm along x within 2 s, rests for 4 s; its pose jitters."""
    rng = np.random.default_rng(seed)
    times = np.arange(0.0, 10.0, 1.0 / hz)
    n = len(times)
    s = np.clip((times - 4.0) / 2.0, 0.0, 1.0)
    x = 0.3 * (3 * s**2 - 2 * s**3)
    true = Pose(np.stack([x, 0 * x, 0 * x], axis=1), quat_exp(np.stack([0 * x, 0 * x, x], axis=1)))
    p = true.p + sigma_m * rng.standard_normal((n, 3))
    q = quat_multiply(true.q, quat_exp(sigma_rad * rng.standard_normal((n, 3))))
    return Demo(
        "demo_0", "file", "task", times, true, np.full(n, 0.08), np.zeros(n, bool), {"box": "cube"}, Pose(p[:, None], q[:, None])
    )


def frozen_at(demo: Demo, since: int, until: int) -> Demo:
    """The pose of sample `since` up to before sample `until`."""
    index = np.arange(len(demo))
    index[since:until] = since
    return replace(demo, T_world_objects=demo.T_world_objects[index])


@pytest.mark.parametrize("hz", [5.0, 20.0, 240.0])
@pytest.mark.parametrize(("m", "rad"), [(0.0005, 0.003), (0.003, 0.035)])
def test_jitter_is_what_was_added(m, rad, hz):
    found = jitter(carried(sigma_m=m, sigma_rad=rad, hz=hz), "box")
    assert found.p_m == pytest.approx(m, rel=0.4)
    assert found.r_rad == pytest.approx(rad, rel=0.4)


def test_what_moves_evenly_does_not_jitter():
    demo = carried(sigma_m=0.0, sigma_rad=0.0)
    assert jitter(demo, "box").p_m < 1e-9
    assert jitter(demo, "gripper").p_m < 1e-9
    assert jitter(replace(demo, seen=np.arange(len(demo))[:, None] < 2), "box").p_m == 0.0


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 1000), st.integers(0, 150), st.integers(3, 40), st.sampled_from([0.0003, 0.001, 0.003]))
def test_a_freeze_is_found_as_it_was_made(seed, since, length, sigma):
    demo = carried(sigma_m=sigma, sigma_rad=0.01, seed=seed)
    made = np.zeros(len(demo), bool)
    made[since + 1 : since + length] = True
    found = without_freezes(frozen_at(demo, since, since + length))
    np.testing.assert_array_equal(found.sees("box"), ~made)
    assert found.pose("box").vector().tolist() == frozen_at(demo, since, since + length).pose("box").vector().tolist()
    np.testing.assert_array_equal(without_freezes(found).seen, found.seen)


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 1000), st.sampled_from([0.0, 1e-7]))
def test_what_rests_in_a_simulator_is_seen(seed, sigma):
    demo = carried(sigma_m=sigma, sigma_rad=sigma, seed=seed)
    still = np.minimum(np.arange(len(demo)), 120)
    demo = replace(demo, T_world_objects=demo.T_world_objects[still])
    assert without_freezes(demo) is demo


def test_what_rests_in_a_simulator_is_seen_though_it_jumps_away_once():
    demo = carried(sigma_m=0.0, sigma_rad=0.0)
    p = demo.T_world_objects.p.copy()
    p[90] = p[150] = 0.0
    assert not freezes(replace(demo, T_world_objects=Pose(p, demo.T_world_objects.q)), "box").any()


@pytest.mark.parametrize("times", [2, 3, 5])
def test_a_tracker_slower_than_the_recording_is_not_frozen(times):
    demo = carried(sigma_m=0.001, sigma_rad=0.01, hz=100.0)
    slow = replace(demo, T_world_objects=demo.T_world_objects[np.arange(len(demo)) // times * times])
    assert not freezes(slow, "box").any()
    assert freezes(frozen_at(slow, 300, 400), "box")[310:400].all()


def test_a_tracker_that_rounds_is_not_frozen():
    demo = carried(sigma_m=0.0005, sigma_rad=0.0)
    rounded = replace(demo, T_world_objects=Pose(demo.T_world_objects.p.round(3), demo.T_world_objects.q.round(3)))
    assert freezes(rounded, "box").mean() < 0.05
