"""Goals: what most demonstrations bring about, of those that show the objects it takes; halves that contradict are an error."""

from dataclasses import replace

import numpy as np
import pytest
from synthetic import record

from symskill_pddl.errors import LearningError
from symskill_pddl.learning.goals import learn_goals
from symskill_pddl.symbols import Atom


class Shown:
    """A recording of two samples, as goals see it: what moved, and what holds at its start and end."""

    def __init__(self, name, objects, moved, ends, task="task"):
        self.where, self.task, self.objects, self.moved = name, task, objects, moved
        self.truth = {Atom(*atom): np.array([False, True]) for atom in ends}

    def __len__(self):
        return 2


class Move:
    def __init__(self, demo):
        self.demo, self.obj, self.passengers = demo, demo.moved, ()


OBJECTS = {"bowl_1": "bowl", "plate_1": "plate", "basket_1": "basket"}
ON_PLATE, IN_BASKET = ("bowl-on-plate", ("bowl_1", "plate_1")), ("bowl-in-basket", ("bowl_1", "basket_1"))
PLACES = ("bowl-in-basket", "bowl-on-plate", "bowl-low", "bowl-high")


def goals(*demos):
    return learn_goals(demos, [Move(d) for d in demos], {d.where: d.truth for d in demos}, PLACES)


def texts(found):
    return [sorted(map(str, goal.atoms)) for goal in found]


def test_what_most_demonstrations_end_with():
    found, told = goals(*(Shown(f"d{i}", OBJECTS, "bowl_1", [ON_PLATE if i else IN_BASKET]) for i in range(3)))
    assert texts(found) == [["(bowl-on-plate ?bowl ?plate)"]]
    assert told == ()


def test_half_and_half_contradict_each_other():
    with pytest.raises(LearningError, match=r"'task' contradict .* 1 of 2 with \(bowl-in-basket .* and 1 of 2 with \(bowl-on-pl"):
        goals(Shown("a", OBJECTS, "bowl_1", [ON_PLATE]), Shown("b", OBJECTS, "bowl_1", [IN_BASKET]))


def test_two_spots_at_one_thing_are_no_goal_and_no_contradiction():
    spots = [("bowl-low", ("bowl_1", "plate_1")), ("bowl-high", ("bowl_1", "plate_1"))]
    found, told = goals(*(Shown(str(i), OBJECTS, "bowl_1", [spot]) for i, spot in enumerate(spots)))
    assert (found, told) == ((), ("task 'task' gets no goal: no more than half of its 2 demonstrations end alike",))


def test_a_demonstration_without_the_plate_says_nothing_about_plates():
    blind = Shown("b", {"bowl_1": "bowl"}, "bowl_1", [])
    found, _ = goals(Shown("a", OBJECTS, "bowl_1", [ON_PLATE]), blind, replace_name(blind, "c"))
    assert texts(found) == [["(bowl-on-plate ?bowl ?plate)"]]


def replace_name(shown, name):
    return Shown(name, shown.objects, shown.moved, [])


def test_a_copy_of_a_demonstration_is_said_and_counted_once():
    from symskill_pddl.learning.learn import _distinct

    first, second = record("OpenSingleDoor", 2)
    kept, told = _distinct((first, second, replace(first, name="demo_7")))
    assert kept == (first, second)
    assert told == (f"{first.source}:demo_7 is the same recording as {first.where}: counted once",)
