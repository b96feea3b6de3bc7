import numpy as np
import pytest

from symskill_pddl.abstraction import Classifier
from symskill_pddl.errors import InputError
from symskill_pddl.evaluation.goals import bind_goal, goal_atoms, resting_atoms
from symskill_pddl.evaluation.trial import stated_goal
from symskill_pddl.geometry import Pose
from symskill_pddl.library import Goal, Library
from symskill_pddl.symbols import Atom, Domain, Parameter, Predicate, Type

TYPES = (Type("food"), Type("fruit", "food"), Type("shelf"), Type("door"))
PUT = Goal("Put", (Parameter("?food", "food"), Parameter("?shelf", "shelf")), frozenset({Atom("on", ("?food", "?shelf"))}))
SHUT = Goal("Shut", (Parameter("?door", "door"),), frozenset({Atom("shut", ("?door",))}))
OBJECTS = {"pear": "fruit", "cake": "food", "top": "shelf", "door": "door"}


def library(*goals: Goal) -> Library:
    return Library(TYPES, (), (), {}, goals)


def test_focus_comes_first_then_the_only_object_of_the_type() -> None:
    assert bind_goal(PUT, OBJECTS, ("cake",), TYPES) == {Atom("on", ("cake", "top"))}
    assert bind_goal(PUT, OBJECTS, ("door", "pear"), TYPES) == {Atom("on", ("pear", "top"))}


def test_goals_of_a_composite_are_joined() -> None:
    atoms = goal_atoms(library(PUT, SHUT), (("Put", ("cake",)), ("Shut", ("door",))), OBJECTS)
    assert atoms == {Atom("on", ("cake", "top")), Atom("shut", ("door",))}


def test_each_goal_of_a_composite_is_about_its_own_objects() -> None:
    atoms = goal_atoms(library(PUT), (("Put", ("cake",)), ("Put", ("pear",))), OBJECTS)
    assert atoms == {Atom("on", ("cake", "top")), Atom("on", ("pear", "top"))}


def relation(name: str) -> Classifier:
    return Classifier(
        Predicate(name, ("fruit", "shelf")), "fruit", "shelf", Pose.identity(), 1e-4 * np.eye(3), 1e-2 * np.eye(3), 3.0, 3.0
    )


def test_a_goal_may_say_what_rests_where() -> None:
    learned = Library(TYPES, (relation("on"),), (), {}, ())
    assert resting_atoms(learned, (("pear", "top"),), OBJECTS) == {Atom("on", ("pear", "top"))}
    with pytest.raises(InputError, match=r"'cake' at 'top' .* has none"):
        resting_atoms(learned, (("cake", "top"),), OBJECTS)
    with pytest.raises(InputError, match=r"has several \(beside, on\)"):
        resting_atoms(Library(TYPES, (relation("on"), relation("beside")), (), {}, ()), (("pear", "top"),), OBJECTS)


def test_two_variables_get_two_objects() -> None:
    stack = Goal("Stack", (Parameter("?a", "food"), Parameter("?b", "food")), frozenset({Atom("on", ("?a", "?b"))}))
    assert bind_goal(stack, OBJECTS, ("cake",), TYPES) == {Atom("on", ("cake", "pear"))}


def test_several_candidates_or_none_are_refused() -> None:
    with pytest.raises(InputError, match=r"several objects of type food \(cake, pear\) for \?food"):
        bind_goal(PUT, OBJECTS, (), TYPES)
    with pytest.raises(InputError, match="no shelf"):
        bind_goal(PUT, {"cake": "food"}, (), TYPES)


def test_a_task_without_a_learned_goal_is_refused() -> None:
    with pytest.raises(InputError, match=r"no goal for task 'Shut'.*it has: Put"):
        goal_atoms(library(PUT), (("Put", ("cake",)), ("Shut", ())), OBJECTS)


DOMAIN = Domain("d", (Type("cabinet"), Type("food")), (Predicate("in", ("food", "cabinet")),), ())
SCENE = {"cheese": "food", "cabinet": "cabinet"}


@pytest.mark.parametrize("text", ["(in cheese cabinet)", "(in cheese cabinet-1)", "(and (IN cheese cabinet-1))"])
def test_a_stated_goal_uses_the_names_of_the_scene_or_of_the_export(text: str) -> None:
    assert stated_goal(text, DOMAIN, SCENE) == {Atom("in", ("cheese", "cabinet"))}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("(inside cheese cabinet)", "unknown predicate 'inside'"),
        ("(in cheese fridge)", "unknown object 'fridge'"),
        ("(in cabinet cheese)", "needs the type food"),
        ("(in cheese)", "takes 2"),
        ("(in cheese", "never closed"),
        ("", "at least one atom"),
    ],
)
def test_a_wrong_goal_is_refused(text: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        stated_goal(text, DOMAIN, SCENE)
