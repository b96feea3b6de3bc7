import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.evaluation.ablations import ABLATIONS, switched_off, without
from symskill_pddl.evaluation.paired import compare
from symskill_pddl.evaluation.results import EpisodeResult, Results, Settings, summarise
from symskill_pddl.evaluation.suite import Suite

SETTINGS = Settings(library="abc", planner="builtin", monitor=True, disturbances=(), seed=0, trials=4)


def results(seed: int = 0, library: str = "abc", **good: str) -> Results:
    """Episodes per task, a letter each: y for a success."""

    def episode(i: int, letter: str) -> EpisodeResult:
        success = letter == "y"
        return EpisodeResult(seed=seed + i, success=success, category="", reason="", replans=0, recoveries=0, steps=1, time_s=1.0)

    tasks = tuple(summarise(task, [episode(i, letter) for i, letter in enumerate(letters)]) for task, letters in good.items())
    return Results(settings=SETTINGS.model_copy(update={"library": library}), tasks=tasks)


def test_pairs_are_counted_per_task_and_over_all() -> None:
    rows = compare(results(Put="yyynnyyyyy", Open="yyy"), results(Put="ynnynnnnnn", Open="yyy"))
    put, open_, every = rows
    assert (put.both, put.only_first, put.only_second, put.neither) == (1, 7, 1, 1)
    assert put.difference == 0.6
    assert put.interval[0] < 0.6 < put.interval[1]
    assert put.p_value == 0.070312
    assert (open_.both, open_.trials, open_.difference, open_.p_value) == (3, 3, 0.0, 1.0)
    assert (every.task, every.both, every.trials, every.only_first) == ("all", 4, 13, 7)
    assert len(compare(results(Put="y"), results(Put="n"))) == 1


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (results(Open="yy"), "same library and tasks"),
        (results(library="xyz", Put="yy"), "same library and tasks"),
        (results(seed=7, Put="yy"), "same seeds"),
        (results(Put="yyy"), "same seeds"),
    ],
)
def test_only_the_same_episodes_are_compared(other: Results, message: str) -> None:
    with pytest.raises(InputError, match=message):
        compare(results(Put="yy"), other)


def test_every_mechanism_can_be_switched_off_once() -> None:
    suite = Suite(("StoreCheese",), 1, 0)
    assert switched_off(suite.settings("")) == ()
    for mechanism in ABLATIONS:
        less = without(suite, mechanism)
        assert switched_off(less.settings("")) == (mechanism,)
        assert less.episodes == suite.episodes
        with pytest.raises(InputError, match=f"without {mechanism} needs an evaluation with it"):
            without(less, mechanism)
    with pytest.raises(InputError, match="unknown mechanism 'luck'"):
        without(suite, "luck")
