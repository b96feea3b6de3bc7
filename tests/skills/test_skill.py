import io

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symskill_pddl.errors import FormatError, InputError
from symskill_pddl.geometry import Pose
from symskill_pddl.skills import Field, Phase, Skill, fit_phases

from .conftest import u_shape


def some_pose(seed: int) -> Pose:
    rng = np.random.default_rng(seed)
    return Pose(rng.normal(size=3), rng.normal(size=4))


@pytest.fixture(scope="module")
def phase(field: Field) -> Phase:
    return Phase("?food", field, False, 0.01, 0.1, 5.0)


@settings(max_examples=50, deadline=None)
@given(seed=st.integers(0, 10**6))
def test_equivariant_under_rigid_motions(phase: Phase, seed: int):
    frame, ee, G, shift = (some_pose(seed + i) for i in range(4))
    for s in (Pose.identity(), shift):
        here, there = phase.twist(frame, ee, s), phase.twist(G @ frame, G @ ee, s)
        assert np.allclose(there[:3], G.rotate(here[:3]), atol=1e-12)
        assert np.allclose(there[3:], G.rotate(here[3:]), atol=1e-12)


def test_twist_is_the_fields_in_world_axes(phase: Phase):
    frame, ee = some_pose(0), some_pose(1)
    inner = phase.field.twist(frame.inverse() @ ee)
    assert np.allclose(phase.twist(frame, ee), np.concatenate([frame.rotate(inner[:3]), frame.rotate(inner[3:])]), atol=1e-12)


def test_shift_moves_the_goal(phase: Phase):
    frame, shift = some_pose(2), Pose.from_rotvec([0.05, 0.0, -0.02], [0, 0, 0.3])
    goal = phase.T_world_goal(frame, shift)
    assert np.allclose(phase.twist(frame, goal, shift), 0.0, atol=1e-12)
    assert phase.reached(frame, goal, shift)
    assert not phase.reached(frame, goal)


def test_reached_respects_both_tolerances(phase: Phase):
    frame = some_pose(3)
    goal = phase.T_world_goal(frame)
    assert phase.reached(frame, goal @ Pose.from_rotvec([0.009, 0, 0], [0, 0, 0.09]))
    assert not phase.reached(frame, goal @ Pose.from_rotvec([0.011, 0, 0], [0, 0, 0]))
    assert not phase.reached(frame, goal @ Pose.from_rotvec([0, 0, 0], [0, 0, 0.11]))


def test_arrays_round_trip_bit_by_bit(phase: Phase):
    skill = Skill((phase, *fit_phases([u_shape(0, 0.7)], "?cabinet", True, 0.01, 0.1)), True)
    buffer = io.BytesIO()
    np.savez(buffer, **skill.arrays())
    buffer.seek(0)
    with np.load(buffer, allow_pickle=False) as file:
        again = Skill.from_arrays(file)
    assert again.close_gripper_at_end is True
    assert [p.frame for p in again.phases] == [p.frame for p in skill.phases]
    T = some_pose(4)
    for a, b in zip(skill.phases, again.phases, strict=True):
        assert (a.close_gripper, a.tolerance_p, a.tolerance_r, a.duration_s) == (
            b.close_gripper,
            b.tolerance_p,
            b.tolerance_r,
            b.duration_s,
        )
        assert np.array_equal(a.field.twist(T), b.field.twist(T))
        assert [c.rate_hz for c in a.field.certificates] == [c.rate_hz for c in b.field.certificates]
    one, two = skill.arrays(), again.arrays()
    assert list(one) == list(two)
    assert all(np.array_equal(one[name], two[name]) for name in one)


def test_damaged_arrays_are_refused(phase: Phase):
    arrays = Skill((phase,), True).arrays()
    with pytest.raises(FormatError, match=r"lacks the array 'phase0\.position\.goal'"):
        Skill.from_arrays({k: v for k, v in arrays.items() if k != "phase0.position.goal"})
    with pytest.raises(FormatError, match="do not fit together"):
        Skill.from_arrays({**arrays, "phase0.position.matrices": np.zeros((9, 3, 3))})
    with pytest.raises(FormatError, match="do not fit together"):
        Skill.from_arrays({**arrays, "phase0.limits": np.zeros(2)})


@pytest.mark.parametrize(
    ("array", "change", "message"),
    [
        ("position.matrices", lambda a: -a, "not what was certified.*not negative definite"),
        ("orientation.matrices", lambda a: -a, "not what was certified.*not negative definite"),
        ("position.matrices", lambda a: 0.9 * a, "not what was certified.*the error falls at"),
        ("orientation.matrices", lambda a: 2.0 * a, "not what was certified.*steps of up to"),
        ("position.metric", lambda a: np.diag([1.0, 1.0, -1.0]), "not what was certified.*not positive definite"),
        ("position.certificate", lambda a: np.append(a, 0.05), "another version; learn the library again"),
    ],
)
def test_a_field_that_is_not_the_certified_one_is_not_loaded(phase: Phase, array, change, message):
    arrays = Skill((phase,), True).arrays()
    changed = {**arrays, f"phase0.{array}": change(arrays[f"phase0.{array}"])}
    with pytest.raises(FormatError, match=message):
        Skill.from_arrays(changed)


def test_bad_phases_and_skills_are_refused(field: Field):
    with pytest.raises(InputError, match="at least one phase"):
        Skill((), True)
    with pytest.raises(InputError, match=r"'\?food' needs a positive tolerance_p"):
        Phase("?food", field, True, 0.0, 0.1, 1.0)
    with pytest.raises(InputError, match="duration"):
        Phase("?food", field, True, 0.01, 0.1, -1.0)
