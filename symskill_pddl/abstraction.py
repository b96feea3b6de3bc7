"""From poses to atoms: one code for learning and for monitoring.

A `Classifier` is the geometry of one predicate: two independent Gaussians, over the position and over the orientation of a
child frame in a parent frame. The same Gaussians sample relative poses for recovery.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import product
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Array, Pose, frozen, quat_conjugate, quat_exp, quat_log, quat_multiply
from symskill_pddl.scene import GRIPPER, Scene
from symskill_pddl.symbols import GRIPPER_OPEN, Atom, Predicate, State

BoolArray = NDArray[np.bool_]


@dataclass(frozen=True, eq=False)
class Classifier:
    """Where the child frame is, relative to the parent frame, when the predicate holds.

    `parent` is a type name. `child` is a type name or `GRIPPER`. The predicate's arguments are ``(parent object,)`` for a
    gripper relation (gripper-in-object) and ``(child object, parent object)`` for a relation of two objects
    (object-at-reference).

    Attributes
    ----------
    T_mean : Pose
        Mean of `T_parent_child`.
    cov_p, cov_r : ndarray (3, 3)
        Covariances of the translation, in the parent's axes [m^2], and of the rotation residual ``log(q_mean^-1 q)``, in the
        mean's tangent space [rad^2].
    enter_p, enter_r : float
        Mahalanobis radii within which the predicate becomes true.
    leave_factor : float
        Radii times this factor are left before a true predicate becomes false (hysteresis, > 1).
    free_axis : ndarray (3,) or None
        A symmetry axis in the child's frame (unit): turning about it does not count.
    fingers : (float, float) or None
        Of a grasp: it holds only while the fingers are told to close and something stops them between these apertures [m].
    precedence : float
        Of several places of an object that hold at once, the one with the least counts (`one_place`).
    """

    predicate: Predicate
    child: str
    parent: str
    T_mean: Pose
    cov_p: Array
    cov_r: Array
    enter_p: float
    enter_r: float
    leave_factor: float = 1.5
    free_axis: Array | None = None
    fingers: tuple[float, float] | None = None
    precedence: float = 0.0
    _inverse_p: Array = field(init=False, repr=False)
    _inverse_r: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        for name in ("cov_p", "cov_r"):
            cov = frozen(getattr(self, name))
            if cov.shape != (3, 3) or not np.all(np.linalg.eigvalsh(cov) > 0):
                raise InputError(f"predicate '{self.predicate.name}': {name} has to be a positive definite (3, 3) matrix")
            object.__setattr__(self, name, cov)
            object.__setattr__(self, name.replace("cov", "_inverse"), frozen(np.linalg.inv(cov)))
        if not (self.enter_p > 0 and self.enter_r > 0 and self.leave_factor >= 1):
            raise InputError(f"predicate '{self.predicate.name}': radii must be positive and leave_factor at least 1")
        if self.fingers is not None and not 0.0 <= self.fingers[0] < self.fingers[1]:
            raise InputError(f"predicate '{self.predicate.name}': fingers have to be two apertures [m], the narrower first")
        if self.free_axis is not None:
            axis = frozen(self.free_axis)
            object.__setattr__(self, "free_axis", frozen(axis / np.linalg.norm(axis)))

    def residual(self, T_parent_child: Pose) -> tuple[Array, Array]:
        """Translation (..., 3) [m] and rotation (..., 3) [rad] away from the mean; the free angle is removed."""
        q = quat_multiply(quat_conjugate(self.T_mean.q), T_parent_child.q)
        if self.free_axis is not None:
            q = swing(q, self.free_axis)
        return T_parent_child.p - self.T_mean.p, quat_log(q)

    def margin(self, T_parent_child: Pose) -> Array:
        """Signed margin (...): 1 at the mean, 0 on the boundary of entering, negative outside."""
        dp, dr = self.residual(T_parent_child)
        p = _mahalanobis(dp, self._inverse_p) / self.enter_p
        r = _mahalanobis(dr, self._inverse_r) / self.enter_r
        return np.asarray(1.0 - np.maximum(p, r))

    def holds(self, T_parent_child: Pose, *, before: bool = False) -> bool:
        """The predicate's value for one pose; `before` is its value at the previous moment (hysteresis)."""
        return bool(self.margin(T_parent_child) >= (1.0 - self.leave_factor if before else 0.0))

    def grasped(self, aperture: float, gripper_closed: bool) -> bool:
        """Whether the fingers are as the predicate needs them; of a relation that is no grasp always true."""
        return self.fingers is None or (gripper_closed and self.fingers[0] <= aperture <= self.fingers[1])

    @property
    def volume(self) -> float:
        """Of the region of positions, up to a factor [m^3]."""
        return float(np.sqrt(np.linalg.det(self.cov_p)) * self.enter_p**3)

    def sample(self, rng: np.random.Generator, *, radius: float = 1.0) -> Pose:
        """A relative pose `T_parent_child` drawn from the Gaussians, cut at `radius` times the entering radii."""
        dp = _truncated(rng, self.cov_p, radius * self.enter_p)
        dr = _truncated(rng, self.cov_r, radius * self.enter_r)
        return Pose(self.T_mean.p + dp, quat_multiply(self.T_mean.q, quat_exp(dr)))


def _mahalanobis(residual: Array, inverse: Array) -> Array:
    return np.asarray(np.sqrt(np.sum((residual @ inverse) * residual, axis=-1)))


def swing(q: Array, axis: Array) -> Array:
    """The part of rotations q (..., 4) that is left when the turn about `axis` (..., 3), unit, is taken out: ``q = swing *
    twist``."""
    along = (q[..., 1:] * axis).sum(-1)
    twist = np.concatenate([q[..., :1], along[..., None] * axis], axis=-1)
    norm = np.linalg.norm(twist, axis=-1, keepdims=True)
    # a half turn about a perpendicular axis holds no twist that could be told
    twist = np.where(norm < 1e-9, np.array([1.0, 0.0, 0.0, 0.0]), twist / np.where(norm < 1e-9, 1.0, norm))
    return quat_multiply(q, quat_conjugate(twist))


def _truncated(rng: np.random.Generator, cov: Array, radius: float) -> Array:
    z = rng.standard_normal(3)
    norm = float(np.linalg.norm(z))
    return np.asarray(np.linalg.cholesky(cov) @ (z * min(1.0, radius / max(norm, 1e-12))))


@dataclass(frozen=True)
class GripperRule:
    """`gripper-open`: the command says open and the aperture exceeds `open_above` [m] (hysteresis down to `open_until`).

    `settled` speeds and objects between the fingers do not matter here: a gripper closed on a wide object is closed by its
    command.
    """

    open_above: float = 0.06
    open_until: float = 0.05

    def holds(self, aperture: float, gripper_closed: bool, *, before: bool = False) -> bool:
        return not gripper_closed and aperture > (self.open_until if before else self.open_above)


def groundings(classifier: Classifier, objects: dict[str, str]) -> Iterator[tuple[Atom, str, str]]:
    """Every (atom, parent object, child object or 'gripper') that the classifier speaks of."""
    parents = [o for o, t in objects.items() if t == classifier.parent]
    if classifier.child == GRIPPER:
        for parent in parents:
            yield Atom(classifier.predicate.name, (parent,)), parent, GRIPPER
    else:
        children = [o for o, t in objects.items() if t == classifier.child]
        for child, parent in product(children, parents):
            if child != parent:
                yield Atom(classifier.predicate.name, (child, parent)), parent, child


def abstract(
    scene: Scene, classifiers: Iterable[Classifier], *, before: State = frozenset(), gripper: GripperRule | None = None
) -> State:
    """The set of true ground atoms of a scene. `before` is the previous state (hysteresis); empty at the start.

    An object may be at several places at once: `one_place` says which of them counts.

    An atom about an unseen object keeps its value: that nobody sees a thing does not mean that anything has changed.
    """
    state = set()
    open_atom = Atom(GRIPPER_OPEN)
    if (gripper or GripperRule()).holds(scene.aperture, scene.gripper_closed, before=open_atom in before):
        state.add(open_atom)
    # all groundings of all predicates in one batch: this is on the path of every control tick
    table = _table(tuple(classifiers), tuple(scene.objects.items()))
    if not table.atoms:
        return frozenset(state)
    threshold = table.zeros.copy()
    held = [row for atom in before for row in table.rows.get(atom, ())]
    threshold[held] = table.leaves[held]
    state.update(table.atoms[row] for row in np.flatnonzero(table.margins(scene) >= threshold).tolist())
    if scene.unseen:
        state = {a for a in state if scene.unseen.isdisjoint(a.args)} | {a for a in before if not scene.unseen.isdisjoint(a.args)}
    return frozenset(state)


_UNITS = np.eye(4)
_FROM = quat_multiply(quat_conjugate(_UNITS)[:, None], _UNITS).transpose(0, 2, 1).reshape(4, 16)
"""``q @ _FROM`` is the matrix (4, 4) of the product with q's inverse: a product is linear in each of its factors."""
_TURN = quat_multiply(quat_multiply(_UNITS[:, None], _UNITS[1:])[:, None], quat_conjugate(_UNITS)[:, None])[..., 1:]
_TURN = _TURN.transpose(0, 1, 3, 2).reshape(16, 9)
"""The outer product of q with itself times `_TURN` is q's rotation matrix (3, 3)."""


@dataclass(frozen=True, eq=False)
class _Table:
    """The n groundings of a set of classifiers over a set of objects, and the classifiers' numbers row by row.

    Attributes
    ----------
    atoms, rows
        The atom of each row, and the rows of each atom.
    parents, children : (n,)
        Places of the two frames among the scene's objects; the hand comes last.
    free : (k,)
        Rows with a symmetry axis, `axes` (k, 3).
    narrowest, widest : (n,)
        Apertures between which closed fingers hold something; infinite for relations that are no grasps.
    """

    atoms: tuple[Atom, ...]
    rows: dict[Atom, tuple[int, ...]]
    parents: NDArray[np.intp]
    children: NDArray[np.intp]
    mean_p: Array
    unturn: Array
    inverse_p: Array
    inverse_r: Array
    enter_p: Array
    enter_r: Array
    leaves: Array
    zeros: Array
    free: NDArray[np.intp]
    axes: Array
    narrowest: Array
    widest: Array

    def margins(self, scene: Scene) -> Array:
        """`Classifier.margin` of every row (n,); minus infinity where the fingers hold nothing."""
        objects, hand = scene.T_world_objects, scene.T_world_ee
        p, q = np.concatenate([objects.p, hand.p[None]]), np.concatenate([objects.q, hand.q[None]])
        turn = ((q[:, :, None] * q[:, None, :]).reshape(-1, 16) @ _TURN).reshape(-1, 3, 3)
        dp = ((p[self.children] - p[self.parents])[:, None] @ turn[self.parents])[:, 0] - self.mean_p
        residual = (self.unturn @ ((q @ _FROM).reshape(-1, 4, 4)[self.parents] @ q[self.children][..., None]))[..., 0]
        if len(self.free):
            residual[self.free] = swing(residual[self.free], self.axes)
        dr = quat_log(residual)
        far_p = np.sqrt(((dp[:, None] @ self.inverse_p)[:, 0] * dp).sum(-1)) / self.enter_p
        far_r = np.sqrt(((dr[:, None] @ self.inverse_r)[:, 0] * dr).sum(-1)) / self.enter_r
        free = np.isinf(self.widest)
        grasped = scene.gripper_closed & (self.narrowest <= scene.aperture) & (scene.aperture <= self.widest)
        return np.where(free | grasped, 1.0 - np.maximum(far_p, far_r), -np.inf)


@lru_cache(maxsize=16)
def _table(classifiers: tuple[Classifier, ...], objects: tuple[tuple[str, str], ...]) -> _Table:
    place = {name: i for i, (name, _) in enumerate(objects)} | {GRIPPER: len(objects)}
    found = [(c, *grounding) for c in classifiers for grounding in groundings(c, dict(objects))]
    rows: dict[Atom, tuple[int, ...]] = {}
    for row, (_, atom, _, _) in enumerate(found):
        rows[atom] = (*rows.get(atom, ()), row)
    owners = [c for c, _, _, _ in found]
    axes = [(row, c.free_axis) for row, c in enumerate(owners) if c.free_axis is not None]
    return _Table(
        atoms=tuple(atom for _, atom, _, _ in found),
        rows=rows,
        parents=np.array([place[parent] for _, _, parent, _ in found], dtype=np.intp),
        children=np.array([place[child] for _, _, _, child in found], dtype=np.intp),
        mean_p=np.array([c.T_mean.p for c in owners]).reshape(-1, 3),
        unturn=(np.array([c.T_mean.q for c in owners]).reshape(-1, 4) @ _FROM).reshape(-1, 4, 4),
        inverse_p=np.array([c._inverse_p for c in owners]).reshape(-1, 3, 3),
        inverse_r=np.array([c._inverse_r for c in owners]).reshape(-1, 3, 3),
        enter_p=np.array([c.enter_p for c in owners]),
        enter_r=np.array([c.enter_r for c in owners]),
        leaves=np.array([1.0 - c.leave_factor for c in owners]),
        zeros=np.zeros(len(owners)),
        free=np.array([row for row, _ in axes], dtype=np.intp),
        axes=np.array([axis for _, axis in axes]).reshape(-1, 3),
        narrowest=np.array([c.fingers[0] if c.fingers is not None else -np.inf for c in owners]),
        widest=np.array([c.fingers[1] if c.fingers is not None else np.inf for c in owners]),
    )


def hysteresis(margin: Array, leave_factor: float) -> BoolArray:
    """Truth (n,) of a predicate along a recording from its margins (n,): the same as `Classifier.holds` moment by moment."""
    enters, leaves = margin >= 0.0, margin < 1.0 - leave_factor
    decided = np.where(enters, 1, np.where(leaves, -1, 0))
    # the last moment that decided anything; before the first one it is false
    last = np.maximum.accumulate(np.where(decided != 0, np.arange(len(decided)), -1))
    return np.asarray((last >= 0) & (decided[np.maximum(last, 0)] > 0))


DEBOUNCE_S = 0.075
"""An atom changes once it has read otherwise for this long: two samples at 20 Hz, one at 5 Hz, eighteen at 240 Hz."""


def debounce(truth: BoolArray, times: Array, seconds: float) -> BoolArray:
    """Truth (n,) that follows what has read otherwise for `seconds` since it last agreed; it starts with the first reading."""
    out, state, agreed = np.empty_like(truth), bool(truth[0]), float(times[0])
    for i, (reading, now) in enumerate(zip(truth.tolist(), times.tolist(), strict=True)):
        if reading == state or now - agreed >= seconds:
            state, agreed = reading, now
        out[i] = state
    return out


def one_place(state: State, classifiers: Iterable[Classifier]) -> State:
    """The state with every object at one place: of several, the one of least `precedence`, and of those the narrowest.

    What lies on a plate lies, for a wide and flat predicate, on the counter too, if only a few millimetres too high; an operator
    that puts it on the plate is not one that puts it on the counter.
    """
    order = _places(tuple(classifiers))
    kept: dict[str, Atom] = {}
    for atom in sorted((a for a in state if a.predicate in order), key=lambda a: (order[a.predicate], a)):
        kept.setdefault(atom.args[0], atom)
    return frozenset(a for a in state if a.predicate not in order or kept[a.args[0]] == a)


@lru_cache(maxsize=16)
def _places(classifiers: tuple[Classifier, ...]) -> dict[str, tuple[float, float]]:
    """By predicate of a place, what sorts it: its precedence and its size."""
    return {c.predicate.name: (c.precedence, c.volume) for c in classifiers if c.child != GRIPPER}


class Recorded(Protocol):
    """n moments of a world, such as a demonstration: the attributes of `Scene`, each along the recording."""

    @property
    def times(self) -> Array: ...  # (n,) [s]
    @property
    def objects(self) -> dict[str, str]: ...
    @property
    def T_world_ee(self) -> Pose: ...  # (n,)
    @property
    def aperture(self) -> Array: ...  # (n,) [m]
    @property
    def gripper_closed(self) -> BoolArray: ...  # (n,)
    @property
    def T_world_objects(self) -> Pose: ...  # (n, n_obj)
    @property
    def seen(self) -> BoolArray: ...  # (n, n_obj)


def abstract_recording(
    recorded: Recorded, classifiers: Iterable[Classifier], gripper: GripperRule | None = None
) -> dict[Atom, BoolArray]:
    """`abstract` along a recording at once, with hysteresis and debounce: the truth (n,) of every atom that ever holds.

    Where an object is not seen, an atom about it keeps its value; before the first sight it is false.
    """
    rule, order = gripper or GripperRule(), {name: i for i, name in enumerate(recorded.objects)}
    fingers, states = False, []
    for width, closed in zip(recorded.aperture.tolist(), recorded.gripper_closed.tolist(), strict=True):
        fingers = rule.holds(width, closed, before=fingers)
        states.append(fingers)
    found = {Atom(GRIPPER_OPEN): np.array(states)}
    inverse = recorded.T_world_objects.inverse()
    for classifier in classifiers:
        low, high = classifier.fingers or (-np.inf, np.inf)
        grasped = recorded.gripper_closed & (low <= recorded.aperture) & (recorded.aperture <= high)
        for atom, parent, child in groundings(classifier, recorded.objects):
            T_world_child = recorded.T_world_ee if child == GRIPPER else recorded.T_world_objects[:, order[child]]
            margin = classifier.margin(inverse[:, order[parent]] @ T_world_child)
            involved = [order[name] for name in (parent, child) if name != GRIPPER]
            # what is not seen neither enters nor leaves
            margin = np.where(recorded.seen[:, involved].all(axis=1), margin, np.nan)
            if classifier.fingers is not None:
                margin = np.where(grasped, margin, -np.inf)
            if (margin >= 0.0).any():
                found[atom] = hysteresis(margin, classifier.leave_factor)
    times = recorded.times
    return {atom: truth for atom, raw in found.items() if (truth := debounce(raw, times, DEBOUNCE_S)).any()}


def one_place_along(truth: Mapping[Atom, BoolArray], classifiers: Iterable[Classifier]) -> dict[Atom, BoolArray]:
    """`one_place` along a recording, from the truth (n,) of every atom."""
    order = _places(tuple(classifiers))
    result, taken = dict(truth), dict[str, BoolArray]()
    for atom in sorted((a for a in truth if a.predicate in order), key=lambda a: (order[a.predicate], a)):
        before = taken.get(atom.args[0], np.zeros_like(truth[atom]))
        result[atom] = truth[atom] & ~before
        taken[atom.args[0]] = before | truth[atom]
    return result


@dataclass(frozen=True)
class Debounced:
    """A state that follows the raw one as `debounce` says. Immutable: `update` returns the next.

    `agreed` holds, for every atom that reads otherwise now, the time at which it last agreed [s].
    """

    state: State
    time: float
    seconds: float = DEBOUNCE_S
    agreed: tuple[tuple[Atom, float], ...] = ()

    def update(self, raw: State, time: float) -> Debounced:
        """The state after the reading `raw` at `time` [s]."""
        since = dict(self.agreed)
        state, agreed = set(self.state), []
        for atom in sorted(raw ^ self.state):
            last = since.get(atom, self.time)
            if time - last >= self.seconds:
                state ^= {atom}
            else:
                agreed.append((atom, last))
        return Debounced(frozenset(state), time, self.seconds, tuple(agreed))
