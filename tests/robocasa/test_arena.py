"""What is known of the world without RoboCasa, and what is said when it is not there."""

import pytest

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.robocasa.arena import ARENA
from symskill_pddl.robocasa.assets import robocasa_folder
from symskill_pddl.robocasa.tasks import BARS, LAYOUTS, STYLES, TASKS


def test_demonstrations_and_episodes_are_in_different_kitchens() -> None:
    assert not set(LAYOUTS["target"]) & set(LAYOUTS["train"])
    assert set(BARS) < set(STYLES)


def test_every_task_is_of_a_kind_and_about_something() -> None:
    assert set(ARENA.tasks) == set(TASKS)
    for spec in TASKS.values():
        assert spec.focus
        assert all(task in TASKS for task, _ in spec.goals)


def test_nothing_goes_wrong_on_purpose() -> None:
    with pytest.raises(InputError, match="nothing goes wrong"):
        ARENA.open("OpenDrawer", 0, ["drop@t=1"])


def test_a_missing_robocasa_is_one_line_that_says_what_to_do() -> None:
    try:
        robocasa_folder()
    except MissingDependencyError:
        with pytest.raises(MissingDependencyError, match="make robocasa"):
            ARENA.open("OpenDrawer", 0)
    else:
        pytest.skip("RoboCasa is installed here")
