from dataclasses import dataclass, fields

import pytest
from synthetic import record

from symskill_pddl.learning.symbolic import Symbolic, learn_symbols

TASKS = ("OpenSingleDoor", "CloseSingleDoor", "PnPCabToCounter", "PnPCounterToCab")


@dataclass(frozen=True, eq=False)
class Symbols(Symbolic):
    """All of learning but the skills, with the operators by name."""

    @classmethod
    def of(cls, demos):
        found = learn_symbols(demos)
        values = {f.name: getattr(found, f.name) for f in fields(found)}
        return cls(**{**values, "groups": {g.learned.operator.name: g for g in found.groups}})


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
