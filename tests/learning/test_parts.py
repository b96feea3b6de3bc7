"""Steps of an episode: a latch that turns before its door, and what the recording leaves in the hand."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from symskill_pddl.geometry import Pose, quat_exp
from symskill_pddl.learning.parts import continues, stepwise
from symskill_pddl.learning.segments import Episode, Rest


def turning(angles):
    """Poses (n,) that turn about the vertical."""
    return Pose(np.zeros((len(angles), 3)), np.stack([quat_exp(np.array([0.0, 0.0, a])) for a in angles]))


class Recording(SimpleNamespace):
    def __len__(self):
        return len(self.aperture)

    def sees(self, name):
        return np.ones(len(self), dtype=bool)


@pytest.fixture
def pulled():
    """A latch turns over samples 10 to 20, its door over 20 to 30."""
    door = turning(np.concatenate([np.zeros(20), np.linspace(0.0, 1.0, 10), np.ones(10)]))
    latch = turning(np.concatenate([np.zeros(10), np.linspace(0.0, 1.4, 10), 1.4 + np.linspace(0.0, 1.0, 10), 2.4 * np.ones(10)]))
    poses = {"door": door, "latch": latch}
    demo = Recording(where="d:demo_0", aperture=np.full(40, 0.08), gripper_closed=np.ones(40, bool), pose=poses.__getitem__)
    before, body_before = Rest("d:demo_0", "latch", 0, 10, latch[0]), Rest("d:demo_0", "door", 0, 10, door[0])
    after = Rest("d:demo_0", "door", 30, 40, door[39])
    return Episode(demo, "latch", 0, 10, 30, None, 39, ("door",), before, after, "door", body_before)


def test_a_latch_turns_and_then_its_door(pulled):
    turn, opening = stepwise([pulled])
    assert (turn.obj, turn.body, turn.start, turn.after.obj, turn.after.held) == ("latch", None, 10, "latch", True)
    assert 20 <= turn.stop <= 22
    assert (opening.obj, opening.body, opening.stop, opening.after) == ("latch", "door", 30, pulled.after)
    assert (opening.start, opening.before.key) == (turn.stop, turn.after.key)
    assert (continues(turn), continues(opening)) == (False, True)


def test_what_is_in_the_hand_at_the_end_has_been_lifted_to_there(pulled):
    held = replace(pulled, body=None, body_before=None, after=None, obj="door", before=pulled.body_before, grasped=5)
    (episode,) = stepwise([held])
    assert (episode.after.obj, episode.after.held, episode.after.stop) == ("door", True, 40)
    begun_in_hand = replace(held, before=None)
    assert stepwise([begun_in_hand]) == (begun_in_hand,)


def test_what_has_just_been_let_go_of_rests_where_it_is_unless_it_falls(pulled):
    pulled.demo.gripper_closed = np.arange(40) < 38
    released = replace(pulled, body=None, body_before=None, after=None, obj="door", before=pulled.body_before, grasped=5)
    (episode,) = stepwise([released])
    assert (episode.after.obj, episode.after.held) == ("door", False)
    falling = Pose(np.stack([np.zeros(40), np.zeros(40), -0.01 * np.arange(40)], axis=1), pulled.demo.pose("door").q)
    pulled.demo.pose = {"door": falling}.__getitem__
    assert stepwise([released]) == (released,)
