import numpy as np
import pytest
from synthetic import EXTENTS, yaw_pose

from symskill_pddl.demos import Demo
from symskill_pddl.geometry import Pose
from symskill_pddl.learning.references import place
from symskill_pddl.learning.segments import rest

TYPES = {"cabinet": "cabinet", "counter": "counter", "door": "door", "cheese": "food", "bread": "food"}


def scene(name="demo_0", **poses):
    objects = {o: TYPES.get(o, o.rstrip("0123456789")) for o in poses}
    T = Pose.stack(list(poses.values()))
    n = 10
    return Demo(
        name=name,
        source="hand-made",
        task="any",
        times=np.arange(n) * 0.05,
        T_world_ee=Pose(np.zeros((n, 3)), np.tile([1.0, 0, 0, 0], (n, 1))),
        aperture=np.full(n, 0.08),
        gripper_closed=np.zeros(n, bool),
        objects=objects,
        T_world_objects=Pose(np.tile(T.p, (n, 1, 1)), np.tile(T.q, (n, 1, 1))),
    )


FIXTURES = {
    "cabinet": yaw_pose([0.77, 0, 0.67]),
    "counter": yaw_pose([0.56, 0, -0.02]),
    "door": yaw_pose([0.62, -0.19, 0.67], 1.6),
}


def chosen(demo, obj, hinged=False, extents=EXTENTS):
    (found,) = place([(demo, rest(demo, obj, 0, 10))], hinged, extents)
    assert found.margin > 0
    return found.ref


@pytest.mark.parametrize("extents", [EXTENTS, {}])
@pytest.mark.parametrize(
    ("p", "ref"), [([0.45, 0.2, 0.02], "counter"), ([0.72, 0.05, 0.49], "cabinet"), ([0.5, -0.1, 0.02], "counter")]
)
def test_one_demonstration_is_enough(p, ref, extents):
    demo = scene(cheese=yaw_pose(p), bread=yaw_pose([p[0], p[1] + 0.12, p[2]]), **FIXTURES)
    assert chosen(demo, "cheese", extents=extents) == ref


def test_a_door_hangs_on_its_cabinet():
    demo = scene(cheese=yaw_pose([0.72, 0.0, 0.49]), **FIXTURES)
    assert chosen(demo, "door", hinged=True) == "cabinet"


def test_what_stands_on_a_thing_of_its_own_type():
    demo = scene(cheese=yaw_pose([0.45, 0.2, 0.06]), bread=yaw_pose([0.45, 0.2, 0.02]), counter=FIXTURES["counter"])
    assert chosen(demo, "cheese") == "bread"


def test_the_tighter_frame_wins_where_the_priors_are_equal():
    rng = np.random.default_rng(0)
    rests = []
    for k in range(6):
        rack, tray = rng.uniform(-0.1, 0.1, 3), rng.uniform(-0.1, 0.1, 3)
        demo = scene(
            f"demo_{k}",
            pan=yaw_pose(tray + np.array([0, 0.3, 0.1])),
            rack=yaw_pose(rack),
            tray=yaw_pose(tray + np.array([0, 0.6, 0])),
        )
        rests.append((demo, rest(demo, "pan", 0, 10)))
    assert {found.ref for found in place(rests, False, {})} == {"tray"}


def test_one_odd_guess_follows_the_others():
    rests = []
    for k in range(5):
        away = 0.21 if k == 0 else 0.05  # once it lies nearer to the other tray
        demo = scene(f"demo_{k}", cup=yaw_pose([away, 0, 0.05]), tray=yaw_pose([0, 0, 0]), box=yaw_pose([0.40, 0, 0]))
        rests.append((demo, rest(demo, "cup", 0, 10)))
    assert [found.ref for found in place(rests, False, {})] == ["tray"] * 5


def test_a_scene_of_one_object_has_no_reference():
    demo = scene(cheese=yaw_pose([0, 0, 0]))
    assert place([(demo, rest(demo, "cheese", 0, 10))], False, {}) == ()


def test_what_slides_keeps_its_reference_when_it_is_nearer_to_another():
    """A drawer pulled out of its chest is nearer to the counter below than to the chest; it belongs to the chest all the same."""
    extents = {"chest": (0.16, 0.135, 0.1), "counter": (0.36, 0.9, 0.02), "drawer": (0.009, 0.13, 0.085)}
    rests = []
    for k in range(3):
        for x in (0.57, 0.37):
            demo = scene(
                f"demo_{k}",
                chest=yaw_pose([0.74 + 0.01 * k, 0.43, 0.1]),
                counter=FIXTURES["counter"],
                drawer=yaw_pose([x + 0.01 * k, 0.43, 0.1]),
            )
            rests.append((demo, rest(demo, "drawer", 0, 10)))
    assert {found.ref for found in place(rests[1::2], False, extents)} == {"counter"}
    assert {found.ref for found in place(rests, True, extents)} == {"chest"}


def test_what_is_hinged_does_not_belong_to_what_stands_by_it_once():
    """One recording with a tin right beside the lever does not make the tin what the lever is hinged to."""
    rests = []
    for k in range(5):
        poses = {"sink": yaw_pose([0.2, 0, 0]), "tin": yaw_pose([0.0, 0.08 if k == 0 else 0.9, 0])}
        for yaw in (0.0, 1.2):
            demo = scene(f"demo_{k}", lever=yaw_pose([0.0, 0, 0], yaw), **poses)
            rests.append((demo, rest(demo, "lever", 0, 10)))
    assert [found.ref for found in place(rests, True, {})] == ["sink"] * 10
