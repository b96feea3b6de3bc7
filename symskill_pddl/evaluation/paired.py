"""Two evaluations of the same episodes: how much a difference between them says."""

from __future__ import annotations

from collections.abc import Sequence

from pydantic import BaseModel, ConfigDict

from symskill_pddl.errors import InputError
from symskill_pddl.evaluation.results import CONFIDENCE, EpisodeResult, Results
from symskill_pddl.evaluation.statistics import mcnemar, paired_difference

ALL = "all"
"""Name of the row over all tasks."""


class Difference(BaseModel):
    """A task, or all of them, in two evaluations: how many episodes succeeded in both, in one only, in neither."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    task: str
    both: int
    only_first: int
    only_second: int
    neither: int
    difference: float
    """Success rate of the first minus that of the second."""
    interval: tuple[float, float]
    """Newcombe's for paired rates, at the results' confidence."""
    p_value: float
    """Of McNemar's exact test."""

    @property
    def trials(self) -> int:
        return self.both + self.only_first + self.only_second + self.neither


def compare(first: Results, second: Results) -> tuple[Difference, ...]:
    """A row per task, and one over all where there are several.

    Raises
    ------
    InputError
        The two are not of the same library, tasks and seeds.
    """
    a, b = first.settings, second.settings
    if a.library != b.library or [t.task for t in first.tasks] != [t.task for t in second.tasks]:
        raise InputError("only evaluations of the same library and tasks can be compared")
    pairs = {t.task: _pairs(t.task, t.episodes, u.episodes) for t, u in zip(first.tasks, second.tasks, strict=True)}
    rows = [_row(task, found) for task, found in pairs.items()]
    return (*rows, _row(ALL, [p for found in pairs.values() for p in found])) if len(rows) > 1 else tuple(rows)


def _pairs(task: str, first: Sequence[EpisodeResult], second: Sequence[EpisodeResult]) -> list[tuple[bool, bool]]:
    if [e.seed for e in first] != [e.seed for e in second]:
        raise InputError(f"task '{task}': only evaluations of the same seeds can be compared")
    return [(x.success, y.success) for x, y in zip(first, second, strict=True)]


def _row(task: str, pairs: Sequence[tuple[bool, bool]]) -> Difference:
    both, only_first, only_second, neither = (
        pairs.count(kind) for kind in ((True, True), (True, False), (False, True), (False, False))
    )
    low, high = paired_difference(both, only_first, only_second, neither, confidence=CONFIDENCE)
    return Difference(
        task=task,
        both=both,
        only_first=only_first,
        only_second=only_second,
        neither=neither,
        difference=round((only_first - only_second) / len(pairs), 4),
        interval=(round(low, 4), round(high, 4)),
        p_value=round(mcnemar(only_first, only_second), 6),
    )
