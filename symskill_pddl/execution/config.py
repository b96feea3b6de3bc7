"""Every number of the execution, with its unit."""

from __future__ import annotations

from dataclasses import dataclass, field

from symskill_pddl.abstraction import DEBOUNCE_S
from symskill_pddl.errors import InputError


@dataclass(frozen=True)
class MotionConfig:
    """How skills are carried out.

    Attributes
    ----------
    max_speed, max_turn
        Caps of the commanded twist [m/s], [rad/s]; they scale it and never turn it.
    settle_speed, settle_min_s, settle_max_s
        The fingers have settled when the aperture changes more slowly than this [m/s], not before and at the latest after
        these times [s] since they were told to move.
    rest_speed, rest_turn, rest_s, loose
        A phase is also over when the hand has been at rest (slower than these [m/s], [rad/s], for this long [s]) within `loose`
        times the phase's tolerances: contact or the controller's compliance may keep it from the exact goal for ever.
    track : bool
        Whether the fields move with their objects; False leaves them where the objects were when the skill began.
    avoid, obstacle_limit, obstacle_clearance
        Whether to flow around other objects; the largest half size [m] of a type taken for an obstacle (walls and fixtures
        are no ellipsoids); what is added to the half sizes for the hand's own [m].
    hand : (float, float)
        Width of the hand along the opening of the fingers, and its length from the finger tips back [m].
    """

    max_speed: float = 0.6
    max_turn: float = 2.0
    settle_speed: float = 0.008
    settle_min_s: float = 0.2
    settle_max_s: float = 1.5
    rest_speed: float = 0.01
    rest_turn: float = 0.05
    rest_s: float = 0.4
    loose: float = 3.0
    track: bool = True
    avoid: bool = True
    obstacle_limit: float = 0.15
    obstacle_clearance: float = 0.04
    hand: tuple[float, float] = (0.16, 0.15)

    def __post_init__(self) -> None:
        for name in ("max_speed", "max_turn", "settle_speed", "settle_max_s", "rest_speed", "rest_turn", "rest_s"):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} has to be positive, got {getattr(self, name)!r}")
        if not 0 <= self.settle_min_s <= self.settle_max_s:
            raise InputError(f"settle_min_s has to be between 0 and settle_max_s = {self.settle_max_s}, got {self.settle_min_s}")
        if self.loose < 1:
            raise InputError(f"loose has to be at least 1, got {self.loose}")


@dataclass(frozen=True)
class ExecutionConfig:
    """Limits and times of a run.

    Attributes
    ----------
    max_replans, max_time_s
        The run fails beyond these; the time is the world's [s].
    plan_time_s : float
        Wall-clock limit of one call of the planner [s].
    debounce_s : float
        For how long an atom has to read otherwise before it changes [s]; the default is what learning uses.
    budget_factor, budget_margin_s
        A step may last ``budget_factor * longest demonstration + budget_margin_s`` [s].
    grace_s : float
        From the fall of a deleted atom to the effects [s]. For hinged and sliding things the demonstrated duration is added:
        they cannot be dropped, and a hand may let go of them and push on.
    stall_s, still_speed, still_turn
        A skill whose nominal twist is below these [m/s], [rad/s] for this long [s] has come to rest.
    blocked_s : float
        A hand that is told to move and has been at rest for this long [s] is blocked: it goes back before the next try.
    failure_cost : float
        Added to the cost of a ground step for each of its failures.
    sample_growth, sample_most : float
        The n-th retry samples its goal within ``n * sample_growth`` of the effect predicate's radii, at most `sample_most`: on
        the very edge of the predicate the smallest error would undo it.
    observe_s, quiet_s : float
        How long to stand still and look when there is no plan [s]; less where nothing has moved for `quiet_s`.
    retreat_m, back_off_m
        How far to go back along the own path, and along the hand's axis after opening the fingers [m].
    approach_s : float
        How long a hand may take on the straight way to where a step that was blocked begins the next time [s].
    assume : bool
        Whether to plan with the nearest known relation of an object that rests in none.
    resample : bool
        Whether a blamed step's goal is moved by a sample of its effect predicate; False tries the same motion again.
    replan : bool
        Whether to plan again when a plan is left. False keeps the first plan: a step that fails is tried again as long as its
        preconditions hold, and the run ends where they do not.
    motion : MotionConfig
    """

    max_replans: int = 20
    max_time_s: float = 900.0
    plan_time_s: float = 10.0
    debounce_s: float = DEBOUNCE_S
    budget_factor: float = 3.0
    budget_margin_s: float = 5.0
    grace_s: float = 1.0
    stall_s: float = 0.75
    blocked_s: float = 2.0
    still_speed: float = 0.005
    still_turn: float = 0.03
    failure_cost: float = 10.0
    sample_growth: float = 0.4
    sample_most: float = 0.8
    observe_s: float = 3.0
    quiet_s: float = 1.0
    retreat_m: float = 0.2
    back_off_m: float = 0.08
    approach_s: float = 6.0
    assume: bool = True
    resample: bool = True
    replan: bool = True
    motion: MotionConfig = field(default_factory=MotionConfig)

    def __post_init__(self) -> None:
        for name in (
            "max_time_s",
            "plan_time_s",
            "budget_factor",
            "still_speed",
            "still_turn",
            "sample_growth",
            "sample_most",
            "stall_s",
            "blocked_s",
            "approach_s",
        ):
            if not getattr(self, name) > 0:
                raise InputError(f"{name} has to be positive, got {getattr(self, name)!r}")
        for name in ("max_replans", "budget_margin_s", "grace_s", "failure_cost", "observe_s", "retreat_m", "back_off_m"):
            if not getattr(self, name) >= 0:
                raise InputError(f"{name} must not be negative, got {getattr(self, name)!r}")
        if self.debounce_s < 0.0:
            raise InputError(f"debounce_s has to be at least 0 s, got {self.debounce_s:g}")
