import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose
from symskill_pddl.skills import Ellipsoids, modulate

ORIGIN = Pose.identity()
SEEDS = st.integers(0, 10**6)


def ball(p, radius=0.1, velocity=(0.0, 0, 0)) -> Ellipsoids:
    return one(Pose(np.array(p, float), np.array([1.0, 0, 0, 0])), np.full(3, radius), np.array(velocity))


def one(T_world, radii, velocity=(0.0, 0, 0)) -> Ellipsoids:
    return Ellipsoids(Pose.stack([T_world]), np.asarray(radii)[None], np.asarray(velocity)[None])


def drive(x, obstacles, goal=np.zeros(3), steps=2000, dt=0.02, speed=0.2) -> np.ndarray:
    way = [np.array(x, float)]
    for _ in range(steps):
        e = goal - way[-1]
        v = 3 * e * min(1.0, speed / max(3 * np.linalg.norm(e), 1e-12))
        way.append(way[-1] + dt * modulate(v, way[-1], obstacles))
    return np.array(way)


def levels(way, obstacle) -> np.ndarray:
    return np.array([obstacle.level(x)[0][0] for x in way])


@settings(max_examples=100, deadline=None)
@given(seed=SEEDS)
def test_nothing_points_into_a_surface(seed):
    rng = np.random.default_rng(seed)
    obstacle = one(Pose(rng.normal(size=3), rng.normal(size=4)), rng.uniform(0.02, 0.5, 3))
    u = rng.normal(size=3)
    surface = obstacle.T_world[0].apply(obstacle.radii[0] * u / np.linalg.norm(u))
    v = rng.normal(size=3)
    normal = obstacle.level(surface)[2][0]
    bent = modulate(v, surface, obstacle)
    assert bent @ normal >= -1e-6 * np.linalg.norm(v)
    assert np.linalg.norm(bent) <= np.linalg.norm(v) * (1 + 1e-9)


def test_far_away_nothing_changes():
    v = np.array([0.1, 0.2, -0.1])
    assert np.allclose(modulate(v, [5.0, 0, 0], ball([0, 0, 0])), v, atol=1e-5)
    none = Ellipsoids(Pose(np.zeros((0, 3)), np.zeros((0, 4))), np.zeros((0, 3)), np.zeros((0, 3)))
    assert np.array_equal(modulate(v, [5.0, 0, 0], none), v)


@settings(max_examples=50, deadline=None)
@given(seed=SEEDS)
def test_zero_stays_zero_and_the_rest_does_not_vanish(seed):
    rng = np.random.default_rng(seed)
    obstacles = Ellipsoids(
        Pose(rng.normal(size=(3, 3)), rng.normal(size=(3, 4))), rng.uniform(0.05, 0.5, (3, 3)), np.zeros((3, 3))
    )
    x = rng.normal(size=3)
    assert np.array_equal(modulate(np.zeros(3), x, obstacles), np.zeros(3))
    assert np.all(np.isfinite(modulate(rng.normal(size=3), x, obstacles)))


@pytest.mark.parametrize("radii", [(0.1, 0.1, 0.1), (0.03, 0.15, 0.15), (0.2, 0.05, 0.05), (0.02, 0.3, 0.1)])
def test_head_on_gets_around(radii):
    obstacle = one(Pose(np.array([0.4, 0, 0]), np.array([1.0, 0, 0, 0])), np.array(radii))
    way = drive([0.9, 0, 0], obstacle)
    assert np.linalg.norm(way[-1]) < 1e-3
    assert levels(way, obstacle).min() > 0.95


@pytest.mark.parametrize("seed", range(5))
def test_several_obstacles_are_passed(seed):
    rng = np.random.default_rng(seed)
    balls = [ball([0.35, 0.12, 0]), ball([0.35, -0.12, 0.02]), ball([0.6, 0, 0.05], 0.08)]
    way = drive(np.array([0.95, 0, 0]) + rng.normal(0, 0.03, 3), Ellipsoids.join(balls))
    assert np.linalg.norm(way[-1]) < 1e-3
    assert min(levels(way, o).min() for o in balls) > 0.9


@pytest.mark.parametrize("x", [[0.4, 0, 0], [0.42, 0.01, 0], [0.33, 0.0, 0.0], [0.4, 0, 0.05]])
def test_a_start_inside_leaves_and_arrives(x):
    obstacle = ball([0.4, 0, 0])
    way = drive(x, obstacle)
    level = levels(way, obstacle)
    first_out = int(np.argmax(level >= 1.0))
    assert 0 < first_out < 100
    assert level[first_out:].min() > 0.9
    assert np.linalg.norm(way[-1]) < 1e-3


def test_a_moving_obstacle_pushes():
    approaching = ball([0.2, 0, 0], 0.1, (0.3, 0, 0))
    bent = modulate([-0.1, 0, 0], [0.3, 0, 0], approaching)
    assert bent[0] >= 0.3 - 1e-6
    assert np.allclose(modulate([-0.1, 0, 0], [0.3001, 0, 0], ball([0.2, 0, 0]))[0], 0.0, atol=1e-3)


def test_an_obstacle_around_the_goal_does_not_count():
    v, x, two = np.array([-0.1, 0, 0]), np.array([0.2, 0, 0]), Ellipsoids.join([ball([0.05, 0, 0]), ball([0, 0.2, 0])])
    assert np.array_equal(modulate(v, x, two, goal=[0.1, 0.01, 0]), modulate(v, x, ball([0, 0.2, 0])))
    assert not np.allclose(modulate(v, x, two, goal=[0.5, 0, 0]), modulate(v, x, ball([0, 0.2, 0])))


def test_units_play_no_part():
    v, x, c = np.array([-0.2, 0.05, 0.01]), np.array([0.3, 0.02, 0.0]), np.array([0.15, 0, 0])
    for scale in (1e-3, 100.0):
        bent = modulate(scale * v, scale * x, ball(scale * c, scale * 0.1))
        assert np.allclose(bent, scale * modulate(v, x, ball(c)), rtol=1e-9)


def test_an_attractor_inside_gives_numbers():
    obstacle = ball([0, 0, 0])
    way = drive([0.5, 0, 0], obstacle, steps=500)
    assert np.all(np.isfinite(way))
    assert np.all(np.isfinite(modulate([1e-9, 0, 0], [0, 0, 0], obstacle)))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: one(ORIGIN, np.array([0.1, 0.0, 0.1])), "three positive radii"),
        (lambda: one(ORIGIN, np.ones(2)), "three positive radii"),
        (lambda: one(ORIGIN, np.ones(3), np.full(3, np.nan)), "velocity"),
        (lambda: modulate([1, 0, 0], [1, 0, 0], ball([0, 0, 0]), power=0.0), "power"),
    ],
)
def test_bad_obstacles_are_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()
