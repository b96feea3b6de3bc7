"""Atoms of recordings."""

import numpy as np

from symskill_pddl.abstraction import Classifier
from symskill_pddl.geometry import Pose
from symskill_pddl.learning.transitions import exclusive, never_shared
from symskill_pddl.symbols import Atom, Predicate


def place(name, parent, half):
    cov = np.diag(np.square(half)) / 9.0
    return Classifier(Predicate(name, ("food", parent)), "food", parent, Pose.identity(), cov, np.eye(3) * 0.01, 3.0, 3.0)


def test_an_object_is_at_one_place_and_the_narrowest_that_holds_is_it():
    classifiers = [place("on-counter", "counter", (0.3, 0.6, 0.01)), place("on-plate", "plate", (0.04, 0.04, 0.01))]
    wide, narrow, other = (
        Atom("on-counter", ("egg", "top")),
        Atom("on-plate", ("egg", "dish")),
        Atom("on-counter", ("ham", "top")),
    )
    door = Atom("open", ("door", "cabinet"))
    truth = {
        wide: np.array([1, 1, 1, 0], bool),
        narrow: np.array([0, 1, 0, 1], bool),
        other: np.array([1, 1, 1, 1], bool),
        door: np.array([1, 1, 0, 0], bool),
    }
    found = exclusive(truth, classifiers)
    assert found[wide].tolist() == [True, False, True, False]
    assert all(found[atom].tolist() == truth[atom].tolist() for atom in (narrow, other, door))
    assert truth[wide].tolist() == [True, True, True, False]


def test_two_at_a_time_are_noticed_in_any_frame_of_any_recording():
    def truth(egg, ham, plate="dish"):
        rows = {Atom("on-plate", ("egg", "dish")): egg, Atom("on-plate", ("ham", plate)): ham, Atom("holds", ("egg",)): [1, 1, 1]}
        return {atom: np.array(row, bool) for atom, row in rows.items()}

    one_after_the_other = truth([1, 1, 0], [0, 0, 1])
    assert never_shared([one_after_the_other, truth([1, 1, 1], [1, 1, 1], "other-dish")]) == {"on-plate"}
    assert never_shared([one_after_the_other, truth([1, 1, 0], [0, 1, 1])]) == frozenset()
    assert never_shared([]) == frozenset()
