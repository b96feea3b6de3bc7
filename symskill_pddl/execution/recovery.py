"""What to try differently after a failure: pure functions of poses, atoms and a random generator.

- `FailureMemory`: which ground steps failed, how often; raises their cost and widens the next sample.
- `goal_shift`: moves a blamed step's goal by a sample of its effect predicate.
- `way_in`, `later_leg`: how a step that was blocked had better begin.
- `nearest_symbols`: for objects in no known relation, the relations they are nearest to, as assumptions for planning.
- `other_face`: for a thing that fell over, the turn under which it is as it was demonstrated.
- `servo`, `way_back`: the few motions that are not learned (backing off, going back where one came from).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from symskill_pddl.abstraction import Classifier, groundings
from symskill_pddl.geometry import Array, Pose, quat_conjugate, quat_log, quat_multiply, rotation_distance
from symskill_pddl.scene import GRIPPER, Scene
from symskill_pddl.skills import Skill
from symskill_pddl.symbols import Atom, GroundOperator, State

StepKey = tuple[str, tuple[str, ...]]
"""A ground step by name: (operator, arguments)."""


_BOX_TURNS = tuple(
    (r.as_quat()[[3, 0, 1, 2]], r.as_matrix()) for r in sorted(Rotation.create_group("O"), key=lambda r: round(r.magnitude(), 6))
)
"""The 24 turns of a box onto itself as quaternions (w, x, y, z) and matrices; the first one is none."""
_NEARER = 0.5
"""By how much a turn has to better the margin: a tie is no reason to see a thing differently."""


_WELL_WITHIN = 0.2
"""Least margin of a place to sample around: on the very edge of the predicate the smallest error would undo it."""


def key_of(step: GroundOperator) -> StepKey:
    """The key under which failures of a ground step are remembered."""
    return step.name, step.args


@dataclass(frozen=True)
class FailureMemory:
    """How often each ground step was blamed since its last success. Immutable."""

    failures: Mapping[StepKey, int] = field(default_factory=dict)

    def blame(self, key: StepKey) -> FailureMemory:
        """One more failure of the step."""
        return FailureMemory({**self.failures, key: self.count(key) + 1})

    def clear(self, key: StepKey) -> FailureMemory:
        """The step has succeeded: forget its failures."""
        return FailureMemory({k: n for k, n in self.failures.items() if k != key})

    def count(self, key: StepKey) -> int:
        return self.failures.get(key, 0)

    def extra_costs(self, per_failure: float) -> dict[StepKey, float]:
        """What a planner is to add to the cost of each ground step."""
        return {k: per_failure * n for k, n in sorted(self.failures.items())}


def goal_shift(
    step: GroundOperator,
    skill: Skill,
    binding: Mapping[str, str],
    classifiers: Iterable[Classifier],
    scene: Scene,
    rng: np.random.Generator,
    radius: float,
) -> tuple[str, Pose] | None:
    """A frame transform of the skill that moves its goal to a sample of the step's effect predicate.

    For an effect between objects (a place) a pose of the moved object in the reference is sampled and composed with the
    present grasp ``T_obj_ee``, which also corrects a grasp that differs from the demonstrated ones. For a gripper relation (a
    pick, a reach), and where the open hand pushes, the deviation of a sampled pose from the predicate's mean is applied.

    Parameters
    ----------
    binding : mapping of str to str
        Object bound to each parameter of the operator; the phases name their frames by parameter.
    radius : float
        The sample stays within this fraction of the predicate's entering radii.

    Returns
    -------
    (str, Pose) or None
        The frame (a parameter) and the shift in that frame; None where no effect speaks of a frame of the skill.
    """
    by_name = {c.predicate.name: c for c in classifiers}
    effects = [a for a in sorted(step.add) if a.predicate in by_name]
    # a relation between objects is what the step is for; the hand comes second
    effects.sort(key=lambda a: by_name[a.predicate].child == GRIPPER)
    for atom in effects:
        classifier = by_name[atom.predicate]
        parent = atom.args[-1]
        grasp = classifier.child == GRIPPER
        place = goal_phase(skill, binding, parent, grasp)
        if place is None:
            continue
        goal = skill.phases[place]
        sample = classifier.sample(rng, radius=radius)
        if grasp or not goal.close_gripper:
            # an open hand has no grasp to compose with: where it is on the object changes as it pushes on
            return goal.frame, sample @ classifier.T_mean.inverse()
        T_obj_ee = scene.pose(atom.args[0]).inverse() @ scene.T_world_ee
        shown = goal.field.T_goal @ T_obj_ee.inverse()
        return goal.frame, _near_shown(classifier, shown, sample) @ T_obj_ee @ goal.field.T_goal.inverse()
    return None


def _near_shown(classifier: Classifier, shown: Pose, sample: Pose) -> Pose:
    """The sample's deviation from the predicate's mean, taken from where the skill would put the object.

    A predicate may be much wider than the places that the skill was shown (a whole counter), and its mean none of them. Where the
    skill's own place is not well within the predicate, the sample itself is the better one.
    """
    dp, dq = sample.p - classifier.T_mean.p, quat_multiply(quat_conjugate(classifier.T_mean.q), sample.q)
    near = Pose(shown.p + dp, quat_multiply(shown.q, dq))
    return near if float(classifier.margin(near)) >= _WELL_WITHIN <= float(classifier.margin(shown)) else sample


def goal_phase(skill: Skill, binding: Mapping[str, str], parent: str, grasp: bool) -> int | None:
    """The phase that ends where a relation to `parent` comes about, None where there is none.

    The goal of a carry is where the fingers still hold; of an approach (`grasp`), its last field.
    """
    fitting = [i for i, p in enumerate(skill.phases) if binding[p.frame] == parent]
    holding = [i for i in fitting if grasp or skill.phases[i].close_gripper]
    return max(holding or fitting, default=None)


def way_in(skill: Skill, binding: Mapping[str, str], scene: Scene) -> Pose | None:
    """Where the hand passes on its way to the skill's goal: the end of its first phase.

    None where no phase follows, so that this is the goal itself, or where the fingers are not as in that phase.
    """
    first = skill.phases[0]
    if len(skill.phases) < 2 or first.close_gripper != scene.gripper_closed:
        return None
    return first.T_world_goal(scene.pose(binding[first.frame]))


def later_leg(skill: Skill, stage: int) -> int:
    """The phase after a blocked one where the skill may as well begin, 0 where there is none.

    Every phase is stable from anywhere. The first ones lead in from where the demonstrations came from, and a run may come from
    elsewhere; but the last one before the fingers move is the approach itself, and is not to be all.
    """
    closed = skill.phases[0].close_gripper
    same = next((i for i, phase in enumerate(skill.phases) if phase.close_gripper != closed), len(skill.phases))
    return stage + 1 if stage + 2 < same else 0


@dataclass(frozen=True)
class Assumption:
    """An atom to plan with although it was not observed: the relation that an unplaced object is nearest to."""

    atom: Atom
    margin: float
    """The classifier's signed margin: 0 on the boundary, negative outside."""


def nearest_symbols(
    scene: Scene, state: State, classifiers: Sequence[Classifier], objects: Iterable[str]
) -> dict[str, tuple[Assumption, ...]]:
    """For every object in no known relation, all relations it could have, the nearest first.

    An object that rests where no predicate holds yields no atom, and no operator can speak of it (a door left ajar). The
    fields are stable from anywhere, so an operator that starts from the nearest known relation can still be tried. An object
    in the hand is not unplaced. Only `objects` are looked at; objects that are never the child of a relation are left out.
    """
    gripper = frozenset(c.predicate.name for c in classifiers if c.child == GRIPPER)
    related = {a.args[0] for a in state if a.args}
    found: dict[str, list[Assumption]] = {}
    for classifier in classifiers:
        if classifier.predicate.name in gripper:
            continue
        for atom, parent, child in groundings(classifier, scene.objects):
            if child in objects and parent in objects and child not in related:
                margin = float(classifier.margin(scene.pose(parent).inverse() @ scene.pose(child)))
                found.setdefault(child, []).append(Assumption(atom, margin))
    return {child: tuple(sorted(found[child], key=lambda a: (-a.margin, a.atom))) for child in sorted(found)}


def other_face(
    scene: Scene, name: str, half: tuple[float, float, float], classifiers: Iterable[Classifier]
) -> tuple[Array, Assumption] | None:
    """The turn of a box-like thing that fell over under which it is nearest to a known relation.

    A thing that lies on another face stands in no relation that a demonstration shows, although a box with nearly the same
    sides looks no different. Of the turns that carry such a box over to itself the best one is chosen.

    Parameters
    ----------
    half : (float, float, float)
        Half sizes of its box [m]; sides that change places may differ by a third.

    Returns
    -------
    ((4,), Assumption) or None
        The quaternion of ``T_seen_taken``, and the relation with its margin then; None where no turn brings it nearer than none.
    """
    sides = np.asarray(half)
    fits = [q for q, R in _BOX_TURNS if np.max(np.abs(np.log(np.abs(R) @ sides / sides))) < np.log(4.0 / 3.0)]
    T = scene.pose(name)
    poses = Pose(np.repeat(T.p[None], len(fits), axis=0), quat_multiply(T.q, np.array(fits)))
    best: tuple[float, int, Assumption] | None = None
    unturned = -np.inf
    for classifier in classifiers:
        if classifier.child == GRIPPER:
            continue
        for atom, parent, child in groundings(classifier, scene.objects):
            if child != name:
                continue
            margins = classifier.margin(scene.pose(parent).inverse() @ poses)
            unturned = max(unturned, float(margins[0]))
            i = int(np.argmax(margins))
            if best is None or margins[i] > best[0]:
                best = float(margins[i]), i, Assumption(atom, float(margins[i]))
    if best is None or best[0] - unturned < _NEARER:
        return None
    return np.asarray(fits[best[1]]), best[2]


def servo(T_world_ee: Pose, T_world_target: Pose, *, gain: float, max_speed: float, max_turn: float) -> Array:
    """Twist (6,) in world axes straight to a pose: proportional, with speed caps that scale and do not turn."""
    linear = gain * (T_world_target.p - T_world_ee.p)
    angular = gain * quat_log(quat_multiply(T_world_target.q, quat_conjugate(T_world_ee.q)))
    return capped(np.concatenate([linear, angular]), max_speed, max_turn)


def capped(twist: Array, max_speed: float, max_turn: float) -> Array:
    """The twist (6,) scaled so that neither its linear nor its angular speed exceeds its cap; the path stays the same."""
    excess = max(float(np.linalg.norm(twist[:3])) / max_speed, float(np.linalg.norm(twist[3:])) / max_turn, 1.0)
    return np.asarray(twist / excess)


def near(a: Pose, b: Pose, *, distance_m: float, angle_rad: float) -> bool:
    """Whether two poses agree within a distance and an angle."""
    return float(np.linalg.norm(a.p - b.p)) <= distance_m and float(rotation_distance(a, b)) <= angle_rad


def way_back(path: Sequence[Pose], length_m: float, *, spacing_m: float = 0.02) -> tuple[Pose, ...]:
    """The hand's recent path in reverse, thinned to `spacing_m`, until `length_m` of it are covered."""
    if not path:
        return ()
    back, covered, last = [], 0.0, path[-1]
    for T in reversed(path):
        gap = float(np.linalg.norm(T.p - last.p))
        if gap < spacing_m - 1e-9:
            continue
        covered += gap
        back.append(T)
        last = T
        if covered >= length_m:
            break
    return tuple(back)


def backed_off(T_world_ee: Pose, distance_m: float) -> Pose:
    """The pose `distance_m` back along the hand's own approach direction (-z)."""
    return Pose(T_world_ee.p + T_world_ee.rotate(np.array([0.0, 0.0, -distance_m])), T_world_ee.q)
