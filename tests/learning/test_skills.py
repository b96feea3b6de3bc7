import numpy as np
import pytest

from symskill_pddl.geometry import Pose, rotation_distance
from symskill_pddl.learning import skills
from symskill_pddl.learning.skills import SkillConfig, _common_length, _direct, learn_skill
from symskill_pddl.skills import Trajectory, fit_phases

from .conftest import Symbols, kitchen_demos


@pytest.fixture(scope="module")
def groups():
    return Symbols.of(kitchen_demos(3)).groups


def path(points, dt=0.05):
    p = np.asarray(points, float)
    return Trajectory(np.arange(len(p)) * dt, Pose(p, np.tile([1.0, 0, 0, 0], (len(p), 1))))


def straight(a, b, n=30):
    return np.linspace(a, b, n)


@pytest.mark.parametrize(
    ("name", "pattern", "closed_at_end"),
    [
        ("reach-door-closed", [("?door", False)], True),
        ("move-door-ajar", [("?cabinet", True), ("?door", False)], False),
        ("reach-door-ajar", [("?door", False), ("?door", True)], True),
        ("pick-food-from-cabinet", [("?food", False)], True),
        ("place-food-on-counter", [("?counter", True), ("?food", False)], False),
    ],
)
def test_phases_frames_and_fingers(groups, name, pattern, closed_at_end):
    skill, _ = learn_skill(groups[name], SkillConfig(max_fields=1))
    seen = [(p.frame, p.close_gripper) for p in skill.phases]
    assert [s for k, s in enumerate(seen) if k == 0 or s != seen[k - 1]] == pattern
    assert skill.close_gripper_at_end is closed_at_end


def test_a_skill_arrives_from_where_the_demonstrations_start(groups):
    group = groups["pick-food-from-counter"]
    skill, _ = learn_skill(group)
    for t in group.transitions:
        frame, ee = t.demo.pose(t.label.episode.obj)[t.begin], t.demo.T_world_ee[t.begin]
        for phase in skill.phases:
            for _ in range(600):
                if phase.reached(frame, ee):
                    break
                twist = phase.twist(frame, ee)
                ee = Pose(ee.p + 0.05 * twist[:3], (Pose.from_rotvec(np.zeros(3), 0.05 * twist[3:]) @ Pose(np.zeros(3), ee.q)).q)
            assert phase.reached(frame, ee)
        held = t.label.episode
        contact = held.demo.T_world_ee[held.start]
        assert np.linalg.norm(ee.p - contact.p) < 0.02
        assert rotation_distance(ee, contact) < np.radians(10)


@pytest.mark.parametrize(("name", "stray"), [("pick-food-from-cabinet", {0.027}), ("place-food-on-counter", {np.inf})])
def test_only_approaches_have_to_come_in_well_from_anywhere(groups, monkeypatch, name, stray):
    seen = []

    def recording(*arguments):
        seen.append(arguments[-1].max_stray_m)
        return fit_phases(*arguments)

    monkeypatch.setattr(skills, "fit_phases", recording)
    learn_skill(groups[name], SkillConfig(max_fields=1))
    assert set(seen) == stray


def test_a_second_approach_is_cut_out():
    direct = [straight([0.3, 0, 0.01 * k], [0, 0, 0]) for k in range(3)]
    twice = np.concatenate(
        [straight([0.3, 0, 0], [0.05, 0, 0]), straight([0.05, 0, 0], [0.2, 0.02, 0]), straight([0.2, 0.02, 0], [0, 0, 0])]
    )
    out = _direct([*map(path, direct), path(twice)], 0.08)
    distance = np.linalg.norm(out[-1].T_frame_ee.p, axis=-1)
    assert distance[0] > 0.29
    assert np.all(np.diff(distance) < 0.004)
    assert all(len(a) == len(b) for a, b in zip(out[:3], direct, strict=True))
    assert np.all(np.diff(out[-1].times) > 0)


def test_a_way_round_that_most_take_is_kept():
    round_about = [np.concatenate([straight([0.1, 0, 0], [0.2, 0.2, 0]), straight([0.2, 0.2, 0], [0, 0, 0])]) for _ in range(3)]
    out = _direct([*map(path, round_about), path(straight([0.3, 0, 0], [0, 0, 0]))], 0.08)
    assert [len(p) for p in out] == [60, 60, 60, 30]


def test_retreats_are_cut_to_a_common_length():
    out = _common_length([path(straight([0, 0, 0], [x, 0, 0])) for x in (0.1, 0.11, 0.4, 0.5)])
    assert all(0.09 < np.linalg.norm(p.end.p) < 0.13 for p in out)
