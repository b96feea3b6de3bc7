"""What an episode's problem says when something is in no known relation."""

import numpy as np
import pytest

from symskill_pddl.abstraction import Classifier
from symskill_pddl.evaluation import trial
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import make
from symskill_pddl.kitchen.arena import KitchenArena
from symskill_pddl.kitchen.world import Kitchen
from symskill_pddl.library import Goal, Library
from symskill_pddl.symbols import Atom, Parameter, Predicate, Type

pytestmark = pytest.mark.simulation


def door_at(name: str, angle_deg: float) -> Classifier:
    """The door's relation to its cabinet when it is open by an angle, within a few degrees and centimetres."""
    kitchen = make("CloseSingleDoor", 0)
    kitchen.physics.set_part("door", np.radians(angle_deg))
    kitchen.physics.forward()
    T: Pose = kitchen.physics.T_world("cabinet").inverse() @ kitchen.physics.T_world("door")
    return Classifier(Predicate(name, ("door", "cabinet")), "door", "cabinet", T, np.eye(3) * 1e-4, np.eye(3) * 1e-3, 3.0, 3.0)


LIBRARY = Library(
    types=(Type("cabinet"), Type("door")),
    classifiers=(door_at("door-closed", 0.0), door_at("door-open", 95.0)),
    operators=(),
    skills={},
    goals=(
        Goal(
            "CloseSingleDoor",
            (Parameter("?door", "door"), Parameter("?cabinet", "cabinet")),
            frozenset({Atom("door-closed", ("?door", "?cabinet"))}),
        ),
    ),
)


def episode(monkeypatch: pytest.MonkeyPatch, angle_deg: float) -> trial.Episode:
    def at_angle(_: KitchenArena, task: str, seed: int, disturbances: object = ()) -> Kitchen:
        kitchen = make(task, seed)
        kitchen.physics.set_part("door", np.radians(angle_deg))
        kitchen.physics.forward()
        return kitchen

    monkeypatch.setattr(KitchenArena, "open", at_angle)
    return trial.prepare(LIBRARY, "CloseSingleDoor", 0)


def test_a_door_between_its_known_places_is_assumed_at_the_nearest(monkeypatch: pytest.MonkeyPatch) -> None:
    found = episode(monkeypatch, 70.0)
    assert [a.atom for a in found.assumed] == [Atom("door-open", ("door", "cabinet"))]
    assert found.assumed[0].margin < 0
    assert found.assumed[0].atom in found.problem.init


def test_an_assumption_does_not_fulfil_the_goal(monkeypatch: pytest.MonkeyPatch) -> None:
    found = episode(monkeypatch, 20.0)
    assert not found.problem.goal & found.problem.init
    assert [a.atom for a in found.assumed] == [Atom("door-open", ("door", "cabinet"))]


def test_nothing_is_assumed_where_a_relation_holds(monkeypatch: pytest.MonkeyPatch) -> None:
    assert episode(monkeypatch, 95.0).assumed == ()
