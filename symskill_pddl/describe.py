"""What was learned, in words: the geometry of a predicate, the origin of an operator, the phases of a skill.

The same words stand in the comments of the exported PDDL, in `symskill show` and in the report.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from symskill_pddl.abstraction import Classifier, GripperRule
from symskill_pddl.geometry import Array
from symskill_pddl.library import LearnedOperator, Library
from symskill_pddl.scene import GRIPPER
from symskill_pddl.skills import Skill
from symskill_pddl.symbols import GRIPPER_OPEN, Absent, Atom, Operator


def geometry_lines(classifier: Classifier) -> tuple[str, ...]:
    """What the predicate means: where the child is in the parent's frame [cm], how it is turned [deg], when it is false again.

    Tolerances are half widths along the axes of the Gaussians' entering ellipsoids; the offset is given along the parent's axes.
    """
    child = "gripper" if classifier.child == GRIPPER else classifier.child
    offset = ", ".join(f"{axis} {_number(100 * value)}" for axis, value in zip("xyz", classifier.T_mean.p, strict=True))
    widths = 100 * classifier.enter_p * np.sqrt(np.diag(classifier.cov_p))
    lines = [f"{child} at {offset} cm in the {classifier.parent}'s frame, give or take {_triple(widths)} cm"]
    turns = np.minimum(np.degrees(classifier.enter_r * np.sqrt(np.diag(classifier.cov_r))), 180.0)
    lines.append(f"{_rotation(classifier.T_mean.rotvec())}, give or take {_triple(turns)} deg")
    if classifier.free_axis is not None:
        lines[-1] += f"; free to turn about its own {_axis(classifier.free_axis)} axis"
    lines.append(f"false again beyond {classifier.leave_factor:g} times that")
    return tuple(lines)


def geometry_text(classifier: Classifier) -> str:
    """`geometry_lines` as one line."""
    return "; ".join(geometry_lines(classifier))


def gripper_text(rule: GripperRule) -> str:
    """What `gripper-open` means; it is the one predicate that is not learned."""
    return (
        f"built in: the fingers are told to open and are further apart than {_number(100 * rule.open_above)} cm; "
        f"false again below {_number(100 * rule.open_until)} cm"
    )


def skill_lines(skill: Skill) -> tuple[str, ...]:
    """A line for each phase, and one for what the fingers do at the end."""
    lines = [
        f"{i}. in {phase.frame}'s frame, fingers {_fingers(phase.close_gripper)}, about {phase.duration_s:.1f} s, "
        f"until within {_number(100 * phase.tolerance_p)} cm and {np.degrees(phase.tolerance_r):.0f} deg"
        for i, phase in enumerate(skill.phases, start=1)
    ]
    if skill.phases and skill.close_gripper_at_end != skill.phases[-1].close_gripper:
        lines.append(f"{len(lines) + 1}. fingers {'close' if skill.close_gripper_at_end else 'open'}")
    return tuple(lines)


def support_text(learned: LearnedOperator) -> str:
    """How many episodes the operator rests on, and how long they took."""
    mean, longest = learned.duration_s
    demos = len({evidence.demo for evidence in learned.evidence})
    return (
        f"{learned.kind}, learned from {_count(learned.support, 'episode')} in {_count(demos, 'demonstration')}; "
        f"took {mean:.1f} s on average, {longest:.1f} s at most"
    )


def experience_lines(learned: LearnedOperator) -> tuple[str, ...]:
    """What the robot's own runs say; nothing where there are none."""
    own = learned.experience
    if not own.tries:
        return ()
    took = f", took {own.seconds / own.successes:.1f} s on average" if own.successes else ""
    return (
        f"carried out {_count(own.tries, 'time')}, {own.successes} with success{took}; the next one works with {own.success:.2f}",
    )


def support_lines(library: Library, predicate: str) -> tuple[str, ...]:
    """What a predicate rests on: the operators that bring it about or end it, their episodes, and how clear its reference is."""
    shows = [o for o in library.operators if predicate in {a.predicate for a in o.operator.add | o.operator.delete}]
    episodes, demos = sum(o.support for o in shows), len({e.demo for o in shows for e in o.evidence})
    names = ", ".join(o.operator.name for o in shows)
    lines = [f"support: {_count(episodes, 'episode')} in {_count(demos, 'demonstration')} ({names})"]
    if predicate in library.margins:
        lines.append(f"reference: its score leads the next candidate's by {library.margins[predicate]:.2f}")
    return tuple(lines)


def operator_lines(learned: LearnedOperator) -> tuple[str, ...]:
    """Where an operator comes from and what it keeps true; what else held at its start, and the notes."""
    lines = [support_text(learned), *experience_lines(learned), f"skill {learned.skill}"]
    if learned.operator.maintain:
        lines.append(f"maintains {atoms_text(learned.operator.maintain)}")
    # those of which a note gives the reason are said there
    if only_strict := [a for a in learned.strict_pre - learned.operator.pre if not any(str(a) in n for n in learned.notes)]:
        lines.append(f"also true in every demonstration at the start: {atoms_text(only_strict)}")
    return (*lines, *learned.notes)


def domain_comments(library: Library) -> dict[str, list[str]]:
    """Comment lines for each predicate and operator of the exported domain, by name."""
    comments = {GRIPPER_OPEN: [gripper_text(library.gripper)]}
    for classifier in library.classifiers:
        comments.setdefault(classifier.predicate.name, []).extend(geometry_lines(classifier))
    for learned in library.operators:
        comments[learned.operator.name] = list(operator_lines(learned))
    for type_, half in sorted(library.extents.items()):
        comments.setdefault(type_, []).append(f"fits a box of {_triple(200 * np.array(half, dtype=np.float64))} cm")
    return comments


def atoms_text(atoms: Iterable[Atom]) -> str:
    """Atoms in a row, sorted."""
    return " ".join(map(str, sorted(atoms)))


def absent_text(condition: Absent) -> str:
    """A negative condition in words: ``no ?other - lid with (lid-on-pan ?other ?pan)``, or ``not (...)``."""
    if not condition.over:
        return f"not {condition.atom}"
    return f"no {', '.join(f'{p.name} - {p.type}' for p in condition.over)} with {condition.atom}"


def operator_summary(learned: LearnedOperator) -> str:
    """An operator in words, made of types: ``Pick lid from cabinet``, ``Place lid → cookware``, ``Open door``."""
    op = learned.operator
    types = [p.type.replace("-", " ") for p in op.parameters]
    if learned.kind == "pick" and len(types) > 1 and "-from-" in op.name:
        return f"Pick {types[0]} from {types[1]}"
    if learned.kind == "place" and len(types) > 1:
        return f"Place {types[0]} → {types[1]}"
    words = op.name.replace("-", " ")
    return words[:1].upper() + words[1:]


def short_atom(atom: Atom, operator: Operator) -> str:
    """The predicate alone where it speaks of the operator's first parameters of its types, else with its arguments."""
    first: dict[str, str] = {}
    for p in operator.parameters:
        first.setdefault(p.type, p.name)
    if len(set(atom.args)) == len(atom.args) and set(atom.args) <= set(first.values()):
        return atom.predicate
    return f"{atom.predicate}({', '.join(atom.args)})"


def short_absent(condition: Absent, operator: Operator) -> str:
    """``no lid-on-cookware``: no object stands in this relation to the operator's own."""
    over = {p.name for p in condition.over}
    own = Atom(condition.atom.predicate, tuple(a for a in condition.atom.args if a not in over))
    return f"{'no' if over else 'not'} {short_atom(own, operator)}"


def _fingers(closed: bool) -> str:
    return "closed" if closed else "open"


def _count(n: int, noun: str) -> str:
    return f"{n} {noun}{'' if n == 1 else 's'}"


def _number(value: float) -> str:
    """One decimal, without a minus before zero."""
    return f"{round(float(value), 1) + 0.0:.1f}"


def _triple(values: Array) -> str:
    return " x ".join(_number(v) if v < 9.95 else f"{v:.0f}" for v in values)


def _rotation(rotvec: Array) -> str:
    angle = float(np.degrees(np.linalg.norm(rotvec)))
    return "not turned" if angle < 0.5 else f"turned {angle:.0f} deg about {_axis(rotvec)}"


def _axis(vector: Array) -> str:
    """The name of a coordinate axis within 3 degrees, or the direction's components."""
    unit = np.asarray(vector) / np.linalg.norm(vector)
    main = int(np.argmax(np.abs(unit)))
    if abs(unit[main]) > np.cos(np.radians(3)):
        return f"{'-' if unit[main] < 0 else ''}{'xyz'[main]}"
    return "(" + ", ".join(f"{u + 0.0:.2f}" for u in np.round(unit, 2)) + ")"
