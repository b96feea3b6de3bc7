"""Results of an evaluation as rows of a table."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from symskill_pddl.errors import InputError


@dataclass(frozen=True)
class ResultRow:
    """One task (or one task under one condition).

    Attributes
    ----------
    task : str
        Name, with the condition where there are several.
    trials, successes : int
        Counts.
    interval : (float, float)
        Confidence interval of the success rate, in [0, 1].
    failures : mapping of str to int
        Failed trials per category.
    times : mapping of str to str
        Further columns, ready to print: duration, replanning time.

    Raises
    ------
    InputError
        If there are more successes than trials, or the interval is none.
    """

    task: str
    trials: int
    successes: int
    interval: tuple[float, float]
    failures: Mapping[str, int] = field(default_factory=dict)
    times: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not 0 <= self.successes <= self.trials:
            raise InputError(f"results of '{self.task}': {self.successes} successes of {self.trials} trials cannot be")
        low, high = self.interval
        if not 0 <= low <= high <= 1:
            raise InputError(f"results of '{self.task}': the interval of a rate lies in [0, 1], got {low:g} to {high:g}")

    @property
    def rate(self) -> float:
        return self.successes / self.trials if self.trials else 0.0

    @property
    def failures_text(self) -> str:
        """Categories, the most frequent first."""
        ordered = sorted(self.failures.items(), key=lambda item: (-item[1], item[0]))
        return ", ".join(f"{category} {count}" for category, count in ordered if count)


def total(rows: Sequence[ResultRow]) -> tuple[int, int]:
    """Successes and trials over all rows."""
    return sum(r.successes for r in rows), sum(r.trials for r in rows)
