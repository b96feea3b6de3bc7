from dataclasses import replace

import numpy as np
import pytest

from symskill_pddl.demos.gripper import Convention, Told, agreement, with_commands
from symskill_pddl.errors import InputError

N = 60


def told(demo, *, values=(-1.0, 1.0), lag=2, noise=0.0, width=7, column=6, convention=None) -> Told:
    """The hand is told to close from sample 20 to 39, by `values` (open, closed); the fingers follow `lag` samples later."""
    rng = np.random.default_rng(0)
    close = (np.arange(N) >= 20) & (np.arange(N) < 40)
    actions = np.zeros((N, width))
    actions[:, column] = np.where(close, values[1], values[0])
    followed = np.convolve(np.roll(close, lag).astype(float), np.ones(4) / 4)[:N]
    aperture = np.clip(0.08 - 0.05 * followed + noise * rng.standard_normal(N), 0, None)
    T = demo().T_world_objects[np.zeros(N, int)]
    one = demo(
        times=np.arange(N) * 0.05,
        T_world_ee=demo().T_world_ee[np.zeros(N, int)],
        aperture=aperture,
        gripper_closed=np.zeros(N, bool),
        T_world_objects=T,
    )
    return Told(one, actions, convention or Convention(column))


def quiet(text: str) -> None:
    raise AssertionError(text)


def test_the_middle_holds_the_last_command_and_the_gripper_starts_open():
    commands = np.array([0, 0, 1, 0, -0.5, 0, 0.1])[:, None]
    assert Convention(0).closed(commands).tolist() == [False, False, True, True, False, False, True]
    assert Convention(0, 0.5, -1).closed(np.array([[1.0], [0.0], [1.0]])).tolist() == [False, True, False]


@pytest.mark.parametrize("noise", [0.0, 0.002])
def test_fingers_that_follow_agree(demo, noise):
    one = told(demo, noise=noise)
    assert agreement([one], one.convention) > 0.9
    assert agreement([one], Convention(6, 0.0, -1)) < -0.9
    (found,) = with_commands([one], "'file'", quiet)
    np.testing.assert_array_equal(found.gripper_closed, one.actions[:, 6] > 0)


@pytest.mark.parametrize("values", [(1.0, 0.0), (1.0, -1.0), (0.0, -1.0)])
def test_a_convention_that_the_fingers_show_is_taken_and_said(demo, values):
    one, said = told(demo, values=values), []
    (found,) = with_commands([one], "'file'", said.append)
    np.testing.assert_array_equal(found.gripper_closed, (np.arange(N) >= 20) & (np.arange(N) < 40))
    assert "column 6 of the 7 of the actions" in said[0]
    assert f"as if --gripper-open {values[0]:g} had been given" in said[0]
    (same,) = with_commands([one], "'file'", quiet, opens=values[0])
    np.testing.assert_array_equal(same.gripper_closed, found.gripper_closed)


def test_the_column_that_the_fingers_follow_is_taken_and_said(demo):
    one, said = told(demo, width=12, column=6, convention=Convention(11)), []
    (found,) = with_commands([one], "'file'", said.append)
    assert found.gripper_closed.sum() == 20
    assert "column 11 of the 12" in said[0]
    assert "--gripper-column 6" in said[0]
    assert with_commands([one], "'file'", quiet, column=6)[0].gripper_closed.sum() == 20


def test_who_chooses_wrongly_is_told_what_would_fit(demo):
    one = told(demo)
    with pytest.raises(
        InputError, match=r"the fingers do not follow it \(-100% of their travel\); --gripper-open -1 \(100%\) says"
    ):
        with_commands([one], "'file'", quiet, opens=1.0)
    with pytest.raises(InputError, match="an action has 7 numbers, there is no column 7"):
        with_commands([one], "'file'", quiet, column=7)
    with pytest.raises(InputError, match="column 6 of the actions goes from -1 to 1, it never opens at 3"):
        with_commands([one], "'file'", quiet, opens=3.0)


def test_nothing_that_fits_is_refused(demo):
    one = told(demo)
    wandering = np.random.default_rng(1).uniform(0.0, 0.08, N)
    with pytest.raises(InputError, match="--gripper-column N or --gripper-open VALUE says otherwise"):
        with_commands([replace(one, demo=replace(one.demo, aperture=wandering))], "'file'", quiet)


def test_fingers_that_never_move_show_nothing(demo):
    one = told(demo)
    still = replace(one, demo=replace(one.demo, aperture=np.full(N, 0.08)))
    assert agreement([still], one.convention) is None
    said = []
    assert with_commands([still], "'file'", said.append)[0].gripper_closed.sum() == 20
    assert "the fingers do not move although column 6" in said[0]
