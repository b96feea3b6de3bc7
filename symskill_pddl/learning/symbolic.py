"""From demonstrations to symbols: every stage of learning but the skills, which take the time."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from symskill_pddl.abstraction import Classifier, GripperRule, abstract_recording, one_place_along
from symskill_pddl.demos import Demo, extent_conflicts, merged_extents, without_freezes
from symskill_pddl.errors import LearningError
from symskill_pddl.learning.config import LearnConfig
from symskill_pddl.learning.episodes import segment_all
from symskill_pddl.learning.goals import learn_goals
from symskill_pddl.learning.naming import closed_places, contact_names, place_names
from symskill_pddl.learning.operators import OperatorGroup, Vocabulary, learn_operators
from symskill_pddl.learning.parts import stepwise
from symskill_pddl.learning.predicates import learn_relations, precedences
from symskill_pddl.learning.relations import Relations
from symskill_pddl.learning.report import LeftOut
from symskill_pddl.learning.scale import aperture_of
from symskill_pddl.learning.segments import Episode, RestKey
from symskill_pddl.learning.transitions import Truth, gripper_rule, never_shared, transitions
from symskill_pddl.library import Goal
from symskill_pddl.scene import GRIPPER
from symskill_pddl.symbols import Predicate

FINGERS_STILL_M = 0.001
"""An aperture that changes by less than this all through a recording was not moved: encoders are finer."""


@dataclass(frozen=True, eq=False)
class Symbolic:
    """What the symbolic stages find, in the order of the demonstrations given.

    Attributes
    ----------
    places, contacts : tuple of str
        Names of `relations.places` and `relations.contacts`.
    truths : dict of str to Truth
        By demonstration, the truth of every atom that ever holds, as the learned predicates see it; every object at one place.
    remarks : tuple of str
        What is suspicious about the demonstrations as a whole.
    left_out : tuple of LeftOut
    """

    demos: tuple[Demo, ...]
    extents: Mapping[str, tuple[float, float, float]]
    episodes: tuple[Episode, ...]
    relations: Relations
    places: tuple[str, ...]
    contacts: tuple[str, ...]
    classifiers: tuple[Classifier, ...]
    gripper: GripperRule
    truths: Mapping[str, Truth]
    groups: tuple[OperatorGroup, ...]
    goals: tuple[Goal, ...]
    remarks: tuple[str, ...]
    left_out: tuple[LeftOut, ...]


Selector = Callable[[Sequence[Episode], Mapping[RestKey, str]], Mapping[RestKey, str]]
"""Another way to choose references: from episodes and the default selector's choices, the object that each rest is at, by
`Rest.key`; rests that are left out stay with the default selector."""


def learn_symbols(
    demos: Sequence[Demo],
    config: LearnConfig | None = None,
    *,
    selector: Selector | None = None,
    progress: Callable[[str], None] = lambda _: None,
) -> Symbolic:
    """Segments, predicates, operators and goals; no skills.

    Raises
    ------
    LearningError
        If nothing moves, or no operator comes out.
    """
    config, demos = config or LearnConfig(), tuple(map(without_freezes, demos))
    extents = merged_extents(demos)
    scaled = config.relations.scaled(aperture_of(demos), config.hints)
    progress("segments")
    episodes = stepwise(segment_all(demos, config.states))
    answers = None
    if selector is not None:
        progress("references")
        default = learn_relations(demos, episodes, extents, scaled).references
        answers = selector(episodes, default)
    progress("predicates")
    relations = learn_relations(demos, episodes, extents, scaled, answers)
    places = place_names(relations, extents, closed_places(demos, relations, config.hints))
    contacts = contact_names(relations, places)
    classifiers = named(relations, places, contacts)
    progress("operators")
    gripper = gripper_rule(demos)
    perceived = {demo.where: abstract_recording(demo, classifiers, gripper) for demo in demos}
    truths = {where: one_place_along(truth, classifiers) for where, truth in perceived.items()}
    found, unclear = transitions(relations, truths, places, contacts)
    single = never_shared(perceived.values())
    words = Vocabulary(relations, classifiers, places, contacts, extents, single, 0.4 * aperture_of(demos))
    groups, rare = learn_operators(found, demos, words, config.relations)
    left_out = (*relations.left_out, *unclear, *rare)
    if not groups:
        raise LearningError(
            f"no operator comes out of {len(demos)} demonstrations with {len(episodes)} motions; first reason: {left_out[0]}"
        )
    goals, goalless = learn_goals(demos, episodes, truths, (*places, *_grasps(relations, contacts)))
    remarks = (*extent_conflicts(demos), *_unclosed(relations), *goalless)
    return Symbolic(
        demos,
        extents,
        episodes,
        relations,
        places,
        contacts,
        classifiers,
        gripper,
        truths,
        groups,
        goals,
        remarks,
        left_out,
    )


def _grasps(relations: Relations, contacts: Sequence[str]) -> Iterator[str]:
    """Names of the contacts in which the hand holds what moves freely."""
    for name, contact in zip(contacts, relations.contacts, strict=True):
        if contact.held and not contact.articulated:
            yield name


def _unclosed(relations: Relations) -> Iterator[str]:
    """A line if objects go with the hand in recordings in which the fingers never do anything."""
    loose = [x.episode for x in relations.labels if not relations.contacts[x.contact].articulated]
    shown = [e for e in loose if not e.demo.gripper_closed.any() and np.ptp(e.demo.aperture) < FINGERS_STILL_M]
    if shown:
        objects = ", ".join(sorted({e.obj for e in shown}))
        yield (
            f"{shown[0].demo.where}: the fingers never close though {objects} goes with the hand "
            f"({len(shown)} times in all): is the gripper missing in the recording?"
        )


def named(relations: Relations, places: Sequence[str], contacts: Sequence[str]) -> tuple[Classifier, ...]:
    """The classifiers under their names: contacts first, then places, each in alphabetical order."""
    of_contacts = [
        c.shape.classifier(Predicate(name, (c.type,)), GRIPPER, c.type, c.fingers)
        for c, name in zip(relations.contacts, contacts, strict=True)
    ]
    of_places = [
        p.shape.classifier(Predicate(name, p.types), *p.types, None, precedence)
        for p, name, precedence in zip(relations.places, places, precedences(relations), strict=True)
    ]
    return tuple(sorted(of_contacts, key=_name) + sorted(of_places, key=_name))


def _name(classifier: Classifier) -> str:
    return classifier.predicate.name
