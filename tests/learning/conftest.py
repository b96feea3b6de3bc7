from dataclasses import dataclass

import pytest
from synthetic import record

from symskill_pddl.demos import Demo, merged_extents
from symskill_pddl.learning.learn import _classifiers
from symskill_pddl.learning.naming import contact_names, place_names
from symskill_pddl.learning.operators import OperatorGroup, learn_operators
from symskill_pddl.learning.predicates import Relations, learn_relations
from symskill_pddl.learning.segments import Episode, segment_all
from symskill_pddl.learning.transitions import gripper_rule, transitions, truth_of

TASKS = ("OpenSingleDoor", "CloseSingleDoor", "PnPCabToCounter", "PnPCounterToCab")


@dataclass(frozen=True, eq=False)
class Symbols:
    """All of learning but the skills, which take the time."""

    demos: tuple[Demo, ...]
    episodes: tuple[Episode, ...]
    relations: Relations
    places: tuple[str, ...]
    contacts: tuple[str, ...]
    groups: dict[str, OperatorGroup]
    notes: tuple[str, ...]

    @classmethod
    def of(cls, demos):
        extents = merged_extents(tuple(demos))
        episodes = segment_all(demos)
        relations = learn_relations(demos, episodes, extents)
        places = place_names(relations, extents)
        contacts = contact_names(relations, places)
        classifiers = _classifiers(relations, places, contacts)
        rule = gripper_rule(demos)
        truths = {d.where: truth_of(d, classifiers, rule) for d in demos}
        found, odd = transitions(relations, truths, places, contacts)
        groups, more = learn_operators(found, demos, relations, classifiers, places, contacts, extents)
        by_name = {g.learned.operator.name: g for g in groups}
        return cls(tuple(demos), episodes, relations, places, contacts, by_name, (*relations.notes, *odd, *more))


def kitchen_demos(n, **how):
    return tuple(d for task in TASKS for d in record(task, n, **how))


@pytest.fixture(scope="session")
def ten():
    """Ten demonstrations of each task, with faults."""
    return Symbols.of(kitchen_demos(10))


@pytest.fixture(scope="session")
def one():
    """One demonstration of each task."""
    return Symbols.of(kitchen_demos(1))
