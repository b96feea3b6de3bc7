from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from synthetic import record

from symskill_pddl.abstraction import (
    DEBOUNCE_S,
    Classifier,
    Debounced,
    GripperRule,
    _table,
    abstract,
    abstract_recording,
    debounce,
    groundings,
    hysteresis,
    one_place,
    one_place_along,
    swing,
)
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose, quat_exp, quat_log, quat_multiply
from symskill_pddl.scene import GRIPPER, Scene
from symskill_pddl.symbols import GRIPPER_OPEN, Atom, Predicate

Z = np.array([0.0, 0.0, 1.0])


def classifier(T_mean=None, *, name="at", child="food", parent="table", sigma=0.01, rad=0.1, **more):
    types = (parent,) if child == GRIPPER else (child, parent)
    cov_p, cov_r = np.eye(3) * sigma**2, np.eye(3) * rad**2
    return Classifier(
        Predicate(name, types), child, parent, Pose.identity() if T_mean is None else T_mean, cov_p, cov_r, 3.0, 3.0, **more
    )


def at(x):
    return Pose(np.array([x, 0.0, 0.0]), np.array([1.0, 0, 0, 0]))


def test_margin_is_one_at_the_mean_and_zero_on_the_boundary():
    c = classifier()
    assert c.margin(at(0.0)) == 1.0
    assert np.isclose(c.margin(at(0.03)), 0.0)
    assert c.margin(at(0.04)) < 0
    assert np.allclose(
        c.margin(Pose(np.zeros((2, 3)), np.stack([quat_exp(np.array([0.3, 0, 0])), quat_exp(np.zeros(3))]))), [0.0, 1.0]
    )


def test_it_is_left_later_than_entered():
    c = classifier(leave_factor=1.5)
    assert not c.holds(at(0.04))
    assert c.holds(at(0.04), before=True)
    assert not c.holds(at(0.046), before=True)


@given(st.integers(0, 10_000))
def test_the_sign_of_a_quaternion_and_half_turns_do_not_matter(seed):
    rng = np.random.default_rng(seed)
    mean = Pose(np.zeros(3), rng.normal(size=4))
    c = classifier(mean, rad=0.5)
    T = Pose(rng.normal(0, 0.01, 3), rng.normal(size=4))
    assert np.isclose(c.margin(T), c.margin(Pose(T.p, -T.q)))
    near = Pose(np.zeros(3), quat_multiply(mean.q, quat_exp(np.array([1e-3, 0, 0]))))
    assert c.margin(near) > 0.99


@given(st.integers(0, 10_000), st.floats(-3.0, 3.0))
def test_the_turn_about_a_free_axis_does_not_count(seed, turn):
    rng = np.random.default_rng(seed)
    c = classifier(Pose(np.zeros(3), rng.normal(size=4)), free_axis=np.array([0.0, 0.0, 2.0]))
    tilted = quat_multiply(c.T_mean.q, quat_exp(0.2 * np.array([1.0, 0.0, 0.0])))
    spun = quat_multiply(tilted, quat_exp(turn * Z))
    assert np.isclose(c.margin(Pose(np.zeros(3), tilted)), c.margin(Pose(np.zeros(3), spun)), atol=1e-9)


def test_swing_of_a_half_turn_about_another_axis_is_itself():
    q = quat_exp(np.array([np.pi, 0.0, 0.0]))
    assert np.allclose(np.abs(swing(q, Z)), np.abs(q))


@settings(max_examples=50)
@given(st.integers(0, 10_000), st.floats(0.1, 1.0))
def test_samples_hold(seed, radius):
    rng = np.random.default_rng(seed)
    c = classifier(Pose(rng.normal(size=3), rng.normal(size=4)), rad=0.2)
    sample = c.sample(rng, radius=radius)
    assert c.margin(sample) >= 1.0 - radius - 1e-9


@pytest.mark.parametrize(
    ("what", "message"),
    [
        ({"sigma": 0.0}, "cov_p has to be a positive definite"),
        ({"rad": 0.0}, "cov_r has to be"),
        ({"leave_factor": 0.5}, "leave_factor at least 1"),
        ({"fingers": (0.05, 0.02)}, "the narrower first"),
    ],
)
def test_shapes_that_are_none(what, message):
    with pytest.raises(InputError, match=message):
        classifier(**what)


def test_groundings_are_injective_and_typed():
    objects = {"a": "food", "b": "food", "t": "table"}
    assert [str(g[0]) for g in groundings(classifier(), objects)] == ["(at a t)", "(at b t)"]
    assert [str(g[0]) for g in groundings(classifier(parent="food"), objects)] == ["(at a b)", "(at b a)"]
    assert [str(g[0]) for g in groundings(classifier(child=GRIPPER), objects)] == ["(at t)"]


@given(st.lists(st.floats(-1, 1), min_size=1, max_size=40), st.floats(1.0, 2.0))
def test_hysteresis_is_that_of_the_classifier(margins, factor):
    state, expected = False, []
    for m in margins:
        state = m >= (1.0 - factor if state else 0.0)
        expected.append(state)
    assert hysteresis(np.array(margins), factor).tolist() == expected


@given(st.lists(st.tuples(st.booleans(), st.floats(0.004, 0.2)), min_size=1, max_size=40), st.floats(0.0, 0.5))
def test_debouncing_a_recording_is_debouncing_moment_by_moment(raw, seconds):
    atom, times = Atom("p"), np.cumsum([gap for _, gap in raw])
    state = Debounced(frozenset({atom} if raw[0][0] else ()), float(times[0]), seconds)
    expected = [raw[0][0]]
    for (reading, _), time in zip(raw[1:], times[1:].tolist(), strict=True):
        state = state.update(frozenset({atom} if reading else ()), time)
        expected.append(atom in state.state)
    assert debounce(np.array([reading for reading, _ in raw]), times, seconds).tolist() == expected


@pytest.mark.parametrize(("rate", "late"), [(5, 0), (20, 1), (240, 17)])
def test_debouncing_is_a_matter_of_seconds_at_any_rate(rate, late):
    truth = np.arange(60) >= 30
    found = debounce(truth, np.arange(60) / rate, DEBOUNCE_S)
    assert int(np.argmax(found)) == 30 + late


def test_one_closed_hand_holds_what_stops_its_fingers_and_nothing_else():
    holds = classifier(name="holds", child=GRIPPER, fingers=(0.02, 0.04))
    atom = Atom("holds", ("desk",))
    scene = Scene(0.0, Pose.identity(), 0.03, True, {"desk": "table"}, Pose.stack([Pose.identity()]))
    assert atom in abstract(scene, [holds])
    for what in ({"aperture": 0.0}, {"aperture": 0.08}, {"gripper_closed": False}):  # empty, stuck, told to open
        assert atom not in abstract(replace(scene, **what), [holds], before=frozenset({atom}))


def place(name, parent, half, precedence=0.0):
    cov = np.diag(np.square(half)) / 9.0
    eye = np.eye(3) * 0.01
    return Classifier(
        Predicate(name, ("food", parent)), "food", parent, Pose.identity(), cov, eye, 3.0, 3.0, precedence=precedence
    )


def test_an_object_is_at_one_place_the_narrowest_unless_precedence_says_otherwise():
    on_counter, on_plate = place("on-counter", "counter", (0.3, 0.6, 0.01)), place("on-plate", "plate", (0.04, 0.04, 0.01))
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
    found = one_place_along(truth, [on_counter, on_plate])
    assert found[wide].tolist() == [True, False, True, False]
    assert all(found[atom].tolist() == truth[atom].tolist() for atom in (narrow, other, door))
    for i in range(4):
        state = frozenset(atom for atom, row in truth.items() if row[i])
        assert one_place(state, [on_counter, on_plate]) == {atom for atom, row in found.items() if row[i]}
    assert one_place(frozenset({wide, narrow}), [on_counter, place("on-plate", "plate", (0.04, 0.04, 0.01), 0.5)]) == {wide}


def test_a_recording_is_abstracted_as_its_scenes_are():
    (demo,) = record("PnPCabToCounter", 1)
    T = (
        demo.pose("counter")[-1].inverse()
        @ demo.pose("can" if "can" in demo.objects else next(o for o, t in demo.objects.items() if t == "food"))[-1]
    )
    classifiers = [
        classifier(T, name="put", child="food", parent="counter", sigma=0.02, rad=0.3),
        classifier(
            demo.pose("door")[0].inverse() @ demo.T_world_ee[0], name="near", child=GRIPPER, parent="door", sigma=0.03, rad=0.3
        ),
    ]
    rule = GripperRule()
    demo = replace(demo, times=10.0 * demo.times)  # so slow that every reading counts
    truth = abstract_recording(demo, classifiers, rule)
    state, seen = frozenset(), set()
    for i in range(len(demo)):
        state = abstract(demo.scene(i), classifiers, before=state, gripper=rule)
        assert state == {atom for atom, value in truth.items() if value[i]}
        seen |= state
    assert {a.predicate for a in seen} == {GRIPPER_OPEN, "put", "near"}


def test_the_fingers_are_open_when_both_say_so():
    rule = GripperRule(0.06, 0.05)
    assert rule.holds(0.07, False)
    assert not rule.holds(0.07, True)
    assert not rule.holds(0.055, False)
    assert rule.holds(0.055, False, before=True)
    assert np.isclose(float(np.linalg.norm(quat_log(quat_exp(0.1 * Z)))), 0.1)


@given(st.integers(0, 10_000))
def test_all_groundings_at_once_are_each_by_itself(seed):
    rng = np.random.default_rng(seed)
    objects = {"a": "food", "b": "food", "c": "tray", "d": "table"}
    scene = Scene(
        0.0,
        Pose(rng.normal(size=3), rng.normal(size=4)),
        0.08,
        False,
        objects,
        Pose(rng.normal(size=(4, 3)), rng.normal(size=(4, 4))),
    )
    wide = {"sigma": 0.4, "rad": 0.8}
    kinds = [
        classifier(Pose(rng.normal(size=3), rng.normal(size=4)), name="on", **wide),
        classifier(
            Pose(rng.normal(size=3), rng.normal(size=4)), name="on-edge", leave_factor=1.2, free_axis=rng.normal(size=3), **wide
        ),
        classifier(Pose(rng.normal(size=3), rng.normal(size=4)), name="by", parent="food", **wide),
        classifier(Pose(rng.normal(size=3), rng.normal(size=4)), name="held", child=GRIPPER, parent="tray", free_axis=Z, **wide),
        classifier(name="nowhere", parent="shelf"),
    ]
    every = [(c, *g) for c in kinds for g in groundings(c, objects)]
    before = frozenset(atom for _, atom, _, _ in every if rng.random() < 0.5)
    margins = _table(tuple(kinds), tuple(objects.items())).margins(scene)
    expected = set()
    for margin, (c, atom, parent, child) in zip(margins, every, strict=True):
        T = scene.pose(parent).inverse() @ scene.pose(child)
        assert abs(margin - c.margin(T)) < 1e-12 * max(1.0, abs(margin))
        if c.holds(T, before=atom in before):
            expected.add(atom)
    assert abstract(scene, kinds, before=before) == expected | {Atom(GRIPPER_OPEN)}


def test_an_atom_about_an_unseen_object_keeps_its_value():
    c = classifier()
    atom, objects = Atom("at", ("cheese", "desk")), {"cheese": "food", "desk": "table"}
    here = Scene(0.0, Pose.identity(), 0.0, True, objects, Pose.stack([at(0.0), at(0.0)]))
    away = Scene(0.0, Pose.identity(), 0.0, True, objects, Pose.stack([at(1.0), at(0.0)]))
    for name in objects:
        assert abstract(replace(away, unseen=frozenset({name})), [c], before=frozenset({atom})) == {atom}
        assert abstract(replace(here, unseen=frozenset({name})), [c]) == frozenset()
    assert abstract(away, [c], before=frozenset({atom})) == frozenset()


def test_along_a_recording_an_unseen_object_changes_nothing():
    c = classifier()
    x = np.array([1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0])
    seen = np.array([[0, 1, 1, 1, 1, 0, 0, 1], [1] * 8], bool).T
    T = Pose(
        np.stack([np.stack([x, 0 * x], axis=1), np.zeros((8, 2)), np.zeros((8, 2))], axis=2), np.tile([1.0, 0, 0, 0], (8, 2, 1))
    )
    recorded = SimpleNamespace(
        times=np.arange(8.0),
        objects={"cheese": "food", "desk": "table"},
        T_world_ee=T[:, 0],
        aperture=np.zeros(8),
        gripper_closed=np.ones(8, bool),
        T_world_objects=T,
        seen=seen,
    )
    found = abstract_recording(recorded, [c])
    np.testing.assert_array_equal(found[Atom("at", ("cheese", "desk"))], [0, 0, 1, 1, 1, 1, 1, 0])
