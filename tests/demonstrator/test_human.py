"""The hand's paths: exact at the ends, smooth in between, seeded, with the faults asked for."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symskill_pddl.demonstrator.human import Faults, Person, Stroke, approach_twice, interpolate, stroke, vary
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose, rotation_distance

VIA = (
    Pose.from_rotvec([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
    Pose.from_rotvec([0.3, 0.0, 0.0], [0.0, 0.5, 0.0]),
    Pose.from_rotvec([0.3, 0.3, 0.1], [0.0, 0.5, 0.8]),
)


def make(seed: int = 0, **options: float | bool) -> Stroke:
    return stroke(VIA, Person(), np.random.default_rng(seed), **options)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000), st.booleans())
def test_both_ends_are_met_and_the_speed_is_a_persons(seed: int, careful: bool) -> None:
    rng = np.random.default_rng(seed)
    person = Person.draw(rng)
    path = stroke(VIA, person, rng, careful=careful)
    for end, i in ((VIA[0], 0), (VIA[-1], -1)):
        assert np.linalg.norm(path.T_world_ee.p[i] - end.p) < 1e-9
        assert rotation_distance(path.T_world_ee[i], end) < 1e-6
    speed = np.linalg.norm(np.diff(path.T_world_ee.p, axis=0), axis=-1) / 0.05
    assert speed.max() < 2.5 * person.speed_m_s
    assert speed[0] < 0.2 * person.speed_m_s
    assert speed[-1] < 0.2 * person.speed_m_s


def test_corners_are_rounded_and_not_far_off() -> None:
    path = make()
    miss = np.linalg.norm(path.T_world_ee.p - VIA[1].p, axis=-1).min()
    assert 0.003 < miss < 0.05
    turn = np.diff(path.T_world_ee.p, axis=0)[5:-5]
    turn = turn / np.linalg.norm(turn, axis=-1, keepdims=True)
    assert (turn[1:] * turn[:-1]).sum(-1).min() > np.cos(np.radians(60))


def test_same_seed_same_stroke_other_seed_other_stroke() -> None:
    a, b, c = make(3), make(3), make(4)
    assert np.array_equal(a.T_world_ee.vector(), b.T_world_ee.vector())
    assert not np.array_equal(a.T_world_ee.p[: len(c.times)], c.T_world_ee.p[: len(a.times)])


def test_a_pause_is_a_stop_on_the_way() -> None:
    path = make(pause_s=1.0)
    speed = np.linalg.norm(np.diff(path.T_world_ee.p, axis=0), axis=-1) / 0.05
    middle = speed[len(speed) // 5 : -len(speed) // 5]
    assert (middle < 0.02).sum() * 0.05 >= 0.8
    assert path.times[-1] > make().times[-1] + 1.0


def test_careful_is_slower() -> None:
    assert make(careful=True).times[-1] > 1.3 * make().times[-1]


def test_a_turn_in_place_takes_time() -> None:
    turn = stroke([VIA[0], Pose.from_rotvec([0, 0, 0], [0, 0, 2.0])], Person(), np.random.default_rng(0))
    assert turn.times[-1] > 1.0


def test_second_approach_goes_back_before_it_arrives() -> None:
    via = approach_twice(VIA, np.random.default_rng(0))
    path = stroke(via, Person(wander_m=0.0, tremor_m=0.0), np.random.default_rng(0))
    left = np.linalg.norm(path.T_world_ee.p - VIA[-1].p, axis=-1)
    assert np.diff(left).max() > 0.0  # somewhere the distance grows again
    assert left[-1] < 1e-9


def test_interpolation_and_variation() -> None:
    half = interpolate(VIA[0], VIA[1], 0.5)
    assert np.allclose(half.p, [0.15, 0, 0])
    assert np.allclose(half.rotvec(), [0, 0.25, 0])
    near = vary(VIA[1], np.random.default_rng(0), 0.01, 0.1)
    assert 0 < np.abs(near.p - VIA[1].p).max() <= 0.01
    assert 0 < rotation_distance(near, VIA[1]) < 0.2


def test_faults_follow_their_chance() -> None:
    rng = np.random.default_rng(0)
    drawn = [Faults.draw(rng, 0.2) for _ in range(500)]
    assert 0.12 < np.mean([f.pause for f in drawn]) < 0.28
    assert Faults.draw(rng, 0.0) == Faults()
    assert Faults.draw(rng, 1.0) == Faults(True, True, True, True)


@pytest.mark.parametrize(
    "bad",
    [
        lambda: Person(speed_m_s=0.0),
        lambda: Person(ramp_s=-1.0),
        lambda: Person(wander_m=-0.1),
        lambda: Faults.draw(np.random.default_rng(0), 1.5),
        lambda: stroke(VIA[:1], Person(), np.random.default_rng(0)),
        lambda: stroke(VIA, Person(), np.random.default_rng(0), period_s=0.0),
        lambda: stroke(VIA, Person(), np.random.default_rng(0), pause_s=-1.0),
        lambda: approach_twice(VIA[:1], np.random.default_rng(0)),
        lambda: Stroke(np.zeros(3), Pose.stack(VIA[:2])),
    ],
)
def test_bad_input_is_refused(bad: object) -> None:
    with pytest.raises(InputError):
        bad()  # type: ignore[operator]
