"""The passive controller every world tracks its commands with: twist in, joint torques out.

Velocity tracking by damping alone, after Kronander and Billard, "Passive Interaction Control With Dynamical Systems" (RA-L 2016):

    F = -D (xdot - f) + s,    D = r_across Lambda - (r_across - r_along) b(f) (Lambda f)(Lambda f)^T / (f^T Lambda f)

with the commanded twist f and the operational-space inertia Lambda: motion along f meets low damping (the arm gives way when it
is blocked), motion across f meets high damping. `b` fades the difference out at low speed, so that a hand at rest is held firmly
from all sides. The small spring s is of the bristle kind: it stretches by the integrated tracking error and slips at a few
newtons, which removes the creep under a load in the hand and bounds the force at once.

An energy tank pays for all work the torques do (beyond carrying the arm's own weight), and receives what damping takes out. The
work of a step is reckoned when its end is known, as torque times mean velocity, so that the books are exact at any step size. An
empty tank closes the valve on f and on the pull to the posture: then only dissipation is left, whatever the command is.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numba import njit, types
from numpy.typing import ArrayLike

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, frozen

PANDA_TORQUE_LIMITS = (87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0)
"""Joint torque limits of the Franka Panda [Nm]."""

ELBOW_UP = (0.1, -0.6, -0.1, -2.4, 0.6, 2.6, 0.1)
"""The posture [rad] the arm leans to in its null space: elbow up, and the wrist turned to the side on which a hand that looks
ahead keeps clear of joint 6's limit (a wrist turned to neither side falls to the wrong one half of the time)."""


@dataclass(frozen=True)
class ControlConfig:
    """Constants of `PassiveController`.

    Attributes
    ----------
    rate_along, rate_across : float
        Damping along and across the commanded twist, per unit of effective mass [1/s].
    blend_speed, blend_rate : float
        Linear [m/s] and angular [rad/s] speed at which the two rates are half blended.
    spring, spring_limit : (float, float)
        Stiffness [N/m, Nm/rad] of the bristle and the force it slips at [N, Nm].
    tank_capacity : float
        Energy the tank holds, also at the start [J].
    tank_refill : float
        Power granted to the tank besides what damping pays in [W]; 0 makes the loop strictly passive.
    posture, posture_rates : tuple
        Null-space target [rad] and its stiffness [1/s^2] and damping [1/s] per unit of inertia.
    torque_limits : tuple of float
        Clip of each joint's torque [Nm].
    """

    rate_along: float = 50.0
    rate_across: float = 120.0
    blend_speed: float = 0.05
    blend_rate: float = 0.3
    spring: tuple[float, float] = (1500.0, 30.0)
    spring_limit: tuple[float, float] = (10.0, 1.5)
    tank_capacity: float = 20.0
    tank_refill: float = 2.0
    posture: tuple[float, ...] = ELBOW_UP
    posture_rates: tuple[float, float] = (15.0, 8.0)
    torque_limits: tuple[float, ...] = PANDA_TORQUE_LIMITS

    def __post_init__(self) -> None:
        positive = (self.rate_along, self.rate_across, self.blend_speed, self.blend_rate, self.tank_capacity, *self.torque_limits)
        if min(positive) <= 0.0 or min(*self.spring, *self.spring_limit, self.tank_refill, *self.posture_rates) < 0.0:
            raise InputError(
                "controller: rates, blend speeds, tank capacity and torque limits must be positive, the rest not negative"
            )
        if self.rate_along > self.rate_across:
            raise InputError(f"controller: rate_along {self.rate_along} must not exceed rate_across {self.rate_across}")
        if len(self.posture) != len(self.torque_limits):
            raise InputError(f"controller: posture has {len(self.posture)} joints, torque_limits {len(self.torque_limits)}")


@dataclass(eq=False)
class PassiveController:
    """Tracks a twist with joint torques; one instance per arm, as it carries the tank and the bristle."""

    config: ControlConfig = field(default_factory=ControlConfig)

    def __post_init__(self) -> None:
        c = self.config
        self._posture = frozen(c.posture)
        self._limits = frozen(c.torque_limits)
        self._gains = frozen(
            [c.rate_along, c.rate_across, c.blend_speed, c.blend_rate, *c.spring, *c.spring_limit, c.tank_capacity, c.tank_refill]
        )
        self._posture_rates = frozen(c.posture_rates)
        # (7,): bristle stretch [m, rad], then tank energy [J]
        self._state = np.zeros(7)
        # (2, n): torque of the last step without the bias [Nm], and joint velocity at its beginning [rad/s]
        self._last = np.zeros((2, len(c.posture)))
        self.reset()

    def reset(self) -> None:
        """Relax the bristle and fill the tank."""
        self._state[:] = 0.0
        self._state[6] = self.config.tank_capacity
        self._last[:] = 0.0

    @property
    def tank_energy(self) -> float:
        """Energy left in the tank [J]."""
        return float(self._state[6])

    @property
    def spring_energy(self) -> float:
        """Energy stored in the bristle [J]."""
        k_t, k_r = self.config.spring
        e = self._state
        return float(0.5 * (k_t * e[:3] @ e[:3] + k_r * e[3:6] @ e[3:6]))

    def torques(self, q: Array, qd: Array, J: Array, M: Array, bias: Array, twist: Array, dt: float) -> Array:
        """Torques for the next `dt` seconds.

        Parameters
        ----------
        q, qd : (n,)
            Joint positions [rad] and velocities [rad/s].
        J : (6, n)
            Jacobian of the end-effector frame, linear rows first, world axes.
        M : (n, n)
            Joint-space inertia.
        bias : (n,)
            Gravity, Coriolis and centrifugal torques [Nm].
        twist : (6,)
            Commanded linear [m/s] and angular [rad/s] velocity, world axes.
        dt : float
            Time until the next call [s].

        Returns
        -------
        (n,) torques [Nm] within the limits.
        """
        q, qd, J, M, bias = (np.ascontiguousarray(a, dtype=np.float64) for a in (q, qd, J, M, bias))
        fixed = self._gains, self._posture, self._posture_rates, self._limits
        return _torques(q, qd, J, M, bias, np.ascontiguousarray(twist), dt, *fixed, self._state, self._last)


def damping_matrix(inertia: ArrayLike, twist: ArrayLike, config: ControlConfig | None = None) -> Array:
    """The damping D (6, 6), symmetric and positive definite, for an inertia (6, 6) of the hand and a commanded twist (6,)."""
    c = config or ControlConfig()
    return np.asarray(
        _damping(
            np.ascontiguousarray(inertia, dtype=np.float64),
            np.ascontiguousarray(twist, dtype=np.float64),
            c.rate_along,
            c.rate_across,
            c.blend_speed,
            c.blend_rate,
        )
    )


# one form each, compiled at import: see `skills.kernels`
_NUMBER, _VECTOR, _MATRIX = types.float64, types.float64[::1], types.float64[:, ::1]
_FIXED = types.Array(types.float64, 1, "C", readonly=True)


@njit((_MATRIX, _FIXED, _NUMBER, _NUMBER, _NUMBER, _NUMBER), cache=True)
def _damping(inertia, f, along, across, blend_speed, blend_rate):  # type: ignore[no-untyped-def]
    D = across * inertia
    speed2 = (f[0] ** 2 + f[1] ** 2 + f[2] ** 2) / blend_speed**2 + (f[3] ** 2 + f[4] ** 2 + f[5] ** 2) / blend_rate**2
    if speed2 > 1e-12:
        momentum = inertia @ f
        D -= (across - along) * speed2 / (1.0 + speed2) * np.outer(momentum, momentum) / (f @ momentum)
    return D


@njit((_VECTOR, _NUMBER, _NUMBER), cache=True)
def _slip(e, stiffness, limit):  # type: ignore[no-untyped-def]
    norm = np.sqrt(e @ e)
    if stiffness * norm > limit:
        e *= limit / (stiffness * norm)


@njit(
    (_VECTOR, _VECTOR, _MATRIX, _MATRIX, _VECTOR, _FIXED, _NUMBER, _FIXED, _FIXED, _FIXED, _FIXED, _VECTOR, _MATRIX), cache=True
)
def _torques(q, qd, J, M, bias, twist, dt, gains, posture, posture_rates, limits, state, last):  # type: ignore[no-untyped-def]
    along, across, blend_speed, blend_rate, k_t, k_r, slip_t, slip_r, capacity, refill = gains
    xdot = J @ qd
    Minv_JT = np.linalg.solve(M, np.ascontiguousarray(J.T))  # (n, 6)
    mobility = J @ Minv_JT
    exact = np.linalg.inv(mobility + 1e-5 * np.eye(6))
    # caps the effective inertia at 50 kg and 5 kg m^2, where the arm is nearly singular
    for i in range(3):
        mobility[i, i] += 0.02
        mobility[i + 3, i + 3] += 0.2
    inertia = np.linalg.inv(mobility)
    inertia = 0.5 * (inertia + inertia.T)

    D = _damping(inertia, twist, along, across, blend_speed, blend_rate)
    stretch = state[:6]
    spring = np.empty(6)
    spring[:3] = k_t * stretch[:3]
    spring[3:] = k_r * stretch[3:]

    # posture torques through the dynamically consistent null space: they do not accelerate the hand
    pull = M @ (posture_rates[0] * np.minimum(0.5, np.maximum(-0.5, posture - q)))
    pull -= J.T @ (exact @ (Minv_JT.T @ pull))
    brake = M @ (posture_rates[1] * qd)
    brake -= J.T @ (exact @ (Minv_JT.T @ brake))

    # the last step's work, as its end is known now
    state[6] = min(capacity, state[6] - dt * (last[0] @ (0.5 * (last[1] + qd))) + dt * refill)
    # command and posture draw power from the tank; the valve closes over the last 5 %
    drawn = twist @ (D @ xdot) + twist @ spring + pull @ qd
    valve = 1.0
    if drawn > 0.0:
        valve = min(1.0, max(0.0, state[6] / (0.05 * capacity)))
    f = valve * twist
    force = spring - D @ (xdot - f)
    stored = spring @ stretch
    stretch += dt * (f - xdot)
    _slip(stretch[:3], k_t, slip_t)
    _slip(stretch[3:], k_r, slip_r)
    stored = k_t * (stretch[:3] @ stretch[:3]) + k_r * (stretch[3:] @ stretch[3:]) - stored
    state[6] = min(capacity, state[6] - 0.5 * stored)

    tau = np.minimum(limits, np.maximum(-limits, J.T @ force + bias + valve * pull - brake))
    last[0] = tau - bias
    last[1] = qd
    return tau
