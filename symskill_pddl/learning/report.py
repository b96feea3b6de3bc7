"""What learning could not use, and the summary that a person reads in ten seconds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from symskill_pddl.learning.segments import Episode

DOUBTFUL_LEAD = 0.15
"""A reference whose score leads the next candidate's by less is called doubtful: a tenth of the scores' range of about 1.5."""

UNSHOWN = "no operator shows it"
SHOW_AGAIN = "a second demonstration of it makes it count"


@dataclass(frozen=True, order=True)
class LeftOut:
    """A part of a recording that was not used.

    Attributes
    ----------
    where : str
        The recording, `Demo.where`.
    start_s, stop_s : float
        Times in it [s].
    what : str
        The object that moved, or the operator that would have been learned.
    reason, remedy : str
        Why it was left out, and what would change that; an empty remedy says that nothing needs to be done.
    """

    where: str
    start_s: float
    stop_s: float
    what: str
    reason: str
    remedy: str = ""

    @classmethod
    def of(cls, e: Episode, reason: str, remedy: str = "") -> LeftOut:
        """An episode."""
        t = e.demo.times
        return cls(e.demo.where, float(t[e.start]), float(t[e.stop - 1]), e.obj, reason, remedy)

    def __str__(self) -> str:
        end = f": {self.remedy}" if self.remedy else ""
        return f"{self.where} {self.start_s:.2f}-{self.stop_s:.2f} s, {self.what}: {self.reason}; left out{end}"


def summary(
    episodes: Sequence[Episode],
    used: Sequence[Episode],
    left_out: Sequence[LeftOut],
    operators: int,
    margins: Mapping[str, float],
) -> str:
    """One paragraph: episodes used and left out, operators, and which references are doubtful.

    `margins` are the leads of the references by predicate.
    """
    known = {_moment(e) for e in used}
    missing = [e for e in episodes if _moment(e) not in known]
    reasons = {(x.where, x.start_s): x.reason for x in left_out}
    parts = [f"{len(episodes) - len(missing)} of {len(episodes)} episodes used"]
    if missing:
        told = [f"{e.demo.where} at {_moment(e)[1]:.1f} s ({reasons.get(_moment(e), UNSHOWN)})" for e in missing]
        parts.append(f"{len(missing)} left out: {_listed(told)}")
    parts.append(f"{operators} operator{'s' if operators != 1 else ''}")
    doubtful = sorted((margin, name) for name, margin in margins.items() if margin < DOUBTFUL_LEAD)
    if doubtful:
        parts.append("doubtful: " + _listed([f"reference of {name}, lead {margin:.2f}" for margin, name in doubtful]))
    return "; ".join(parts)


def _moment(e: Episode) -> tuple[str, float]:
    return e.demo.where, float(e.demo.times[e.start])


def _listed(told: Sequence[str], shown: int = 3) -> str:
    return ", ".join(told[:shown]) + (f", and {len(told) - shown} more" if len(told) > shown else "")
