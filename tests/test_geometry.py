"""Group axioms, exp/log, batches."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose, karcher_mean, quat_exp, quat_log, quat_multiply, quat_rotate, rotation_distance

finite = st.floats(-10, 10, allow_nan=False)
vectors = arrays(np.float64, 3, elements=finite)
near_zero = arrays(np.float64, 3, elements=st.floats(-1e-7, 1e-7))
rotations = st.one_of(arrays(np.float64, 3, elements=st.floats(-4, 4)), near_zero)
poses = st.builds(Pose.from_rotvec, vectors, rotations)


def close(a: Pose, b: Pose, tol: float = 1e-9) -> bool:
    return bool(np.allclose(a.p, b.p, atol=tol) and rotation_distance(a, b) < max(tol, 3e-8))


@given(poses, poses, poses)
def test_composition_is_associative(a: Pose, b: Pose, c: Pose) -> None:
    assert close((a @ b) @ c, a @ (b @ c))


@given(poses)
def test_inverse_and_identity(a: Pose) -> None:
    assert close(a @ a.inverse(), Pose.identity())
    assert close(a @ Pose.identity(), a)


@given(poses, poses, vectors)
def test_composition_acts_as_matrices_do(a: Pose, b: Pose, x: np.ndarray) -> None:
    assert np.allclose((a @ b).matrix(), a.matrix() @ b.matrix(), atol=1e-9)
    assert np.allclose(a.apply(b.apply(x)), (a @ b).apply(x), atol=1e-8)


@given(rotations)
def test_exp_and_rotate_agree_with_scipy(r: np.ndarray) -> None:
    v = np.array([0.3, -0.2, 0.9])
    assert np.allclose(quat_rotate(quat_exp(r), v), Rotation.from_rotvec(r).apply(v), atol=1e-12)


@given(rotations)
def test_log_inverts_exp_up_to_whole_turns(r: np.ndarray) -> None:
    log = quat_log(quat_exp(r))
    assert np.linalg.norm(log) <= np.pi + 1e-12
    assert (Rotation.from_rotvec(log) * Rotation.from_rotvec(r).inv()).magnitude() < 1e-7


@given(rotations)
def test_log_does_not_see_the_double_cover(r: np.ndarray) -> None:
    q = quat_exp(r)
    assert np.array_equal(quat_log(q), quat_log(-q))


@pytest.mark.parametrize("axis", [(1, 0, 0), (0, -1, 0), (0.6, 0, -0.8)])
def test_log_at_pi_is_defined_and_the_same_for_both_signs(axis: tuple[float, float, float]) -> None:
    q = np.array([0.0, *axis])
    assert np.linalg.norm(quat_log(q)) == pytest.approx(np.pi)
    assert np.array_equal(quat_log(q), quat_log(-q))


def test_matrix_round_trip_in_a_batch() -> None:
    T = Pose.from_rotvec(np.arange(12.0).reshape(2, 2, 3), np.arange(12.0).reshape(2, 2, 3) / 5)
    back = Pose.from_matrix(T.matrix())
    assert back.shape == (2, 2)
    assert np.allclose(back.p, T.p)
    assert np.all(rotation_distance(back, T) < 1e-7)
    assert np.allclose(Pose.from_vector(T.vector()).q, T.q)


def test_a_batch_composes_element_by_element() -> None:
    a = Pose.from_rotvec(np.ones((4, 3)), np.linspace(0, 1, 12).reshape(4, 3))
    b = Pose.from_rotvec([1, 2, 3], [0.1, 0.2, 0.3])
    both = a @ b
    assert len(both) == 4
    for i in range(4):
        assert close(both[i], a[i] @ b)
    assert Pose.stack([a[0], a[1]]).shape == (2,)


def test_karcher_mean_does_not_wrap_and_ignores_signs() -> None:
    spread = np.array([[0, 0, np.pi - 0.2], [0, 0, np.pi + 0.2], [0, 0, np.pi]])
    q = quat_exp(spread) * np.array([[1.0], [-1.0], [1.0]])
    mean = karcher_mean(q)
    assert np.linalg.norm(quat_log(quat_multiply(mean * [1, -1, -1, -1], quat_exp([0, 0, np.pi])))) < 1e-9


@pytest.mark.parametrize(
    ("p", "q"),
    [
        ([0, 0], [1, 0, 0, 0]),
        ([0, 0, 0], [1, 0, 0]),
        ([0, 0, np.nan], [1, 0, 0, 0]),
        ([0, 0, 0], [0, 0, 0, 0]),
    ],
)
def test_a_pose_that_is_none_raises(p: list[float], q: list[float]) -> None:
    with pytest.raises(InputError):
        Pose(np.array(p), np.array(q))


def test_a_pose_cannot_be_changed() -> None:
    source = np.zeros(3)
    T = Pose(source, np.array([1.0, 0, 0, 0]))
    source[0] = 1.0
    assert T.p[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        T.p[0] = 1.0


def test_a_single_pose_has_no_length() -> None:
    with pytest.raises(InputError):
        len(Pose.identity())


def test_a_single_pose_has_the_bits_of_one_among_many():
    rng = np.random.default_rng(0)
    a, b = (Pose(rng.normal(size=(50, 3)), rng.normal(size=(50, 4))) for _ in range(2))
    for found, each in (
        (a @ b, [a[i] @ b[i] for i in range(50)]),
        (a[0] @ b, [a[0] @ b[i] for i in range(50)]),
        (a.inverse(), [a[i].inverse() for i in range(50)]),
        (a, [Pose(a.p[i], a.q[i]) for i in range(50)]),
    ):
        assert np.array_equal(found.vector(), Pose.stack(each).vector())
        assert np.array_equal(found.rotation_matrix(), np.stack([T.rotation_matrix() for T in each]))
