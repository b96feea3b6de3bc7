from dataclasses import replace

import numpy as np
import pytest
from fake_world import DOWN, HOME, FakeWorld, phase

from symskill_pddl.errors import InputError
from symskill_pddl.execution.config import MotionConfig
from symskill_pddl.execution.runner import SkillRun
from symskill_pddl.geometry import Pose
from symskill_pddl.skills import Skill, Superellipsoids

CONFIG = MotionConfig()
ABOVE, HAND = Pose([0, 0, 0.1], DOWN), Pose([0, 0, 0], DOWN)
PICK = Skill((phase("?food", ABOVE, False), phase("?food", HAND, False)), True)
BINDING = {"?food": "cheese", "?counter": "counter"}


def drive(world, run, seconds=10.0, until=lambda motion: False):
    motions = []
    while world.time < seconds:
        motions.append(run.tick(world.observe()))
        if until(motions[-1]):
            break
        world.step(motions[-1].command)
    return motions


def test_phases_in_order_then_the_fingers():
    world = FakeWorld()
    motions = drive(world, SkillRun(PICK, BINDING, world.observe(), CONFIG), 6.0)
    assert sorted({m.stage for m in motions}) == [0, 1, 2]
    assert [m.stage for m in motions] == sorted(m.stage for m in motions)
    assert not any(m.command.close_gripper for m in motions if m.stage < 2)
    assert world.grasp is not None
    settling = [m for m in motions if m.settling]
    assert settling
    assert all(np.all(m.command.twist == 0) for m in settling)
    # after the end the hand is still
    assert motions[-1].speed == 0.0


def test_closed_fingers_open_before_the_first_phase():
    world = FakeWorld(closed=True)
    run = SkillRun(PICK, BINDING, world.observe(), CONFIG)
    first = run.tick(world.observe())
    assert first.settling
    assert not first.command.close_gripper
    assert np.all(first.command.twist == 0)
    motions = drive(world, run, 1.0)
    assert not motions[-1].settling


def test_settling_is_bounded():
    world = FakeWorld()
    world.stuck_fingers = True
    motions = drive(world, SkillRun(PICK, BINDING, world.observe(), CONFIG), 12.0)
    waited = sum(m.settling for m in motions) * world.period_s
    assert waited == pytest.approx(CONFIG.settle_max_s, abs=0.11)
    assert motions[-1].stage == 2


def test_stage_time_starts_when_the_fingers_are_ready():
    world = FakeWorld(closed=True)
    motions = drive(world, SkillRun(PICK, BINDING, world.observe(), CONFIG), 2.0)
    first_free = next(m for m in motions if not m.settling)
    assert first_free.stage_s <= world.period_s + 1e-9


def test_the_frame_is_followed_live():
    world = FakeWorld()
    run = SkillRun(PICK, BINDING, world.observe(), CONFIG)
    drive(world, run, 1.0)
    world.cheese = Pose(world.cheese.p + np.array([0.1, 0.1, 0]), world.cheese.q)
    drive(world, run, 6.0)
    assert np.linalg.norm(world.ee.p - world.cheese.p) < 0.02


def test_the_shift_moves_the_goal_in_its_frame_only():
    world = FakeWorld()
    shift = Pose([0.0, 0.05, 0.0], [1.0, 0, 0, 0])
    run = SkillRun(PICK, BINDING, world.observe(), CONFIG, shift=("?food", shift))
    start = world.cheese.p
    drive(world, run, until=lambda m: m.stage == 2)
    assert np.linalg.norm(world.ee.p - start - [0, 0.05, 0]) < 0.01
    assert run.shift_vector == (0.0, 0.05, 0.0, 1.0, 0.0, 0.0, 0.0)
    other = SkillRun(PICK, BINDING, world.observe(), CONFIG, shift=("?counter", shift))
    world.ee = HOME
    drive(world, other, until=lambda m: m.stage == 2)
    assert np.linalg.norm(world.ee.p - start) < 0.01


def test_a_hand_at_rest_near_the_end_of_a_phase_goes_on():
    world = FakeWorld(ee=Pose(FakeWorld().cheese.p + np.array([0, 0.015, 0.1]), DOWN))
    world.frozen = True
    run = SkillRun(PICK, BINDING, world.observe(), CONFIG)
    # 15 mm away, tolerance 8 mm: held up by contact, say
    assert drive(world, run, 3.0)[-1].stage == 1
    strict = SkillRun(PICK, BINDING, world.observe(), replace(CONFIG, loose=1.0))
    assert drive(world, strict, 6.0)[-1].stage == 0


@pytest.mark.parametrize(("done", "leaves_at"), [(lambda: True, 0.005), (lambda: False, 0.002)])
def test_a_phase_carries_on_until_it_has_done_its_work_or_rests(done, leaves_at):
    """The tolerance does not end a phase that still has something to bring about; rest does."""
    world = FakeWorld()
    skill = Skill((replace(PICK.phases[1], tolerance_p=0.01), PICK.phases[0]), False)
    run = SkillRun(skill, BINDING, world.observe(), CONFIG, awaited=(0, done))
    motions = drive(world, run, 8.0, until=lambda m: m.stage == 1)
    away = float(np.linalg.norm(world.ee.p - world.cheese.p))
    assert motions[-1].stage == 1
    assert (away < leaves_at) if leaves_at < 0.005 else (leaves_at < away <= 0.01)


def test_caps():
    world = FakeWorld(ee=Pose([5.0, 5.0, 5.0], DOWN))
    motion = SkillRun(PICK, BINDING, world.observe(), replace(CONFIG, max_speed=0.1)).tick(world.observe())
    assert np.linalg.norm(motion.command.twist[:3]) == pytest.approx(0.1)
    assert motion.speed > 0.1


def test_flows_around_an_obstacle_and_reports_the_nominal_twist():
    world = FakeWorld()
    centre = 0.5 * (world.ee.p + world.cheese.p + [0, 0, 0.1])
    ball = Superellipsoids(Pose([centre], [[1.0, 0, 0, 0]]), np.full((1, 3), 0.06), np.zeros((1, 3)))
    run = SkillRun(PICK, BINDING, world.observe(), CONFIG, obstacles=lambda scene: ball)
    free = SkillRun(PICK, BINDING, world.observe(), CONFIG)
    assert run.tick(world.observe()).speed == free.tick(world.observe()).speed
    nearest = np.inf
    while world.time < 12.0:
        motion = run.tick(world.observe())
        world.step(motion.command)
        nearest = min(nearest, float(np.linalg.norm(world.ee.p - centre)))
        if motion.stage == 2:
            break
    assert motion.stage == 2
    assert nearest > 0.05


def test_an_obstacle_around_the_goal_is_ignored():
    world = FakeWorld()
    ball = Superellipsoids(Pose([world.cheese.p], [[1.0, 0, 0, 0]]), np.full((1, 3), 0.2), np.zeros((1, 3)))
    run = SkillRun(PICK, BINDING, world.observe(), CONFIG, obstacles=lambda scene: ball)
    assert drive(world, run, until=lambda m: m.stage == 2)[-1].stage == 2


def test_an_unbound_frame_is_refused():
    with pytest.raises(InputError, match=r"frame '\?food', the operator's parameters are \?thing"):
        SkillRun(PICK, {"?thing": "cheese"}, FakeWorld().observe(), CONFIG)


@pytest.mark.parametrize(
    ("setting", "message"),
    [
        ({"max_speed": 0.0}, "max_speed has to be positive"),
        ({"settle_min_s": 2.0}, "settle_min_s has to be between"),
        ({"loose": 0.5}, "loose has to be at least 1"),
    ],
)
def test_settings(setting, message):
    with pytest.raises(InputError, match=message):
        MotionConfig(**setting)
