"""`FitConfig`: every number that fitting a motion field takes, with its unit."""

from __future__ import annotations

from dataclasses import dataclass, fields

from symskill_pddl.errors import InputError


@dataclass(frozen=True)
class FitConfig:
    """How motion fields are fitted.

    Path and pace are kept apart: the matrices are fitted to the demonstrated *directions*, with a speed proportional to the
    way that remains (`gain_hz` times it), and the demonstrated *speed* enters as a cap that scales the field and never turns
    it. A slow end of a demonstration thus neither makes the execution crawl nor bends its path.
    """

    period_s: float = 0.1
    """Explicit Euler steps of this length at least are certified; a field's certificate says how long its own may be."""
    gain_hz: float = 3.0
    """Speed per remaining way [1/s]; its inverse is the time constant of the last centimetres."""
    rate_hz: float = 1.0
    """Certified rate alpha [1/s]: below the speed cap the distance in the metric P falls at least as exp(-alpha t)."""
    components: int = 8
    """Linear systems in a field; what the data do not need stays near the plain pull to the goal (`ridge`)."""
    samples: int = 80
    """Samples per demonstration, evenly spaced along its path."""
    smoothing_s: float = 0.05
    """Standard deviation of the Gaussian that smooths the recorded poses."""
    still_fraction: float = 0.01
    """Movements below this fraction of a demonstration's extent count as standing still."""
    min_motion_m: float = 1e-3
    min_rotation_rad: float = 0.01
    """Demonstrations that stay within these of their goal hold no path, only a goal."""
    in_place_m: float = 0.015
    """A hand that stays within this of its goal turns in place, however it wanders; its rotation waits for no position."""
    max_condition: float = 50.0
    """Largest condition number of the learned metric P."""
    spread: float = 0.06
    """Smallest standard deviation of a mixture component, as a fraction of the data's extent."""
    ridge: float = 1e-3
    """Weight of the plain pull to the goal, which decides in the directions that the data leaves open."""
    funnel: float = 0.03
    """Weight of the pull back to the path beside it, relative to the demonstrated directions."""
    funnel_gain: float = 3.0
    """How much faster than along the path the distance from it is to fall."""
    pace: float = 1.2
    """Speed cap over the demonstrated speed."""
    min_speed_m_s: float = 0.05
    min_speed_rad_s: float = 0.4
    """Smallest speed caps: a disturbed hand returns at least this fast."""
    tolerance_m: float = 0.004
    tolerance_rad: float = 0.087
    """A rollout may leave the demonstrations by this much, beyond their own spread, before the skill is split."""
    disturbance_m: float = 0.25
    final_m: float = 0.05
    """Also from starts that are this much aside, the last way into the goal has to lead through where the demonstrations went."""
    max_stray_m: float = 0.027
    """How far it may miss them before a via pose is set; infinite for motions that always start as demonstrated."""
    via_tolerance_m: float = 0.01
    via_tolerance_rad: float = 0.105
    """How close an intermediate goal of a split skill has to be reached."""
    max_fields: int = 10
    """Largest number of fields in sequence."""

    def __post_init__(self) -> None:
        for entry in fields(self):
            value = getattr(self, entry.name)
            if not value > 0:
                raise InputError(f"fit setting '{entry.name}' has to be positive, got {value!r}")
        if not self.rate_hz < self.gain_hz:
            raise InputError(f"the certified rate_hz ({self.rate_hz}) has to stay below gain_hz ({self.gain_hz})")
        if self.gain_hz * self.period_s >= 1.0:
            raise InputError(
                f"gain_hz {self.gain_hz} is too fast for steps of {self.period_s} s: their product has to stay below 1"
            )
        if self.max_condition < 1.0:
            raise InputError(f"max_condition has to be at least 1, got {self.max_condition}")
