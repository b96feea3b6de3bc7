"""`Phase` and `Skill`: fields in sequence, each in the frame of an operator's parameter, with the fingers' command."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import dist
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.errors import CertificateError, FormatError, InputError
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.skills import scalar
from symskill_pddl.skills.field import Field
from symskill_pddl.skills.lpv import Lpv
from symskill_pddl.skills.mixture import Mixture
from symskill_pddl.skills.orientation import OrientationField
from symskill_pddl.skills.pairing import Pairing
from symskill_pddl.skills.position import PositionField

UNSHIFTED = Pose.identity()
"""A field where it was learned."""


@dataclass(frozen=True, eq=False)
class Phase:
    """One field of a skill.

    Attributes
    ----------
    frame : str
        The operator's parameter ("?food") in whose frame the field lives.
    field : Field
        The twist field.
    close_gripper : bool
        Finger command during the phase.
    tolerance_p, tolerance_r : float
        The phase is over within these of the field's goal [m], [rad].
    duration_s : float
        Mean demonstrated duration.
    """

    frame: str
    field: Field
    close_gripper: bool
    tolerance_p: float
    tolerance_r: float
    duration_s: float

    def __post_init__(self) -> None:
        for name in ("tolerance_p", "tolerance_r"):
            if not getattr(self, name) > 0:
                raise InputError(f"a phase in frame '{self.frame}' needs a positive {name}, got {getattr(self, name)!r}")
        if not (np.isfinite(self.duration_s) and self.duration_s >= 0):
            raise InputError(f"a phase in frame '{self.frame}' needs a duration of at least 0 s, got {self.duration_s!r}")

    def twist(self, T_world_frame: Pose, T_world_ee: Pose, shift: Pose = UNSHIFTED) -> Array:
        """Twist (6,) in world axes.

        `shift` moves the whole field, and with it the goal, within its frame: the field acts on `shift^-1 @ T_frame_ee`.
        """
        base_p, base_q = _base(T_world_frame, shift)
        p, q = scalar.floats(T_world_ee)
        inverse = scalar.conjugate(base_q)
        relative = scalar.rotate(inverse, (p[0] - base_p[0], p[1] - base_p[1], p[2] - base_p[2]))
        twist = self.field.twist_at(np.array(relative), np.array(scalar.multiply(inverse, q))).tolist()
        return np.array(scalar.rotate(base_q, twist[:3]) + scalar.rotate(base_q, twist[3:]))

    def T_world_goal(self, T_world_frame: Pose, shift: Pose = UNSHIFTED) -> Pose:
        """Where the phase ends, in the world."""
        return T_world_frame @ shift @ self.field.T_goal

    def goal_p(self, T_world_frame: Pose, shift: Pose = UNSHIFTED) -> scalar.Vector:
        """The position of `T_world_goal` [m]."""
        base_p, base_q = _base(T_world_frame, shift)
        return _plus(base_p, scalar.rotate(base_q, scalar.floats(self.field.T_goal)[0]))

    def reached(self, T_world_frame: Pose, T_world_ee: Pose, shift: Pose = UNSHIFTED, *, scale: float = 1.0) -> bool:
        """Whether the end effector is within `scale` times the tolerances of the phase's end."""
        base_p, base_q = _base(T_world_frame, shift)
        (p, q), goal = scalar.floats(T_world_ee), scalar.floats(self.field.T_goal)
        goal_p, goal_q = _plus(base_p, scalar.rotate(base_q, goal[0])), scalar.multiply(base_q, goal[1])
        return dist(p, goal_p) <= self.tolerance_p * scale and scalar.angle(q, goal_q) <= self.tolerance_r * scale


def _base(T_world_frame: Pose, shift: Pose) -> tuple[scalar.Vector, scalar.Quaternion]:
    """The pose of a field's frame, shifted within itself."""
    p, q = scalar.floats(T_world_frame)
    if shift is UNSHIFTED:
        return p, q
    shift_p, shift_q = scalar.floats(shift)
    return _plus(p, scalar.rotate(q, shift_p)), scalar.multiply(q, shift_q)


def _plus(a: scalar.Vector, b: scalar.Vector) -> scalar.Vector:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@dataclass(frozen=True, eq=False)
class Skill:
    """Phases in order, and what the fingers do at the end of the last one.

    When the finger command changes from one phase to the next, or at the end, the executor waits until the fingers settle.
    """

    phases: tuple[Phase, ...]
    close_gripper_at_end: bool

    def __post_init__(self) -> None:
        object.__setattr__(self, "phases", tuple(self.phases))
        if not self.phases:
            raise InputError("a skill needs at least one phase")

    @property
    def max_period_s(self) -> float:
        """Control periods below this [s] are certified for all phases."""
        return min(phase.field.max_period_s for phase in self.phases)

    def arrays(self) -> dict[str, NDArray[Any]]:
        """Everything as plain arrays, without pickle: `Skill.from_arrays` gives back an equal skill, bit by bit."""
        out: dict[str, NDArray[Any]] = {
            "phases": np.array(len(self.phases)),
            "close_gripper_at_end": np.array(self.close_gripper_at_end),
        }
        for i, phase in enumerate(self.phases):
            key = f"phase{i}"
            out[f"{key}.frame"] = np.array(phase.frame)
            out[f"{key}.close_gripper"] = np.array(phase.close_gripper)
            out[f"{key}.limits"] = np.array([phase.tolerance_p, phase.tolerance_r, phase.duration_s])
            out[f"{key}.pairing.sizes"] = np.array([phase.field.pairing.reach, phase.field.pairing.turn])
            out[f"{key}.pairing.difference"] = phase.field.pairing.difference
            parts: tuple[tuple[str, PositionField | OrientationField], ...] = (
                ("position", phase.field.position),
                ("orientation", phase.field.orientation),
            )
            for (name, part), certificate in zip(parts, phase.field.certificates, strict=True):
                mixture = part.lpv.mixture
                out[f"{key}.{name}.goal"] = part.goal
                out[f"{key}.{name}.matrices"] = part.lpv.matrices
                out[f"{key}.{name}.pace"] = part.lpv.pace
                out[f"{key}.{name}.whitening"] = mixture.whitening
                out[f"{key}.{name}.offset"] = mixture.offset
                out[f"{key}.{name}.log_scale"] = mixture.log_scale
                out[f"{key}.{name}.certificate"] = np.array([certificate.rate_hz, certificate.max_period_s])
            out[f"{key}.position.metric"] = phase.field.P
        return out

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[Any]]) -> Skill:
        """The inverse of `arrays`. Every field is certified anew, and has to keep what the file claims of it.

        Raises
        ------
        FormatError
            If an array is missing or has another shape, or a field is less stable than claimed.
        """
        try:
            phases = tuple(_phase(arrays, f"phase{i}") for i in range(int(arrays["phases"])))
            return cls(phases, bool(arrays["close_gripper_at_end"]))
        except KeyError as error:
            raise FormatError(f"a skill's file lacks the array {error}") from None
        except CertificateError as error:
            raise FormatError(f"a skill's file holds a field that is not what was certified: {error}") from None
        except (InputError, IndexError, TypeError, ValueError) as error:
            raise FormatError(f"a skill's file holds arrays that do not fit together: {error}") from None


def _phase(arrays: Mapping[str, NDArray[Any]], key: str) -> Phase:
    def lpv(name: str) -> Lpv:
        mixture = Mixture(arrays[f"{name}.whitening"], arrays[f"{name}.offset"], arrays[f"{name}.log_scale"])
        return Lpv(mixture, arrays[f"{name}.matrices"], arrays[f"{name}.pace"])

    position, orientation = f"{key}.position", f"{key}.orientation"
    reach, turn = (float(value) for value in arrays[f"{key}.pairing.sizes"])
    pairing = Pairing(reach, turn, arrays[f"{key}.pairing.difference"])
    field = Field(
        PositionField(lpv(position), arrays[f"{position}.goal"]),
        OrientationField(lpv(orientation), arrays[f"{orientation}.goal"]),
        arrays[f"{position}.metric"],
        pairing,
    )
    for name, certificate in zip((position, orientation), field.certificates, strict=True):
        claimed = arrays[f"{name}.certificate"]
        if claimed.shape != (2,):
            raise InputError(f"'{name}.certificate' has the form {claimed.shape} of another version; learn the library again")
        certificate.demand(float(claimed[0]), float(claimed[1]), slack=1e-6)
    tolerance_p, tolerance_r, duration = (float(value) for value in arrays[f"{key}.limits"])
    return Phase(str(arrays[f"{key}.frame"]), field, bool(arrays[f"{key}.close_gripper"]), tolerance_p, tolerance_r, duration)
