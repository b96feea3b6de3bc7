from dataclasses import replace

import numpy as np
import pytest

from symskill_pddl.demos import Demo
from symskill_pddl.demos.gravity import AXES, up_axis
from symskill_pddl.demos.inspection import inspect_demo, spans
from symskill_pddl.demos.suspicions import suspicions
from symskill_pddl.demos.timeline import Cut, timeline_svg
from symskill_pddl.geometry import Pose, quat_exp, quat_multiply

HZ = 20.0
DOWN = np.array([0.0, 1.0, 0.0, 0.0])


def carry(*, sigma_m: float = 0.0, seed: int = 0, name: str = "demo_0") -> Demo:
    """The hand comes to a box from 1 to 3 s, closes at 3.5 s, carries it 30 cm along x over 10 cm from 4 to 6 s, and goes."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 9.0, 1 / HZ)
    come, bring, go = (np.clip((t - a) / 2.0, 0.0, 1.0) for a in (1.0, 4.0, 7.0))
    box = np.stack([0.3 * bring, 0 * t, 0.1 * np.sin(np.pi * bring)], axis=1)
    hand = box + np.stack([0 * t, 0 * t, 0.2 * (1 - come) + 0.2 * go], axis=1)
    closed = (t >= 3.5) & (t < 6.5)
    aperture = np.clip(0.08 - 0.4 * np.clip(t - 3.5, 0, 0.1) + 0.4 * np.clip(t - 6.5, 0, 0.1), 0, 1)
    p = np.stack([box, 0 * box + [0, 0.2, -0.05]], axis=1) + sigma_m * rng.standard_normal((len(t), 2, 3))
    q = quat_multiply(np.array([1.0, 0, 0, 0]), quat_exp(2 * sigma_m * rng.standard_normal((len(t), 2, 3))))
    return Demo(
        name, "file", "Carry", t + 100.0, Pose(hand, np.tile(DOWN, (len(t), 1))), aperture, closed,
        {"box": "cube", "tray": "tray"}, Pose(p, q),
    )  # fmt: skip


def turned(demo: Demo, R: Pose) -> Demo:
    return replace(demo, T_world_ee=R @ demo.T_world_ee, T_world_objects=R @ demo.T_world_objects)


def lines(*demos: Demo) -> str:
    return "\n".join(suspicions(demos, [inspect_demo(demo) for demo in demos]))


@pytest.mark.parametrize("sigma", [0.0, 0.001, 0.002])
def test_a_tidy_recording_is_seen_as_it_is(sigma):
    demo = carry(sigma_m=sigma)
    found = inspect_demo(demo)
    assert found.clock.rate_hz == pytest.approx(HZ)
    assert found.clock.gaps == ()
    assert (found.grip.switches, found.grip.follows) == (2, pytest.approx(1.0))
    box, tray = found.tracks
    assert tray.moves == ()
    ((start, stop),) = box.moves
    assert start == pytest.approx(4.0, abs=0.4)
    assert stop == pytest.approx(6.0, abs=0.4)
    assert box.jitter_m == pytest.approx(sigma, rel=0.4, abs=1e-9)
    assert lines(demo) == ""


def test_drop_outs_freezes_and_jumps_are_told_apart():
    demo = carry(sigma_m=0.001)
    p, q = demo.T_world_objects.p.copy(), demo.T_world_objects.q.copy()
    p[30:50, 1], q[30:50, 1] = p[30, 1], q[30, 1]
    p[20, 0] += 0.5
    seen = np.ones((len(demo), 2), bool)
    seen[60:70, 0] = False
    odd = replace(demo, T_world_objects=Pose(p, q), seen=seen)
    box, tray = inspect_demo(odd).tracks
    assert box.unseen[0] == pytest.approx((3.0, 3.5))
    assert tray.frozen[0] == pytest.approx((1.55, 2.5))
    assert (box.jumps, tray.jumps) == (1, 0)
    assert tray.seen == pytest.approx(1 - 19 / len(demo))
    told = lines(odd)
    assert "file:demo_0: box is not seen in 1 stretches, the longest 0.50 s" in told
    assert "file:demo_0: the tracker of tray freezes 1 times, up to 0.95 s" in told
    assert "file:demo_0: box jumps away for single samples, 1 times" in told


def test_gaps_and_clocks_that_were_set():
    times = carry().times.copy()
    times[50:] += 0.4
    times[120:] += 65.0
    demo = replace(carry(), times=times)
    assert [round(b - a, 2) for a, b in inspect_demo(demo).clock.gaps] == [0.45, 65.05]
    assert "the clock jumps by 65.0 s at 6.35 s" in lines(demo)
    assert "1 gaps in time, the longest 0.45 s at 2.45 s" in lines(demo)
    assert spans(demo, np.ones(len(demo), bool))[0][1] == pytest.approx(2.5)


@pytest.mark.parametrize(
    ("changes", "line"),
    [
        (
            {"aperture": np.full(180, 0.08), "gripper_closed": np.zeros(180, bool)},
            "never moves, and is never told to, while box goes",
        ),
        ({"aperture": np.full(180, 0.08)}, "the gripper never moves, though it is told to, while box goes with the hand"),
        ({"gripper_closed": ~carry().gripper_closed}, r"the fingers do not follow the gripper's command (-100% of their travel)"),
        ({"aperture": 1000 * carry().aperture}, "are apertures given in millimetres?"),
        ({"times": carry().times * 4}, "only 5.0 samples per second"),
    ],
)
def test_what_is_suspicious_of_one(changes, line):
    assert line in lines(replace(carry(), **changes))


def test_a_still_recording_shows_nothing():
    demo = carry()
    still = replace(demo, T_world_objects=demo.T_world_objects[np.zeros(len(demo), int)])
    assert "no object moves: nothing can be learned from it" in lines(still)


def test_recordings_that_do_not_fit_together():
    one = carry()
    other = replace(
        carry(seed=1, sigma_m=0.001, name="demo_1"),
        T_world_ee=Pose(one.T_world_ee.p + 0.01, one.T_world_ee.q),
        objects={"box": "block", "plate": "tray"},
        times=one.times * 2,
    )
    told = lines(one, other)
    assert "tray is not in file:demo_1: what they show counts without it" in told
    assert "box is of types block, cube" in told
    assert "rates differ, from 10.0 to 20.0 samples per second" in told
    assert "file:demo_0 and file:demo_2 are the same recording" in lines(one, replace(one, name="demo_2"))


def test_what_is_said_of_several_is_one_line():
    odd = [replace(carry(name=f"demo_{k}"), aperture=np.full(180, 0.08 + 0.001 * k), times=carry().times + k) for k in range(7)]
    first = lines(*odd).splitlines()[0]
    assert first.startswith("file:demo_0, file:demo_1, file:demo_2, file:demo_3, file:demo_4 and 2 more: the gripper never moves")


@pytest.mark.parametrize("axis", list(AXES))
def test_up_is_where_things_are_lifted_to(axis):
    z, up = np.array([0.0, 0.0, 1.0]), np.array(AXES[axis], float)
    across = np.cross(z, up)
    R = Pose(
        np.array([0.3, -0.2, 0.1]), quat_exp(across * np.pi / 2 if np.any(across) else np.array([np.pi, 0, 0]) * (up[2] < 0))
    )
    found = up_axis([turned(carry(sigma_m=0.001), R)])
    assert found is not None
    assert found.axis == axis
    assert found.lead > 0.5
    assert (f"{axis} seems to be up" in lines(turned(carry(), R))) == (axis != "+z")


def test_nothing_tells_the_way_up_where_nothing_is_lifted_nor_grasped():
    demo = carry()
    flat = demo.T_world_objects.p * [1.0, 1.0, 0.0]
    assert (
        up_axis([replace(demo, T_world_objects=Pose(flat, demo.T_world_objects.q), gripper_closed=np.zeros(len(demo), bool))])
        is None
    )


def test_the_picture_has_a_row_for_everything_and_the_same_bytes():
    demo = replace(carry(), objects={"<b>&co": "cube", "tray": "tray"})
    found = [inspect_demo(demo)]
    svg = timeline_svg([demo], found, {demo.where: [Cut(1.0, 6.0, "pick")]})
    assert svg == timeline_svg([demo], found, {demo.where: [Cut(1.0, 6.0, "pick")]})
    assert "&lt;b&gt;&amp;co" in svg
    assert svg.count("stroke-dasharray") == 2
    assert "pick" in svg
    assert "polyline" in svg
