import numpy as np
import pytest

from symskill_pddl.abstraction import Classifier, GripperRule
from symskill_pddl.describe import (
    absent_text,
    domain_comments,
    geometry_lines,
    geometry_text,
    gripper_text,
    operator_lines,
    operator_summary,
    short_absent,
    short_atom,
    skill_lines,
)
from symskill_pddl.geometry import Pose
from symskill_pddl.library import Evidence, LearnedOperator, Library
from symskill_pddl.scene import GRIPPER
from symskill_pddl.skills import Phase, Skill, Trajectory, fit_fields
from symskill_pddl.symbols import Absent, Atom, Operator, Parameter, Predicate


def classifier(**changes) -> Classifier:
    values = {
        "predicate": Predicate("food-on-counter", ("food", "counter")),
        "child": "food",
        "parent": "counter",
        "T_mean": Pose.from_rotvec([0.10, -0.0204, 0.031], [0, 0, np.radians(-90)]),
        "cov_p": np.diag([0.06, 0.04, 0.003]) ** 2,
        "cov_r": np.diag(np.radians([3.0, 2.0, 80.0])) ** 2,
        "enter_p": 3.0,
        "enter_r": 3.0,
    }
    return Classifier(**{**values, **changes})


def test_the_words_say_what_the_classifier_does():
    assert geometry_lines(classifier()) == (
        "food at x 10.0, y -2.0, z 3.1 cm in the counter's frame, give or take 18 x 12 x 0.9 cm",
        "turned 90 deg about -z, give or take 9.0 x 6.0 x 180 deg",
        "false again beyond 1.5 times that",
    )
    assert geometry_text(classifier()) == "; ".join(geometry_lines(classifier()))


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_stated_half_widths_are_where_the_classifier_turns_false(axis):
    c = classifier()
    width = c.enter_p * np.sqrt(c.cov_p[axis, axis])
    step = np.eye(3)[axis]
    assert c.holds(Pose(c.T_mean.p + 0.999 * width * step, c.T_mean.q))
    assert not c.holds(Pose(c.T_mean.p + 1.001 * width * step, c.T_mean.q))


def test_a_gripper_relation_and_a_free_axis():
    lines = geometry_lines(
        classifier(
            predicate=Predicate("gripper-holds-food", ("food",)), child=GRIPPER, parent="food", free_axis=np.array([0, 0, 2.0])
        )
    )
    assert lines[0].startswith("gripper at x 10.0")
    assert "in the food's frame" in lines[0]
    assert lines[1].endswith("free to turn about its own z axis")


def test_no_rotation_and_an_oblique_axis_and_no_minus_zero():
    still = geometry_lines(classifier(T_mean=Pose(np.array([-0.0001, 0, 0]), np.array([1.0, 0, 0, 0]))))
    assert still[0].startswith("food at x 0.0, y 0.0, z 0.0 cm")
    assert still[1].startswith("not turned, give or take")
    oblique = geometry_lines(classifier(T_mean=Pose.from_rotvec(np.zeros(3), np.array([1, 0, 1]) / np.sqrt(2))))
    assert oblique[1].startswith("turned 57 deg about (0.71, 0.00, 0.71)")


def test_gripper_rule():
    assert gripper_text(GripperRule(0.06, 0.05)) == (
        "built in: the fingers are told to open and are further apart than 6.0 cm; false again below 5.0 cm"
    )


def test_negative_conditions():
    atom = Atom("lid-on-pan", ("?lid", "?pan"))
    assert absent_text(Absent(atom)) == "not (lid-on-pan ?lid ?pan)"
    assert absent_text(Absent(atom, (Parameter("?lid", "lid"),))) == "no ?lid - lid with (lid-on-pan ?lid ?pan)"


def learned(**changes) -> LearnedOperator:
    held, opened = Atom("gripper-holds-food", ("?food",)), Atom("gripper-open")
    values = {
        "operator": Operator(
            "pick-food",
            (Parameter("?food", "food"),),
            frozenset({opened}),
            frozenset({held}),
            frozenset({opened}),
            frozenset({opened}),
        ),
        "strict_pre": frozenset({opened, held}),
        "skill": "pick-food",
        "kind": "pick",
        "evidence": (Evidence("a:demo_0", 0, 1, ()), Evidence("a:demo_0", 2, 3, ()), Evidence("a:demo_1", 0, 1, ())),
        "duration_s": (1.25, 2.0),
        "notes": ("a note",),
    }
    return LearnedOperator(**{**values, **changes})


def test_operator_lines():
    assert operator_lines(learned()) == (
        "pick, learned from 3 episodes in 2 demonstrations; took 1.2 s on average, 2.0 s at most",
        "skill pick-food",
        "maintains (gripper-open)",
        "also true in every demonstration at the start: (gripper-holds-food ?food)",
        "a note",
    )
    assert operator_lines(learned(evidence=(Evidence("a:demo_0", 0, 1, ()),)))[0].startswith(
        "pick, learned from 1 episode in 1 demonstration;"
    )


def test_what_a_note_gives_the_reason_of_is_said_once():
    told = "dropped precondition (gripper-holds-food ?food): one contact at a time"
    lines = operator_lines(learned(notes=(told,)))
    assert told in lines
    assert not any(line.startswith("also true") for line in lines)


def test_skill_lines_name_frames_fingers_and_what_they_do_at_the_end():
    t = np.linspace(0, 1, 21)
    (field,) = fit_fields([Trajectory(t, Pose(np.stack([1 - t, 0 * t, 0 * t], axis=1), np.tile([1.0, 0, 0, 0], (21, 1))))])
    phases = (Phase("?food", field, False, 0.01, 0.1, 2.0), Phase("?food", field, False, 0.02, 0.2, 1.0))
    assert skill_lines(Skill(phases, True)) == (
        "1. in ?food's frame, fingers open, about 2.0 s, until within 1.0 cm and 6 deg",
        "2. in ?food's frame, fingers open, about 1.0 s, until within 2.0 cm and 11 deg",
        "3. fingers close",
    )
    assert len(skill_lines(Skill(phases, False))) == 2


def test_comments_of_a_domain_cover_types_predicates_and_operators():
    library = Library((), (classifier(),), (learned(),), {}, extents={"food": (0.03, 0.02, 0.1)})
    comments = domain_comments(library)
    assert set(comments) == {"gripper-open", "food-on-counter", "pick-food", "food"}
    assert comments["food"] == ["fits a box of 6.0 x 4.0 x 20 cm"]
    assert all("\n" not in line for lines in comments.values() for line in lines)


def lid_operator(**changes):
    values = {
        "name": "pick-lid-from-cookware",
        "parameters": (Parameter("?lid", "lid"), Parameter("?cookware", "cookware"), Parameter("?lid-2", "lid")),
        "pre": frozenset({Atom("gripper-open"), Atom("lid-on-cookware", ("?lid", "?cookware"))}),
        "add": frozenset({Atom("gripper-holds-lid", ("?lid",))}),
        "delete": frozenset(),
    }
    return Operator(**{**values, **changes})


def test_operators_are_summed_up_from_their_types():
    def summary(name, kind, **changes):
        return operator_summary(LearnedOperator(lid_operator(name=name, **changes), frozenset(), name, kind, (), (1.0, 1.0)))

    assert summary("pick-lid-from-cookware", "pick") == "Pick lid from cookware"
    assert summary("place-lid-on-cookware", "place") == "Place lid → cookware"
    assert summary("pick-lid", "pick") == "Pick lid"
    assert summary("open-door", "move") == "Open door"


def test_atoms_are_as_short_as_they_are_clear():
    op = lid_operator()
    assert short_atom(Atom("lid-on-cookware", ("?lid", "?cookware")), op) == "lid-on-cookware"
    assert short_atom(Atom("lid-on-cookware", ("?lid-2", "?cookware")), op) == "lid-on-cookware(?lid-2, ?cookware)"
    absent = Absent(Atom("lid-on-cookware", ("?other", "?cookware")), (Parameter("?other", "lid"),))
    assert short_absent(absent, op) == "no lid-on-cookware"
    assert short_absent(Absent(Atom("gripper-open")), op) == "not gripper-open"
