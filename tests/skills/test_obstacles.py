"""Obstacles: alone, several, overlapping, moving, round and flat; from thousands of starts at once."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose
from symskill_pddl.skills import Superellipsoids, box, ellipsoid, modulate

ORIGIN = Pose.identity()
SEEDS = st.integers(0, 10**6)
PERIOD = 0.05


def at(*p: float) -> Pose:
    return Pose(np.array(p), np.array([1.0, 0, 0, 0]))


def ball(p, radius=0.1, velocity=(0.0, 0, 0)) -> Superellipsoids:
    return ellipsoid(at(*p), np.full(3, radius), np.array(velocity))


def shaped(T: Pose, radii, power: float) -> Superellipsoids:
    return Superellipsoids(Pose.stack([T]), np.array([radii]), np.zeros((1, 3)), np.array([power]))


def some(rng: np.random.Generator, centre, spread: float, power: float | None = None) -> Superellipsoids:
    """Of any shape, turned anyhow."""
    power = float(rng.choice([1.0, 2.0, 4.0, 8.0])) if power is None else power
    T = Pose(np.asarray(centre) + rng.uniform(-spread, spread, 3), rng.normal(size=4))
    return shaped(T, rng.uniform(0.03, 0.15, 3), power)


def levels(x: np.ndarray, o: Superellipsoids) -> np.ndarray:
    """The formula itself, for points (n, 3): Gamma^(1 / 2 power)."""
    d = np.abs((x - o.T_world.p[0]) @ o.T_world[0].rotation_matrix()) / o.radii[0]
    return np.sum(d ** (2 * o.power[0]), axis=-1) ** (0.5 / o.power[0])


def level(obstacle: Superellipsoids, x) -> float:
    return float(obstacle.levels(x)[0])


def pull(x: np.ndarray, goal: np.ndarray, speed: float = 0.25) -> np.ndarray:
    e = goal - x
    return 3 * e * np.minimum(1.0, speed / np.maximum(3 * np.linalg.norm(e, axis=-1, keepdims=True), 1e-12))


def drive(x, obstacles, goal=np.zeros(3), seconds=40.0, dt=PERIOD) -> np.ndarray:
    """Ways (steps, n, 3) of explicit Euler steps from starts (n, 3)."""
    way = [np.atleast_2d(np.asarray(x, float))]
    for _ in range(round(seconds / dt)):
        way.append(way[-1] + dt * modulate(pull(way[-1], goal), way[-1], obstacles))
        if np.linalg.norm(way[-1] - goal, axis=-1).max() < 1e-3:
            break
    return np.array(way)


SCENES = {
    "ellipsoids": lambda rng: [some(rng, (0, 0, 0), 0.5, 1.0) for _ in range(6)],
    "overlapping": lambda rng: [some(rng, (0.1, 0, 0), 0.04) for _ in range(3)],
    "chains": lambda rng: [some(rng, (0.1, 0, 0), 0.1, 1.0) for _ in range(4)],
    "boxes": lambda rng: [box(Pose(rng.uniform(-0.5, 0.5, 3), rng.normal(size=4)), rng.uniform(0.03, 0.15, 3)) for _ in range(5)],
    "everything": lambda rng: [some(rng, (0, 0, 0), 0.4) for _ in range(10)],
    "corner of walls": lambda rng: [box(at(0.3, 0, 0), [0.02, 0.3, 0.2]), box(at(-0.1, 0.35, 0), [0.4, 0.02, 0.2])],
}


@pytest.mark.parametrize("kind", SCENES)
def test_from_ten_thousand_starts_nothing_is_entered_and_all_arrive(kind):
    # six kinds of scenes, four of each, 420 starts in each: 10,080
    for seed in range(4):
        rng = np.random.default_rng(seed)
        obstacles = SCENES[kind](rng)
        goal = next(g for g in rng.uniform(-0.6, 0.6, (1000, 3)) if min(levels(g[None], o).item() for o in obstacles) > 1.1)
        x = rng.uniform(-0.7, 0.7, (420, 3))
        outside = np.ones(420, dtype=bool)
        for o in obstacles:
            outside &= levels(x, o) >= 1.0
        way = drive(x, obstacles, goal)
        arrived = np.linalg.norm(way[-1] - goal, axis=-1) < 1e-3
        # overlapping ones that share no point can make a pit, and a field without a memory does not come out of every pit
        assert arrived.all() if kind != "chains" else arrived.mean() > 0.99
        for o in obstacles:
            assert levels(way[:, outside], o).min() >= 1.0 - 1e-9
        # who starts inside leaves within two seconds
        later = way[round(2.0 / PERIOD) :, ~outside]
        if later.size:
            assert min(levels(later, o).min() for o in obstacles) >= 1.0 - 1e-9


@settings(max_examples=100, deadline=None)
@given(seed=SEEDS)
def test_nothing_points_into_a_surface(seed):
    rng = np.random.default_rng(seed)
    obstacle = some(rng, (0, 0, 0), 1.0)
    u = rng.normal(size=3)
    surface = obstacle.T_world.p[0] + u / level(obstacle, obstacle.T_world.p[0] + u)
    assert level(obstacle, surface) == pytest.approx(1.0)
    v = rng.normal(size=3)
    bent = modulate(v, surface, [obstacle])
    assert level(obstacle, surface + 1e-4 * bent) >= 1.0 - 1e-7
    assert np.linalg.norm(bent) <= np.linalg.norm(v) * (1 + 1e-9)


@settings(max_examples=50, deadline=None)
@given(seed=SEEDS)
def test_level_is_the_formula(seed):
    rng = np.random.default_rng(seed)
    obstacle = some(rng, (0.1, 0.2, 0), 0.3)
    x = rng.normal(size=3)
    assert level(obstacle, x) == pytest.approx(levels(x[None], obstacle).item(), rel=1e-12)
    # without a unit, and linear along a ray
    assert level(obstacle, obstacle.T_world.p[0] + 3 * (x - obstacle.T_world.p[0])) == pytest.approx(3 * level(obstacle, x))
    assert level(obstacle, obstacle.T_world.p[0]) == pytest.approx(0.0, abs=1e-9)
    assert np.isfinite(level(obstacle, 1e9 * x))


def test_a_box_holds_its_corners():
    half = np.array([0.3, 0.02, 0.2])
    wall = box(ORIGIN, half)
    corners = np.array([[i, j, k] for i in (-1, 1) for j in (-1, 1) for k in (-1, 1)]) * half
    assert levels(corners, wall) == pytest.approx(1.0)
    assert np.all(wall.radii < 1.08 * half)


def test_far_away_nothing_changes():
    v = np.array([0.1, 0.2, -0.1])
    assert np.allclose(modulate(v, [5.0, 0, 0], [ball([0, 0, 0])]), v, atol=1e-5)
    assert np.array_equal(modulate(v, [5.0, 0, 0], []), v)


@settings(max_examples=50, deadline=None)
@given(seed=SEEDS)
def test_zero_stays_zero_and_the_rest_is_finite(seed):
    rng = np.random.default_rng(seed)
    obstacles = [some(rng, (0, 0, 0), 1.0) for _ in range(4)]
    x = rng.normal(size=3)
    assert np.array_equal(modulate(np.zeros(3), x, obstacles), np.zeros(3))
    assert np.all(np.isfinite(modulate(rng.normal(size=3), x, obstacles)))
    assert np.all(np.isfinite(modulate(rng.normal(size=3), obstacles[0].T_world.p[0], obstacles)))


@settings(max_examples=20, deadline=None)
@given(seed=SEEDS)
def test_one_and_many_agree_and_order_plays_no_part(seed):
    rng = np.random.default_rng(seed)
    obstacles = [some(rng, (0, 0, 0), 0.6) for _ in range(5)]
    x, v = rng.uniform(-0.7, 0.7, (20, 3)), rng.normal(size=(20, 3))
    many = modulate(v, x, obstacles)
    assert np.array_equal(many[7], modulate(v[7], x[7], obstacles))
    apart = [o for i, o in enumerate(obstacles) if all(np.linalg.norm(o.T_world.p - p.T_world.p) > 0.6 for p in obstacles[:i])]
    assert np.allclose(modulate(v, x, apart), modulate(v, x, apart[::-1]), atol=1e-6)


@pytest.mark.parametrize("power", [1.0, 4.0, 8.0])
@pytest.mark.parametrize("radii", [(0.1, 0.1, 0.1), (0.03, 0.15, 0.15), (0.2, 0.05, 0.05), (0.02, 0.3, 0.1)])
def test_head_on_gets_around(radii, power):
    obstacle = shaped(at(0.4, 0, 0), radii, power)
    way = drive([0.9, 0, 0], [obstacle])
    assert np.linalg.norm(way[-1]) < 1e-3
    assert levels(way, obstacle).min() >= 1.0 - 1e-9


def test_head_on_into_the_notch_between_two_gets_around():
    # the straight way leads into the waist of two overlapping balls, and between two boxes in a row that touch
    for pair in (
        [ball([0.4, 0.08, 0]), ball([0.4, -0.08, 0])],
        [box(at(0.4, 0.1, 0), [0.02, 0.11, 0.2]), box(at(0.4, -0.1, 0), [0.02, 0.11, 0.2])],
    ):
        way = drive([0.9, 0, 0], pair)
        assert np.linalg.norm(way[-1]) < 1e-3
        assert min(levels(way, o).min() for o in pair) >= 1.0 - 1e-9


@pytest.mark.parametrize("x", [[0.4, 0, 0], [0.42, 0.01, 0], [0.33, 0.0, 0.0], [0.4, 0, 0.05]])
def test_a_start_inside_leaves_and_arrives(x):
    obstacle = ball([0.4, 0, 0])
    way = drive(x, [obstacle])
    level = levels(way[:, 0], obstacle)
    first_out = int(np.argmax(level >= 1.0))
    assert 0 < first_out < 40
    assert level[first_out:].min() >= 1.0 - 1e-9
    assert np.linalg.norm(way[-1]) < 1e-3


def test_a_start_where_two_overlap_leaves_both():
    pair = [ball([0.4, 0.06, 0]), ball([0.4, -0.06, 0])]
    starts = np.array([0.4, 0, 0]) + np.random.default_rng(0).uniform(-0.1, 0.1, (200, 3))
    way = drive(starts, pair)
    assert np.linalg.norm(way[-1], axis=-1).max() < 1e-3
    assert min(levels(way[40:], o).min() for o in pair) >= 1.0 - 1e-9


def test_moving_obstacles_are_evaded():
    # two balls cross the way and come back, slower than the hand may go: never touched, and the goal is reached when they rest
    rng = np.random.default_rng(0)
    x, goal, closest = rng.uniform([0.6, -0.2, -0.2], [0.9, 0.2, 0.2], (200, 3)), np.zeros(3), np.inf
    for i in range(600):
        t = i * PERIOD
        swing, rate = (0.25 * np.sin(0.5 * t), 0.125 * np.cos(0.5 * t)) if t < 20 else (0.25 * np.sin(10.0), 0.0)
        now = [ball([0.35, swing, 0], 0.1, (0, rate, 0)), ball([0.15, -swing, 0.15], 0.08, (0, -rate, 0))]
        closest = min(closest, *(levels(x, o).min() for o in now))
        x = x + PERIOD * modulate(pull(x, goal), x, now)
    assert closest > 0.97  # what the balls gain within a step by their acceleration
    assert np.linalg.norm(x, axis=-1).max() < 1e-3


def test_a_moving_obstacle_pushes():
    approaching = ball([0.2, 0, 0], 0.1, (0.3, 0, 0))
    bent = modulate([-0.1, 0, 0], [0.3, 0, 0], [approaching])
    assert bent[0] >= 0.3 - 1e-6
    assert np.allclose(modulate([-0.1, 0, 0], [0.3001, 0, 0], [ball([0.2, 0, 0])])[0], 0.0, atol=2e-3)


def test_units_play_no_part():
    v, x, c = np.array([-0.2, 0.05, 0.01]), np.array([0.3, 0.02, 0.0]), np.array([0.15, 0, 0])
    for scale in (1e-3, 100.0):
        bent = modulate(scale * v, scale * x, [ball(scale * c, scale * 0.1)])
        assert np.allclose(bent, scale * modulate(v, x, [ball(c)]), rtol=1e-9)


def test_an_attractor_inside_gives_numbers():
    obstacle = ball([0, 0, 0])
    assert np.all(np.isfinite(drive([0.5, 0, 0], [obstacle], seconds=10.0)))
    assert np.all(np.isfinite(modulate([1e-9, 0, 0], [0, 0, 0], [obstacle])))


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: ellipsoid(ORIGIN, np.array([0.1, 0.0, 0.1])), "three positive radii"),
        (lambda: box(ORIGIN, np.ones(2)), "three positive radii"),
        (lambda: ellipsoid(ORIGIN, np.ones(3), np.full(3, np.nan)), "velocity"),
        (lambda: shaped(ORIGIN, np.ones(3), 0.5), "power has to lie between 1 and 50"),
        (lambda: modulate([1, 0, 0], [1, 0, 0], [ball([0, 0, 0])], locality=0.0), "locality"),
        (lambda: modulate([1, 0, 0], [1, 0, 0], [ball([0, 0, 0])], rate_hz=np.nan), "rate_hz"),
        (lambda: modulate([1, 0, 0], [[1, 0, 0]], [ball([0, 0, 0])]), "one shape"),
    ],
)
def test_bad_obstacles_are_refused(make, message):
    with pytest.raises(InputError, match=message):
        make()
