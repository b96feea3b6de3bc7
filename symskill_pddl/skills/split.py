"""From demonstrations to fields: one where one follows them, several in sequence where none can.

A stable field approaches its goal all the time. Demonstrations that first move away (down, below a shelf, up) cannot be
followed by one field; they are cut at a common via pose, and each part gets its own. Whether a field follows is judged by its
rollouts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, quat_conjugate, quat_multiply
from symskill_pddl.skills.config import FitConfig
from symskill_pddl.skills.field import Field, fit_field
from symskill_pddl.skills.following import deviation, retreat, strays
from symskill_pddl.skills.skill import Phase
from symskill_pddl.skills.trajectory import Trajectory, continuous_signs, evenly, smooth


@dataclass(frozen=True)
class FitReport:
    """How well the fields follow their demonstrations.

    Attributes
    ----------
    deviations : tuple of float
        Of each field's rollouts from its demonstrations, in units of the configured tolerances.
    durations_s : tuple of float
        Mean demonstrated duration of each field's part, pauses included.
    retreat : float
        Largest rise of the distance, or of the angle, to the end pose within a demonstration, as a fraction of its largest value;
        rises within the tolerances do not count. 0 is monotone.
    stray_m : float
        How far a single field would leave the demonstrations on the last way to the goal, from starts moved aside [m].
    """

    deviations: tuple[float, ...]
    durations_s: tuple[float, ...]
    retreat: float
    stray_m: float


def fit_fields(trajectories: Sequence[Trajectory], config: FitConfig = FitConfig()) -> tuple[Field, ...]:
    """Fields in sequence, each certified, the last one ending where the demonstrations end.

    Parameters
    ----------
    trajectories : sequence of Trajectory
        Demonstrations of the same motion in the same frame; starts and timing may differ.

    Raises
    ------
    InputError
        If there are none.
    CertificateError
        If no stable field can be fitted.
    """
    return fit_reported(trajectories, config)[0]


def fit_phases(
    trajectories: Sequence[Trajectory],
    frame: str,
    close_gripper: bool,
    tolerance_p: float,
    tolerance_r: float,
    config: FitConfig = FitConfig(),
) -> tuple[Phase, ...]:
    """The fields as phases: loose tolerances from the configuration in between, the given ones [m], [rad] at the end."""
    fields, report = fit_reported(trajectories, config)
    last = len(fields) - 1
    return tuple(
        Phase(
            frame,
            field,
            close_gripper,
            tolerance_p if i == last else config.via_tolerance_m,
            tolerance_r if i == last else config.via_tolerance_rad,
            duration,
        )
        for i, (field, duration) in enumerate(zip(fields, report.durations_s, strict=True))
    )


def fit_reported(trajectories: Sequence[Trajectory], config: FitConfig = FitConfig()) -> tuple[tuple[Field, ...], FitReport]:
    """`fit_fields` with the report that says how well they follow."""
    if not trajectories:
        raise InputError("fitting a field needs at least one trajectory")
    whole = _Part.fit([smooth(t, config.smoothing_s) for t in trajectories], config)
    parts = [whole] if whole.deviation <= 1.0 else _split(whole, config)
    stray = strays(whole.field, whole.trajectories, whole.shown, config)
    if len(parts) == 1 and stray > config.max_stray_m and config.max_fields > 1:
        rough = whole.halves(_rough(config), apart=config.final_m / config.tolerance_m)
        if rough is not None:
            halves = [_Part.fit(part.trajectories, config) for part in rough]
            if _worst(halves) <= max(1.0, whole.deviation):
                parts = halves
    report = FitReport(
        tuple(p.deviation for p in parts),
        tuple(float(np.mean([t.duration_s for t in p.trajectories])) for p in parts),
        max(retreat(way[:, block]) for way in whole.shown for block in (slice(0, 3), slice(3, 6))),
        stray,
    )
    return tuple(p.field for p in parts), report


def _split(whole: _Part, config: FitConfig) -> list[_Part]:
    """The fewest fields that follow; where none do, the fewest that follow nearly as well as the best."""
    rough = _rough(config)
    sequences, hopeless = [[whole]], set[_Part]()
    while len(sequences) < config.max_fields:
        parts = sequences[-1]
        worst = max((p for p in parts if p not in hopeless), key=lambda p: p.deviation, default=None)
        if worst is None or worst.deviation <= 1.0:
            break
        halves = worst.halves(rough)
        if halves is None or _worst(halves) > worst.deviation:
            hopeless.add(worst)
            continue
        at = parts.index(worst)
        sequences.append([*parts[:at], *halves, *parts[at + 1 :]])
    enough = max(1.0, 1.4 * min(_worst(parts) for parts in sequences))
    found = next(parts for parts in sequences if _worst(parts) <= enough)
    return [part if part is whole else _Part.fit(part.trajectories, config) for part in found]


def _rough(config: FitConfig) -> FitConfig:
    """The search for a place to cut needs no more than rough fits; what it finds is fitted anew."""
    return replace(config, components=min(3, config.components), samples=min(25, config.samples))


@dataclass(frozen=True, eq=False)
class _Part:
    """A stretch of the demonstrations with its field.

    `shown` (demos, samples, 6): error to the goal in units of the tolerances, evenly spaced along the way; `at` (demos,
    samples): the trajectory index of each sample. Demonstrations that stay at the goal are left out of both.
    """

    trajectories: list[Trajectory]
    field: Field
    shown: Array
    at: Array
    deviation: float

    @classmethod
    def fit(cls, trajectories: list[Trajectory], config: FitConfig) -> _Part:
        field = fit_field(trajectories, config)
        shown, at = [], []
        for trajectory in trajectories:
            x = _scaled_errors(trajectory.T_frame_ee.p, continuous_signs(trajectory.T_frame_ee.q), field, config)
            even = evenly(x, config.still_fraction, 0.1, config.samples)
            if even is None:
                even = np.zeros((config.samples, 6)), np.zeros(config.samples, dtype=int)
            shown.append(even[0])
            at.append(even[1])
        ways = np.stack(shown)
        return cls(trajectories, field, ways, np.stack(at), deviation(field, trajectories, ways, config))

    def halves(self, config: FitConfig, apart: float = 0.0) -> tuple[_Part, _Part] | None:
        """The best two parts, the via pose at least `apart` tolerances before the goal; None where there is no place to cut."""
        best: tuple[_Part, _Part] | None = None
        for index in self._candidates():
            if np.linalg.norm(self.shown[:, index, :3].mean(0)) < apart:
                continue
            cuts = [int(at[i]) for at, i in zip(self.at, self._matches(index), strict=True)]
            if all(0 < cut < len(t) - 1 for cut, t in zip(cuts, self.trajectories, strict=True)):
                first = [t.cut(0, cut) for t, cut in zip(self.trajectories, cuts, strict=True)]
                second = [t.cut(cut, len(t) - 1) for t, cut in zip(self.trajectories, cuts, strict=True)]
                halves = _Part.fit(first, config), _Part.fit(second, config)
                if best is None or sum(p.deviation for p in halves) < sum(p.deviation for p in best):
                    best = halves
        return best

    def _candidates(self) -> list[int]:
        """Samples of the mean way where a via pose may help: corner and farthest point, moving and turning, and the middle."""
        mean = self.shown.mean(0)
        n = len(mean)
        inner = slice(n // 12, n - n // 12)
        found = []
        for way in (mean[:, :3], mean[:, 3:]):
            if np.ptp(way, axis=0).max() > 1.0:
                chord = way[-1] - way[0]
                along = np.clip((way - way[0]) @ chord / max(float(chord @ chord), 1e-12), 0.0, 1.0)
                corner = np.linalg.norm(way - way[0] - along[:, None] * chord, axis=1)
                found += [int(np.argmax(values[inner])) + inner.start for values in (corner, np.linalg.norm(way, axis=1))]
        kept: list[int] = []
        for index in [*found, n // 2]:
            if all(abs(index - other) > n // 20 for other in kept):
                kept.append(index)
        return kept

    def _matches(self, index: int) -> list[int]:
        """For each demonstration the sample nearest to the mean way's, among those of similar progress."""
        via = self.shown[:, index].mean(0)
        n = self.shown.shape[1]
        low, high = max(1, index - n // 7), min(n - 1, index + n // 7)
        return [low + int(np.argmin(np.linalg.norm(way[low:high] - via, axis=1))) for way in self.shown]


def _worst(parts: Sequence[_Part]) -> float:
    return max(p.deviation for p in parts)


def _scaled_errors(p: Array, q: Array, field: Field, config: FitConfig) -> Array:
    """(..., 6) errors to the goal in units of the tolerances; rotations do not wrap along a path of continuous signs."""
    goal = field.orientation.goal
    relative = quat_multiply(q, quat_conjugate(goal))
    if relative.ndim > 1 and relative[-1, 0] < 0:
        relative = -relative
    w, u = relative[..., :1], relative[..., 1:]
    norm = np.linalg.norm(u, axis=-1, keepdims=True)
    r = np.where(norm > 1e-12, 2.0 * np.arctan2(norm, w) / np.maximum(norm, 1e-12), 2.0) * u
    return np.concatenate([(p - field.position.goal) / config.tolerance_m, r / config.tolerance_rad], axis=-1)
