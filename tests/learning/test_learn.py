import dataclasses
import random
from pathlib import Path

import numpy as np
import pytest
from synthetic import Recorder, facing, record, yaw_pose

from symskill_pddl.demos import Demo
from symskill_pddl.errors import LearningError
from symskill_pddl.geometry import Pose
from symskill_pddl.learning import LearnConfig, added, learn, learn_reported
from symskill_pddl.learning.skills import SkillConfig
from symskill_pddl.symbols import Atom

FAST = LearnConfig(skills=SkillConfig(max_fields=1))
"""Coarse fields: what is tested here is not how well they follow."""

RECORDINGS = Path(__file__).parents[1] / "data" / "robosuite"


def files(folder):
    return {f.relative_to(folder).as_posix(): f.read_bytes() for f in sorted(folder.rglob("*")) if f.is_file()}


@pytest.fixture(scope="module")
def demos():
    return (*record("PnPCabToCounter", 2), *record("OpenSingleDoor", 1))


@pytest.fixture(scope="module")
def learned(demos):
    return learn_reported(demos, FAST)


def test_the_order_of_the_demonstrations_does_not_matter(demos, learned, tmp_path):
    shuffled = list(demos)
    random.Random(4).shuffle(shuffled)
    learned[0].save(tmp_path / "a")
    learn(shuffled, FAST, jobs=2).save(tmp_path / "b")
    assert files(tmp_path / "a") == files(tmp_path / "b")


def test_what_comes_out(learned):
    library, report = learned
    assert {t.name for t in library.types} == {"cabinet", "counter", "door", "food"}
    assert library.domain().operator("pick-food-from-cabinet")
    assert set(library.skills) == {o.skill for o in library.operators}
    assert {name for name, _ in report.seconds} == {"segments", "predicates", "operators", "skills"}
    goals = {g.task: g for g in library.goals}
    assert goals["PnPCabToCounter"].atoms == {Atom("food-on-counter", ("?food", "?counter"))}
    assert goals["OpenSingleDoor"].atoms == {Atom("door-open", ("?door", "?cabinet"))}
    assert [p.name for p in goals["PnPCabToCounter"].parameters] == ["?food", "?counter"]
    assert library.gripper.open_above == pytest.approx(0.06)


def test_the_strict_domain_binds_all_its_variables(learned):
    strict = learned[0].domain(strict=True).operator("pick-food-from-cabinet")
    assert learned[0].learned("pick-food-from-cabinet").strict_pre == strict.pre
    assert not strict.absent


def test_progress_is_told_by_stage(demos):
    stages = []
    learn(demos[:1], FAST, progress=stages.append)
    assert stages == ["segments", "predicates", "operators", "skills"]


def test_a_lift_that_ends_in_the_air_is_a_pick_and_a_lift():
    rng = np.random.default_rng(0)
    r = Recorder(rng, {"table": ("table", yaw_pose([0.5, 0, -0.02])), "cube": ("cube", yaw_pose([0.5, 0.1, 0.02]))}, faults=False)
    r.reach(Pose(r.poses["cube"].p, facing(0.0, 1.4)))
    r.grasp("cube", 0.04)
    r.go(Pose([0.5, 0.1, 0.2], r.T.q))
    library, report = learn_reported([r.demo("demo_0", "lift", "Lift")], FAST)
    holds, above = Atom("gripper-holds-cube", ("?cube",)), Atom("cube-above-table", ("?cube", "?table"))
    pick, lift = (library.learned(name).operator for name in ("pick-cube-from-table", "lift-cube"))
    assert (pick.add, pick.delete) == ({holds}, {Atom("cube-at-table", ("?cube", "?table")), Atom("gripper-open")})
    assert (lift.pre, lift.add, lift.delete) == ({holds}, {above}, frozenset())
    assert [goal.atoms for goal in library.goals] == [{holds, above}]
    assert report.left_out == ()
    on, half, full = (library_holds(library, rise) for rise in (0.02, 0.1, 0.2))
    assert (on, half, full) == (False, False, True)


def library_holds(library, height):
    (above,) = (c for c in library.classifiers if c.predicate.name == "cube-above-table")
    return above.holds(yaw_pose([0.5, 0, -0.02]).inverse() @ yaw_pose([0.5, 0.1, height]))


def still(name="demo_0"):
    n = 40
    T = np.tile([1.0, 0, 0, 0], (n, 1))
    return Demo(
        name=name,
        source="still",
        task="none",
        times=np.arange(n) * 0.05,
        T_world_ee=Pose(np.zeros((n, 3)), T),
        aperture=np.full(n, 0.08),
        gripper_closed=np.zeros(n, bool),
        objects={"box": "box"},
        T_world_objects=Pose(np.zeros((n, 1, 3)), T[:, None]),
    )


def test_one_clear_line_when_there_is_nothing_to_learn():
    with pytest.raises(LearningError, match="there are no demonstrations to learn from"):
        learn([])
    with pytest.raises(LearningError, match="no object moves in any of the 1 demonstrations"):
        learn([still()])
    with pytest.raises(LearningError, match="two demonstrations are called 'still:demo_0'"):
        learn([still(), still()])


def test_lifts_recorded_by_people():
    """robosuite's own recordings: approach, grasp and the moved object come out of unlabelled human data."""
    from symskill_pddl.demos.robosuite_import import import_robosuite

    demos = import_robosuite(RECORDINGS / "panda_lift.hdf5")
    library, report = learn_reported(demos, FAST)
    learned, lift = library.learned("pick-cube-from-table"), library.learned("lift-cube")
    assert (learned.kind, learned.support, lift.support) == ("pick", len(demos), len(demos))
    assert Atom("gripper-open") in learned.operator.pre & learned.operator.delete
    assert learned.operator.add == {Atom("gripper-holds-cube", ("?cube",))}
    assert Atom("cube-at-table", ("?cube", "?table")) in learned.operator.delete
    skill = library.skills[learned.skill]
    assert skill.close_gripper_at_end
    assert np.linalg.norm(skill.phases[-1].field.T_goal.p) < 0.03
    assert report.summary == f"{len(demos)} of {len(demos)} episodes used; 2 operators"


def test_what_a_library_was_learned_from_comes_back_with_what_is_new(demos, learned):
    union = added(learned[0], [dataclasses.replace(demos[0], name="demo_9", times=demos[0].times * 1.01)])
    assert sorted(d.where for d in union[:-1]) == sorted(d.where for d in demos)
    with pytest.raises(LearningError, match=f"there is the demonstration '{demos[0].where}', already"):
        added(learned[0], demos[:1])
    with pytest.raises(LearningError, match=f"'.*demo_77', there called '{demos[0].where}', already"):
        added(learned[0], [dataclasses.replace(demos[0], name="demo_77")])
    with pytest.raises(LearningError, match=f"another demonstration called '{demos[0].where}'"):
        added(learned[0], [dataclasses.replace(demos[0], times=demos[0].times * 1.01)])
    with pytest.raises(LearningError, match="does not hold the demonstrations"):
        added(dataclasses.replace(learned[0], recordings={}), demos[:1])
