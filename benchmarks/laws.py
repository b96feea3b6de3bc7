"""Laws of learning: what is learned does not change when recordings change in ways that mean nothing.

    python benchmarks/laws.py [FILES...] [--only CHANGE ...] [-o docs/benchmarks-laws.md]

FILES are demonstrations, or recordings of robosuite (HDF5), imported as they are; without any, the recordings of people in
tests/data and the shipped demonstrations, two of each task, and play. The demonstrations of a file are changed and learned
again; a cell of the table says "same" if the operators, their effects and preconditions and the goals are the same as
unchanged, up to the names of types, and otherwise what differs. What moves, seen as (object, held or pushed), is compared
first: where it differs, all else has to.
"""

from __future__ import annotations

import argparse
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import symskill_pddl
from symskill_pddl.cli.work import shipped_demos
from symskill_pddl.demos import Demo, import_robosuite, load_demos
from symskill_pddl.demos.noise import without_freezes
from symskill_pddl.errors import InputError, SymSkillError
from symskill_pddl.files import write_atomic
from symskill_pddl.geometry import Array, Pose, quat_exp, quat_multiply
from symskill_pddl.learning import learn_symbols
from symskill_pddl.symbols import Atom

ROOT = Path(__file__).parents[1]
Change = Callable[[Demo, np.random.Generator], Demo]


# -- changes ---------------------------------------------------------------------------------------------------------------


def turned_frames(demo: Demo, _: np.random.Generator) -> Demo:
    """Every type's frame turned and shifted by a constant, the same in all demonstrations; extents are no longer known."""
    parts = []
    for obj, type_ in demo.objects.items():
        own = np.random.default_rng(list(type_.encode()))
        parts.append(demo.pose(obj) @ Pose.from_rotvec(own.uniform(-0.05, 0.05, 3), own.uniform(-2.0, 2.0, 3)))
    T = Pose(np.stack([P.p for P in parts], axis=1), np.stack([P.q for P in parts], axis=1))
    return replace(demo, T_world_objects=T, extents={})


def moved_world(demo: Demo, _: np.random.Generator) -> Demo:
    """Another world frame, turned about the vertical."""
    T = Pose.from_rotvec([1.0, -2.0, 0.3], [0.0, 0.0, 1.2])
    return replace(demo, T_world_ee=T @ demo.T_world_ee, T_world_objects=T @ demo.T_world_objects)


def at_rate(hz: float) -> Change:
    """Sampled anew: the nearest samples, or poses between two."""

    def change(demo: Demo, _: np.random.Generator) -> Demo:
        times = np.arange(demo.times[0], demo.times[-1], 1.0 / hz)
        right = np.clip(np.searchsorted(demo.times, times), 1, len(demo) - 1)
        left = right - 1
        s = ((times - demo.times[left]) / (demo.times[right] - demo.times[left]))[:, None]
        nearest = np.where(s[:, 0] < 0.5, left, right)

        def between(T: Pose) -> Pose:
            w = s if T.p.ndim == 2 else s[:, None]
            turn = (T[left].inverse() @ T[right]).rotvec()
            return Pose(T.p[left] + w * (T.p[right] - T.p[left]), quat_multiply(T.q[left], quat_exp(w * turn)))

        return replace(
            demo,
            times=times,
            T_world_ee=between(demo.T_world_ee),
            T_world_objects=between(demo.T_world_objects),
            aperture=demo.aperture[left] + s[:, 0] * (demo.aperture[right] - demo.aperture[left]),
            gripper_closed=demo.gripper_closed[nearest],
            seen=demo.seen[nearest],
        )

    return change


def at_speed(factor: float) -> Change:
    """Everything `factor` times as fast."""
    return lambda demo, _: replace(demo, times=demo.times / factor)


def at_size(factor: float) -> Change:
    """Everything `factor` times as large, the hand too."""

    def change(demo: Demo, _: np.random.Generator) -> Demo:
        return replace(
            demo,
            T_world_ee=Pose(factor * demo.T_world_ee.p, demo.T_world_ee.q),
            T_world_objects=Pose(factor * demo.T_world_objects.p, demo.T_world_objects.q),
            aperture=factor * demo.aperture,
            extents={t: (factor * a, factor * b, factor * c) for t, (a, b, c) in demo.extents.items()},
        )

    return change


def jittered(mm: float, deg: float) -> Change:
    """Every object's pose off from sample to sample."""

    def change(demo: Demo, rng: np.random.Generator) -> Demo:
        return _off(
            demo, rng.normal(0.0, mm / 1000, (*demo.seen.shape, 3)), rng.normal(0.0, np.radians(deg), (*demo.seen.shape, 3))
        )

    return change


def offset(demo: Demo, rng: np.random.Generator) -> Demo:
    """Every object's tracker off by a constant of 5 mm and 2 degrees, another one in each demonstration."""
    directions = rng.normal(size=(2, 1, demo.seen.shape[1], 3))
    directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
    return _off(demo, 0.005 * directions[0], np.radians(2.0) * directions[1])


def _off(demo: Demo, p: Array, r: Array) -> Demo:
    T = demo.T_world_objects
    return replace(demo, T_world_objects=Pose(T.p + p, quat_multiply(T.q, quat_exp(np.broadcast_to(r, T.p.shape)))))


def gaps(demo: Demo, rng: np.random.Generator) -> Demo:
    """Five percent of the poses are missing, in gaps of up to half a second."""
    seen = demo.seen.copy()
    for k in range(seen.shape[1]):
        while seen[:, k].mean() > 0.95:
            first = int(rng.integers(len(demo)))
            seen[first : int(np.searchsorted(demo.times, demo.times[first] + rng.uniform(0.1, 0.5))), k] = False
    return replace(demo, seen=seen)


def frozen(demo: Demo, rng: np.random.Generator) -> Demo:
    """A jitter of 1 mm and 0.4 degrees, and five percent of the poses stand still for up to a second."""
    demo = jittered(1.0, 0.4)(demo, rng)
    seen = demo.seen.copy()
    for k in range(seen.shape[1]):
        while seen[:, k].mean() > 0.95:
            first = int(rng.integers(len(demo)))
            seen[first : int(np.searchsorted(demo.times, demo.times[first] + rng.uniform(0.3, 1.0))), k] = False
    held = replace(demo, seen=seen)
    return replace(held, seen=demo.seen)


def bystanders(demo: Demo, _: np.random.Generator) -> Demo:
    """Ten still things of three types, half a metre and more away from everything."""
    T, objects = demo.T_world_objects, dict(demo.objects)
    middle = demo.T_world_ee.p.mean(axis=0)
    for k in range(10):
        angle = 2 * np.pi * k / 10
        at = Pose(middle + np.array([1.5 * np.cos(angle), 1.5 * np.sin(angle), 0.0]), quat_exp([0.0, 0.0, angle]))
        T = _with(T, Pose(np.tile(at.p, (len(demo), 1)), np.tile(at.q, (len(demo), 1))))
        objects[f"bystander-{k}"] = f"zz-bystander-{'abc'[k % 3]}"
    return _with_objects(demo, objects, T)


def moved_by_others(demo: Demo, rng: np.random.Generator) -> Demo:
    """Three things that somebody else moves now and then, a metre away."""
    T, objects = demo.T_world_objects, dict(demo.objects)
    middle = demo.T_world_ee.p.mean(axis=0)
    for k in range(3):
        goals = rng.uniform(-0.3, 0.3, (8, 3)) * [1.0, 1.0, 0.0]
        s = np.clip((np.linspace(0.0, 7.0, len(demo)) % 1.0) * 4.0, 0.0, 1.0)[:, None]
        n = np.minimum(np.linspace(0.0, 7.0, len(demo)).astype(int), 6)
        p = middle + [0.0, 1.5 * (k - 1) + 0.7, 0.0] + goals[n] + s * (goals[n + 1] - goals[n])
        T = _with(T, Pose(p, np.tile([1.0, 0.0, 0.0, 0.0], (len(demo), 1))))
        objects[f"other-{k}"] = "zz-others-thing"
    return _with_objects(demo, objects, T)


def _with(T: Pose, more: Pose) -> Pose:
    return Pose(np.concatenate([T.p, more.p[:, None]], axis=1), np.concatenate([T.q, more.q[:, None]], axis=1))


def _with_objects(demo: Demo, objects: dict[str, str], T: Pose) -> Demo:
    return replace(demo, objects=objects, T_world_objects=T, seen=np.ones(T.p.shape[:2], bool))


def renamed(demo: Demo, _: np.random.Generator) -> Demo:
    """Objects and types renamed, and in another order."""
    order = list(reversed(range(len(demo.objects))))
    names = list(demo.objects.items())
    return replace(
        demo,
        objects={f"x{i}-{names[i][0]}": f"{_turned(names[i][1])}" for i in order},
        T_world_objects=demo.T_world_objects[:, order],
        seen=demo.seen[:, order],
        extents={_turned(t): e for t, e in demo.extents.items()},
    )


def _turned(type_: str) -> str:
    return "z-" + type_


def paused(demo: Demo, rng: np.random.Generator) -> Demo:
    """A second of standing still, five times."""
    at = np.sort(rng.integers(1, len(demo) - 1, 5))
    dt = float(np.median(np.diff(demo.times)))
    index = np.concatenate([np.arange(len(demo)), np.repeat(at, round(1.0 / dt))])
    index.sort()
    return replace(
        demo,
        times=np.arange(len(index)) * dt,
        T_world_ee=demo.T_world_ee[index],
        T_world_objects=demo.T_world_objects[index],
        aperture=demo.aperture[index],
        gripper_closed=demo.gripper_closed[index],
        seen=demo.seen[index],
    )


CHANGES: dict[str, Change] = {
    "frames turned, no extents": turned_frames,
    "another world frame": moved_world,
    "5 Hz": at_rate(5.0),
    "10 Hz": at_rate(10.0),
    "60 Hz": at_rate(60.0),
    "240 Hz": at_rate(240.0),
    "x 0.25 in speed": at_speed(0.25),
    "x 4 in speed": at_speed(4.0),
    "x 0.3 in size": at_size(0.3),
    "x 3 in size": at_size(3.0),
    "10 bystanders": bystanders,
    "3 things that others move": moved_by_others,
    "0.5 mm, 0.2 deg of jitter": jittered(0.5, 0.2),
    "1 mm, 1 deg": jittered(1.0, 1.0),
    "3 mm, 2 deg": jittered(3.0, 2.0),
    "5 mm, 2 deg of offset": offset,
    "5 % missing": gaps,
    "5 % frozen, 1 mm": frozen,
    "renamed and reordered": renamed,
    "five pauses": paused,
}


# -- what is learned -------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Learned:
    """What has to stay the same: `moves` are counts of (type, held) by demonstration, `symbols` the operators and goals, in which
    types and predicates are numbered."""

    moves: tuple[object, ...]
    operators: int
    symbols: tuple[object, ...]


def learned(demos: Sequence[Demo]) -> Learned:
    """Symbols, without skills."""
    found = learn_symbols(tuple(without_freezes(demo) for demo in demos))
    types = sorted({t for demo in demos for t in demo.objects.values()}, key=lambda t: t.removeprefix("z-"))
    number = {t: k for k, t in enumerate(types)}
    moves = tuple(
        tuple(sorted(Counter((number[e.type], e.held) for e in found.episodes if e.demo is demo).items())) for demo in found.demos
    )
    classes = {c.predicate.name: tuple(number.get(t, -1) for t in c.predicate.types) for c in found.classifiers}

    def shape(atoms: Iterable[Atom]) -> tuple[object, ...]:
        found = [(str(classes.get(a.predicate, a.predicate)), len(a.args)) for a in atoms]
        return tuple(sorted(found))

    operators = [g.learned.operator for g in found.groups]
    symbols = [(shape(o.pre), shape(o.add), shape(o.delete), shape(a.atom for a in o.absent)) for o in operators]
    goals = [("goal", shape(goal.atoms)) for goal in found.goals]
    return Learned(moves, len(operators), (*sorted(symbols, key=str), *sorted(goals, key=str)))


def cell(demos: Sequence[Demo], base: Learned, change: Change) -> str:
    """Same, or what differs first."""
    changed = [change(demo, np.random.default_rng([7, i])) for i, demo in enumerate(demos)]
    try:
        found = learned(changed)
    except SymSkillError as error:
        return f"error: {str(error)[:60]}"
    if found.moves != base.moves:
        wrong = sum(a != b for a, b in zip(found.moves, base.moves, strict=True))
        return f"moves of {wrong} of {len(base.moves)}"
    if found.operators != base.operators:
        return f"{found.operators} operators of {base.operators}"
    if found.symbols != base.symbols:
        return f"{sum((Counter(base.symbols) - Counter(found.symbols)).values())} of {len(base.symbols)} differ"
    return "same"


# -- the table -------------------------------------------------------------------------------------------------------------


def recordings(files: Sequence[Path]) -> Iterator[tuple[str, tuple[Demo, ...]]]:
    """Names and demonstrations."""
    people = sorted((ROOT / "tests/data/robosuite").glob("*.hdf5"))
    for file in files or people:
        try:
            yield file.stem, load_demos(file)
        except InputError:
            yield file.stem, import_robosuite(file)
    if not files:
        yield "kitchen", tuple(demo for file in shipped_demos() for demo in load_demos(file)[:2])
        yield "play", load_demos(Path(symskill_pddl.__file__).parent / "data/play/Play.hdf5")


def main() -> None:
    """Change, learn, compare, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--only", action="append", choices=CHANGES, help="this change only; may be repeated")
    parser.add_argument("-o", "--output", type=Path, default=Path("docs/benchmarks-laws.md"))
    args = parser.parse_args()
    columns = dict(recordings(args.files))
    base = {name: learned(demos) for name, demos in columns.items()}
    rows, same, of = [], 0, 0
    for what in args.only or CHANGES:
        begun = time.process_time()
        cells = [cell(demos, base[name], CHANGES[what]) for name, demos in columns.items()]
        same, of = same + cells.count("same"), of + len(cells)
        rows.append(f"| {what} | {' | '.join(cells)} |")
        print(f"{what}: {', '.join(cells)} ({time.process_time() - begun:.0f} s)", flush=True)
    lines = [
        "# Laws of learning",
        "",
        f"Written by `python benchmarks/laws.py`. {same} of {of} cells are the same ({100 * same / of:.0f} %).",
        "",
        *(__doc__ or "").split("\n\n")[2].splitlines(),
        "",
        f"| change | {' | '.join(columns)} |",
        "|" + "---|" * (len(columns) + 1),
        *rows,
        "",
    ]
    write_atomic(args.output, "\n".join(lines).encode())


if __name__ == "__main__":
    main()
