import re
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from symskill_pddl.geometry import Pose
from symskill_pddl.learning.articulation import Joint
from symskill_pddl.learning.naming import parameter_names, place_names, slug, unique


@given(st.lists(st.sampled_from(["a", "a-2", "b", "a-3", "a-2-2"]), max_size=12))
def test_names_are_unique_and_first_ones_stay(names):
    made = unique(names)
    assert len(set(made)) == len(made) == len(names)
    for i, name in enumerate(names):
        assert made[i].startswith(name)
        if name not in names[:i]:
            assert made[i] == name


@given(st.text(min_size=1, max_size=20))
def test_slugs_are_pddl_names(text):
    assert re.fullmatch(r"[a-z][a-z0-9-]*", slug(text))


@pytest.mark.parametrize(
    ("text", "expected"), [("Food", "food"), ("cubeA", "cubea"), ("wall cabinet_2", "wall-cabinet-2"), ("3d", "t-3d")]
)
def test_slugs(text, expected):
    assert slug(text) == expected


def test_parameters_are_numbered_per_type():
    types = {"a": "food", "b": "food", "c": "pan"}
    assert parameter_names(["a", "c", "b"], types) == {"a": "?food", "c": "?pan", "b": "?food-2"}


def place_at(types, p=(0.0, 0.0, 0.0), joint=None, coordinate=0.0):
    return SimpleNamespace(
        types=types,
        shape=SimpleNamespace(T_mean=Pose(np.array(p), np.array([1.0, 0, 0, 0]))),
        joint=joint,
        coordinate=coordinate,
        held=False,
        demos=frozenset(),
    )


def relations(*places, grip=0.5):
    contact = SimpleNamespace(
        type=places[0].types[0], shape=SimpleNamespace(T_mean=Pose(np.array([0.0, grip, 0.0]), np.array([1.0, 0, 0, 0])))
    )
    labels = [SimpleNamespace(start=0, end=len(places) - 1, contact=0)]
    return SimpleNamespace(places=places, contacts=(contact,), labels=labels)


@pytest.mark.parametrize(
    ("p", "name"),
    [((0, 0, 0), "food-in-box"), ((0, 0, 0.15), "food-on-box"), ((0.3, 0, 0.15), "food-at-box"), ((0, 0, -0.3), "food-at-box")],
)
def test_prepositions_come_from_the_geometry(p, name):
    assert place_names(relations(place_at(("food", "box"), p)), {"box": (0.1, 0.1, 0.1)}) == (name,)
    assert place_names(relations(place_at(("food", "box"), p)), {}) == ("food-at-box",)


def hinge():
    return Joint("hinge", np.array([0.0, 0, 1]), np.zeros(3), 0.0)


SIZES = dict.fromkeys(["door", "cabinet", "knob", "stove", "drawer"], (0.1, 0.1, 0.1))


def test_states_of_doors_knobs_and_drawers():
    door = [place_at(("door", "cabinet"), joint=hinge(), coordinate=c) for c in (1.6, 0.0, 0.9)]
    assert place_names(relations(*door), SIZES) == ("door-open", "door-closed", "door-ajar")
    knob = [place_at(("knob", "stove"), joint=hinge(), coordinate=c) for c in (0.0, -1.6)]
    assert place_names(relations(*knob, grip=0.02), SIZES) == ("knob-unturned", "knob-turned")
    slide = Joint("slide", np.array([1.0, 0, 0]), np.zeros(3), 0.0)
    drawer = [place_at(("drawer", "cabinet"), (x, 0, 0), slide, x) for x in (-0.25, 0.0)]
    assert place_names(relations(*drawer), SIZES) == ("drawer-open", "drawer-closed")


def test_without_sizes_names_speak_of_the_joint():
    door = [place_at(("door", "cabinet"), joint=hinge(), coordinate=c) for c in (1.6, 0.03, 0.9)]
    assert place_names(relations(*door), {}) == ("door-at-0deg", "door-at-90deg", "door-at-40deg")
    slide = Joint("slide", np.array([1.0, 0, 0]), np.zeros(3), 0.0)
    drawer = [place_at(("drawer", "cabinet"), (x, 0, 0), slide, x) for x in (0.25, 0.0)]
    assert place_names(relations(*drawer), {}) == ("drawer-at-0cm", "drawer-at-25cm")


def test_a_person_may_say_which_state_is_closed():
    door = [place_at(("door", "cabinet"), joint=hinge(), coordinate=c) for c in (1.6, 0.0, 0.9)]
    assert place_names(relations(*door), {}, {"door": 0}) == ("door-closed", "door-open", "door-ajar")


def test_doors_that_open_to_either_side_are_called_alike():
    door = [place_at(("door", "cabinet"), joint=hinge(), coordinate=c) for c in (0.0, 1.5, -1.6)]
    assert place_names(relations(*door), SIZES) == ("door-closed", "door-open", "door-open-2")


def test_places_of_one_pair_are_told_apart_by_height():
    shelves = [place_at(("food", "box"), (0, 0, z)) for z in (0.05, -0.05)]
    assert place_names(relations(*shelves), {"box": (0.1, 0.1, 0.1)}) == ("food-in-box-high", "food-in-box-low")
    level = [place_at(("food", "box"), (x, 0, 0)) for x in (-0.5, 0.5)]
    assert place_names(relations(*level), {}) == ("food-at-box-1", "food-at-box-2")
