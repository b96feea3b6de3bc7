"""Pictures of a skill, one for each phase: demonstrations, mixture, field, rollouts and attractor, as the paper draws its Op3."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.errors import MissingDependencyError
from symskill_pddl.geometry import Array, Pose
from symskill_pddl.skills import Field, Phase, Skill, Trajectory, rollout

_DEMO, _ROLLOUT, _MIXTURE, _GOAL = "0.45", "#c1272d", "#2f6db3", "#111111"
_PERIOD_S = 0.05
_GRID = 30
_MARGIN_CM = 6.0


def skill_pictures(name: str, skill: Skill, shown: Sequence[Sequence[Trajectory]]) -> tuple[bytes, ...]:
    """One PNG for each phase.

    Parameters
    ----------
    shown : sequence of sequences of Trajectory
        For each phase the demonstrated motions in its frame; a phase may have none.

    Raises
    ------
    MissingDependencyError
        If matplotlib is not installed.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingDependencyError("pictures of skills need matplotlib: pip install 'symskill-pddl[plots]'") from error

    pictures: list[bytes] = []
    driven: Pose | None = None
    rest: Sequence[Trajectory] = ()
    for i, phase in enumerate(skill.phases):
        # a field that takes over in the same frame starts where the one before it ended, as shown and as driven
        follows = i > 0 and _same_motion(skill.phases[i - 1], phase)
        demos = rest if follows else shown[i]
        if i + 1 < len(skill.phases) and _same_motion(phase, skill.phases[i + 1]):
            cuts = [_nearest(phase, d) for d in demos]
            rest = [d.cut(cut, len(d) - 1) for d, cut in zip(demos, cuts, strict=True)]
            demos = [d.cut(0, cut) for d, cut in zip(demos, cuts, strict=True)]
        if not follows or driven is None:
            driven = Pose.stack([d.T_frame_ee[0] for d in demos]) if demos else None
        way = None if driven is None else _until(phase, rollout(phase.field, driven, 1.5 * _longest(phase, demos), _PERIOD_S))
        driven = None if way is None else way[:, -1]
        figure = Figure(figsize=(11.0, 9.5), layout="constrained")
        FigureCanvasAgg(figure)
        _draw(figure, f"{name}, phase {i + 1} of {len(skill.phases)}", phase, demos, way)
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png", dpi=100, metadata={"Software": "symskill"})
        pictures.append(buffer.getvalue())
    return tuple(pictures)


def _same_motion(a: Phase, b: Phase) -> bool:
    return (a.frame, a.close_gripper) == (b.frame, b.close_gripper)


def _nearest(phase: Phase, demo: Trajectory) -> int:
    """The sample nearest to the phase's end, in its tolerances."""
    off = np.linalg.norm(demo.T_frame_ee.p - phase.field.T_goal.p, axis=-1) / phase.tolerance_p
    turned = np.linalg.norm(phase.field.orientation.error(demo.T_frame_ee.q), axis=-1) / phase.tolerance_r
    return int(np.argmin(off + turned))


def _longest(phase: Phase, demos: Sequence[Trajectory]) -> float:
    return max([phase.duration_s, 1.0, *(d.duration_s for d in demos)])


def _until(phase: Phase, way: Pose) -> Pose:
    """Rollouts (n, t), held where each has reached the phase's end, as the executor would."""
    goal = phase.field.T_goal
    p, q = way.p.copy(), way.q.copy()
    for i in range(len(p)):
        near = np.linalg.norm(p[i] - goal.p, axis=-1) <= phase.tolerance_p
        near &= np.linalg.norm(phase.field.orientation.error(q[i]), axis=-1) <= phase.tolerance_r
        if near.any():
            first = int(np.argmax(near))
            p[i, first:], q[i, first:] = p[i, first], q[i, first]
    return Pose(p, q)


def _draw(figure: Any, title: str, phase: Phase, demos: Sequence[Trajectory], way: Pose | None) -> None:
    field = phase.field
    axes = figure.subplots(2, 2)
    points = [d.T_frame_ee.p for d in demos] or [field.T_goal.p[None]]
    everything = np.concatenate([*points, field.T_goal.p[None], *([] if way is None else [way.p.reshape(-1, 3)])])
    # the two planes that show most: of the widest axis with each of the others
    widest, second, third = np.argsort(-np.ptp(everything, axis=0), kind="stable")
    for ax, plane in ((axes[0, 0], (widest, second)), (axes[0, 1], (widest, third))):
        _plane(ax, field, sorted(plane), demos, way, everything)
    axes[0, 0].legend(loc="best", fontsize=8, framealpha=0.9)
    goal = field.T_goal.p
    _over_time(axes[1, 0], demos, way, lambda T: 100.0 * np.linalg.norm(T.p - goal, axis=-1))
    _limit(axes[1, 0], 100.0 * phase.tolerance_p, f"done within {100.0 * phase.tolerance_p:.1f} cm")
    axes[1, 0].set_ylabel("distance to the goal [cm]")
    _over_time(axes[1, 1], demos, way, lambda T: np.degrees(np.linalg.norm(field.orientation.error(T.q), axis=-1)))
    _limit(axes[1, 1], np.degrees(phase.tolerance_r), f"done within {np.degrees(phase.tolerance_r):.1f} deg")
    axes[1, 1].set_ylabel("orientation error [deg]")
    of_p, of_q = field.certificates
    fingers = "closed" if phase.close_gripper else "open"
    figure.suptitle(f"{title}\nframe of {phase.frame}, fingers {fingers}", fontsize=12)
    sizes = f"{field.position.lpv.mixture.size} and {field.orientation.lpv.mixture.size} linear systems"
    figure.supxlabel(
        f"certified: position error falls at {of_p.rate_hz:.2f} /s or faster, orientation at {of_q.rate_hz:.2f} /s "
        f"(below the speed caps of {field.position.max_speed:.2f} m/s, {field.orientation.max_speed:.2f} rad/s)\n"
        f"for control periods below {1000.0 * field.max_period_s:.0f} ms; "
        f"cond P = {np.linalg.cond(of_p.P):.1f}; {sizes}",
        fontsize=9,
    )


def _plane(ax: Any, field: Field, plane: Sequence[int], demos: Sequence[Trajectory], way: Pose | None, everything: Array) -> None:
    from matplotlib.patches import Ellipse

    i, j = plane
    low, high = 100.0 * everything[:, plane].min(0) - _MARGIN_CM, 100.0 * everything[:, plane].max(0) + _MARGIN_CM
    # at least a third as high as wide, so that a flat motion is still seen
    room = np.maximum(0.0, (high - low).max() / 3.0 - (high - low)) / 2.0
    low, high = low - room, high + room
    u, w = (np.linspace(low[k], high[k], _GRID) for k in (0, 1))
    U, W = np.meshgrid(u, w)
    x = np.zeros((_GRID * _GRID, 3))
    x[:, i], x[:, j] = 0.01 * U.ravel(), 0.01 * W.ravel()
    # the coordinate across the plane is that of the nearest demonstrated point: the slice goes along with the motion
    third = ({0, 1, 2} - {i, j}).pop()
    known = everything[:: max(1, len(everything) // 1500)]
    x[:, third] = known[((x[:, None, plane] - known[None][:, :, plane]) ** 2).sum(-1).argmin(1), third]
    v = field.position.velocity(x)
    speed = np.linalg.norm(v, axis=-1).reshape(U.shape)
    flow = (v[:, k].reshape(U.shape) for k in (i, j))
    ax.streamplot(U, W, *flow, color="#b9cde3", linewidth=0.4 + 1.4 * speed / max(speed.max(), 1e-9), density=1.3, arrowsize=0.7)
    for n, (centre, covariance) in enumerate(_gaussians(field)):
        values, vectors = np.linalg.eigh(covariance[np.ix_(plane, plane)])
        angle = np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1]))
        width, height = (400.0 * float(np.sqrt(value)) for value in values[::-1])  # two standard deviations to each side, in cm
        label = "mixture (2 standard deviations)" if n == 0 else None
        ax.add_patch(
            Ellipse(
                (100.0 * centre[i], 100.0 * centre[j]),
                width,
                height,
                angle=angle,
                fill=False,
                ec=_MIXTURE,
                lw=1.4,
                label=label,
                zorder=3,
            )
        )
    for n, demo in enumerate(demos):
        p = 100.0 * demo.T_frame_ee.p
        ax.plot(p[:, i], p[:, j], color=_DEMO, lw=1.0, label="demonstrations" if n == 0 else None, zorder=2)
    if way is not None:
        for n, p in enumerate(100.0 * way.p):
            ax.plot(p[:, i], p[:, j], color=_ROLLOUT, lw=1.2, label="rollouts" if n == 0 else None, zorder=4)
            ax.plot(p[0, i], p[0, j], "o", color=_ROLLOUT, ms=3.5, label="starts" if n == 0 else None, zorder=4)
    goal = 100.0 * field.T_goal.p
    ax.plot(goal[i], goal[j], "*", color=_GOAL, ms=13, label="attractor", zorder=5)
    ax.set(xlabel=f"{'xyz'[i]} [cm]", ylabel=f"{'xyz'[j]} [cm]", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    ax.set_aspect("equal")


def _gaussians(field: Field) -> list[tuple[Array, Array]]:
    """Means (3,) and covariances (3, 3) of the position's mixture, in the field's frame; none of a single component."""
    mixture = field.position.lpv.mixture
    if mixture.size == 1:
        return []
    found: list[tuple[Array, Array]] = []
    for W, offset in zip(mixture.whitening.reshape(-1, 3, 3), mixture.offset.reshape(-1, 3), strict=True):
        inverse = np.linalg.inv(W)
        found.append((np.asarray(inverse @ offset + field.position.goal), np.asarray(inverse @ inverse.T)))
    return found


def _over_time(ax: Any, demos: Sequence[Trajectory], way: Pose | None, value: Any) -> None:
    for demo in demos:
        ax.plot(demo.times - demo.times[0], value(demo.T_frame_ee), color=_DEMO, lw=1.0)
    if way is not None:
        for T in (way[k] for k in range(len(way))):
            series: NDArray[np.float64] = value(T)
            still = np.flatnonzero(np.abs(np.diff(series)) > 0)
            stop = int(still[-1]) + 2 if len(still) else 1
            ax.plot(_PERIOD_S * np.arange(stop), series[:stop], color=_ROLLOUT, lw=1.2)
    ax.set(xlabel="time [s]", xlim=(0, None), ylim=(0, None))
    ax.grid(alpha=0.3)


def _limit(ax: Any, at: float, label: str) -> None:
    ax.axhline(at, color=_GOAL, lw=0.9, ls="--", label=label)
    ax.legend(loc="upper right", fontsize=8)
