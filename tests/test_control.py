"""The passive controller on plants small enough to check by hand: no simulator."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from symskill_pddl.control import ControlConfig, PassiveController, damping_matrix
from symskill_pddl.errors import InputError

DT = 0.002
# six joints: the plant is one rigid body, J is the identity and no null space is left
BODY = ControlConfig(posture=(0.0,) * 6, posture_rates=(0.0, 0.0), torque_limits=(500.0,) * 6, tank_refill=0.0)
M = np.diag([4.0, 3.0, 5.0, 0.3, 0.2, 0.4])


def run(controller, twist, seconds, load=None, q=None, qd=None, M=M):
    """Semi-implicit Euler of M qdd = tau + load; yields after each step."""
    q = np.zeros(len(M)) if q is None else q
    qd = np.zeros(len(M)) if qd is None else qd
    load = np.zeros(len(M)) if load is None else load
    J = np.eye(6, len(M))
    for i in range(round(seconds / DT)):
        f = twist(i * DT, q, qd) if callable(twist) else twist
        tau = controller.torques(q, qd, J, M, np.zeros(len(M)), f, DT)
        qd = qd + DT * np.linalg.solve(M, tau + load)
        q = q + DT * qd
        yield q, qd


def last(steps):
    *_, end = steps
    return end


twists = st.lists(st.floats(-1.0, 1.0), min_size=6, max_size=6).map(np.array)


@given(twists)
@settings(deadline=None)  # the first call compiles
def test_damping_is_symmetric_positive_and_between_its_two_rates(twist):
    rng = np.random.default_rng(0)
    root = rng.normal(size=(6, 6))
    inertia = root @ root.T + 0.1 * np.eye(6)
    D = damping_matrix(inertia, twist)
    np.testing.assert_allclose(D, D.T, atol=1e-9)
    # relative to the inertia, every eigenvalue lies between rate_along and rate_across
    values = np.linalg.eigvals(np.linalg.solve(inertia, D)).real
    c = ControlConfig()
    assert values.min() > c.rate_along - 1e-6
    assert values.max() < c.rate_across + 1e-6


def test_damping_is_low_along_a_fast_twist_and_high_across_it():
    c = ControlConfig()
    D = damping_matrix(np.eye(6), np.array([10.0, 0, 0, 0, 0, 0]))
    assert D[0, 0] == pytest.approx(c.rate_along, rel=1e-3)
    assert D[1, 1] == pytest.approx(c.rate_across)


def test_at_rest_damping_is_high_on_all_sides():
    np.testing.assert_allclose(damping_matrix(np.eye(6), np.zeros(6)), ControlConfig().rate_across * np.eye(6))


def test_tracks_a_twist():
    twist = np.array([0.1, -0.05, 0.2, 0.3, 0.0, -0.4])
    q, qd = last(run(PassiveController(BODY), twist, 1.0))
    np.testing.assert_allclose(qd, twist, atol=2e-3)
    np.testing.assert_allclose(q, twist, atol=5e-3)


def test_a_load_in_the_hand_moves_it_by_millimetres_and_then_no_further():
    load = np.array([0.0, 0.0, -3.0, 0.0, 0.0, 0.0])
    path = [q[2] for q, _ in run(PassiveController(BODY), np.zeros(6), 6.0, load)]
    assert abs(path[-1]) < 3e-3
    assert abs(path[-1] - path[-500]) < 1e-5


def test_a_hard_push_slips_and_meets_bounded_force():
    controller = PassiveController(BODY)
    last(run(controller, np.zeros(6), 3.0, np.array([40.0, 0, 0, 0, 0, 0])))
    k, limit = BODY.spring[0], BODY.spring_limit[0]
    assert controller.spring_energy == pytest.approx(0.5 * limit**2 / k, rel=0.02)


@pytest.mark.parametrize("seed", range(5))
def test_energy_is_never_created(seed):
    """Kinetic energy, bristle and tank together never grow by themselves, whatever the command does."""
    rng = np.random.default_rng(seed)
    controller = PassiveController(BODY)
    frequency, phase, size = rng.uniform(0.2, 3.0, 6), rng.uniform(0, 6, 6), rng.uniform(0.1, 0.6, 6)

    def command(t, q, qd):
        return size * np.sin(2 * np.pi * frequency * t + phase)

    before = rng.normal(size=6) * 0.3
    total = []
    for _, qd in run(controller, command, 4.0, qd=before):
        # the tank's books reach to the beginning of the step
        total.append(0.5 * before @ M @ before + controller.spring_energy + controller.tank_energy)
        before = qd
    assert np.all(np.diff(total) < 1e-9)


def test_an_empty_tank_lets_the_command_do_no_more_work():
    """A command that chases the load it is pushing drains the tank; then the arm gives way instead of pushing on."""
    config = ControlConfig(
        posture=(0.0,) * 6, posture_rates=(0.0, 0.0), torque_limits=(500.0,) * 6, tank_capacity=0.5, tank_refill=0.0
    )
    controller, twist, load = PassiveController(config), np.array([0.2, 0, 0, 0, 0, 0]), np.array([-15.0, 0, 0, 0, 0, 0])
    work = 0.0
    for _, qd in run(controller, twist, 10.0, load):
        work -= load @ qd * DT
        assert controller.tank_energy > -0.01
    assert work < config.tank_capacity
    # with a full tank it would be 15 N x 0.1 m/s x 10 s and more
    assert controller.tank_energy < 0.1


def test_an_empty_tank_lets_the_posture_do_no_more_work():
    """Somebody turns the elbow away again and again; what the posture gives back then comes out of the tank, and ends with it."""
    config = ControlConfig(tank_capacity=0.05, tank_refill=0.0, posture=(1.0,) * 7)
    M7 = np.diag(np.linspace(1.5, 0.1, 7))
    J = np.linalg.qr(np.random.default_rng(3).normal(size=(7, 7)))[0][:6]
    controller, q, qd, work = PassiveController(config), np.zeros(7), np.zeros(7), 0.0
    for step in range(5000):
        tau = controller.torques(q, qd, J, M7, np.zeros(7), np.zeros(6), DT)
        after = qd + DT * np.linalg.solve(M7, tau)
        work += DT * tau @ (0.5 * (qd + after))
        qd, q = after, q + DT * 0.5 * (qd + after)
        if step % 500 == 499:
            q, qd = np.zeros(7), np.zeros(7)  # held and brought back: its energy is gone
    assert 0.5 * config.tank_capacity < work < config.tank_capacity + 1e-3


def test_torques_stay_within_their_limits():
    config = ControlConfig(posture=(0.0,) * 6, torque_limits=(1.0,) * 6)
    tau = PassiveController(config).torques(np.zeros(6), np.zeros(6), np.eye(6), M, np.full(6, 50.0), np.ones(6), DT)
    assert np.abs(tau).max() <= 1.0


def test_the_posture_pulls_in_the_null_space_only():
    config = ControlConfig(tank_refill=0.0, posture=(1.0,) * 7)
    rng = np.random.default_rng(3)
    root = rng.normal(size=(7, 7))
    M7, J = 0.01 * (root @ root.T) + 0.1 * np.eye(7), rng.normal(size=(6, 7))
    tau = PassiveController(config).torques(np.zeros(7), np.zeros(7), J, M7, np.zeros(7), np.zeros(6), DT)
    assert np.linalg.norm(tau) > 0.1
    np.testing.assert_allclose(J @ np.linalg.solve(M7, tau), 0.0, atol=1e-3)


def test_reset_fills_the_tank_and_relaxes_the_bristle():
    controller = PassiveController(BODY)
    last(run(controller, np.zeros(6), 0.2, np.array([30.0, 0, 0, 0, 0, 0])))
    assert controller.spring_energy > 0.0
    controller.reset()
    assert (controller.spring_energy, controller.tank_energy) == (0.0, BODY.tank_capacity)


@pytest.mark.parametrize(
    "change",
    [
        {"rate_along": 0.0},
        {"tank_refill": -1.0},
        {"rate_along": 200.0},
        {"posture": (0.0,)},
        {"spring": (-1.0, 1.0)},
        {"torque_limits": (0.0,) * 7},
    ],
)
def test_nonsense_constants_are_refused(change):
    with pytest.raises(InputError, match="controller"):
        ControlConfig(**change)
