"""`learn()`: demonstrations in, library out; the order of the stages and nothing else."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from symskill_pddl import workers
from symskill_pddl.demos import Demo, decode_demos, encode_demos, without_freezes
from symskill_pddl.errors import LearningError
from symskill_pddl.learning.config import LearnConfig
from symskill_pddl.learning.hints import hinted
from symskill_pddl.learning.operators import OperatorGroup
from symskill_pddl.learning.report import LeftOut, summary
from symskill_pddl.learning.segments import Episode
from symskill_pddl.learning.skills import SkillConfig, learn_skill
from symskill_pddl.learning.symbolic import Selector, Symbolic, learn_symbols
from symskill_pddl.library import LearnedOperator, Library
from symskill_pddl.skills import Skill
from symskill_pddl.symbols import Type

Fit = tuple[Skill, tuple[str, ...]]
"""A skill, and notes on demonstrations that were left out of it."""


@dataclass(frozen=True, eq=False)
class LearnReport:
    """What happened on the way, and the seconds of each stage."""

    symbols: Symbolic
    seconds: tuple[tuple[str, float], ...]
    groups: tuple[OperatorGroup, ...]
    """Those of `symbols` that have a skill."""
    margins: Mapping[str, float]
    """By predicate, the lead of its reference over the next candidate."""
    remarks: tuple[str, ...]
    left_out: tuple[LeftOut, ...]

    @property
    def episodes(self) -> tuple[Episode, ...]:
        return self.symbols.episodes

    @property
    def notes(self) -> tuple[str, ...]:
        """A line for everything that is suspicious, and for everything that was left out, with its reason."""
        return (*self.remarks, *map(str, self.left_out))

    @property
    def summary(self) -> str:
        """What was used, what was left out, and what is doubtful, in one line."""
        used = [t.label.episode for g in self.groups for t in g.transitions]
        return summary(self.episodes, used, self.left_out, len(self.groups), self.margins)


def learn(
    demos: Sequence[Demo], config: LearnConfig | None = None, *, jobs: int = 1, progress: Callable[[str], None] | None = None
) -> Library:
    """Learn predicates, operators, skills and goals from demonstrations.

    Parameters
    ----------
    demos : sequence of Demo
        In any order: the same set gives the same library, byte by byte.
    config : LearnConfig, optional
    jobs : int
        Processes that fit skills side by side, where the system can fork; the result does not depend on it.
    progress : callable, optional
        Called with the name of each stage as it begins.

    Raises
    ------
    LearningError
        If there are no demonstrations, nothing moves, demonstrations of a task contradict each other, or no operator comes out.
    """
    return learn_reported(demos, config, jobs=jobs, progress=progress)[0]


def added(library: Library, new: Sequence[Demo]) -> tuple[Demo, ...]:
    """The demonstrations that a library was learned from, and new ones: what to learn from for a library of both.

    Raises
    ------
    LearningError
        If the library does not hold its demonstrations, or a new one is among them, by its name or by its content.
    """
    old = [demo for source, content in library.recordings.items() for demo in decode_demos(content, source)]
    if not old:
        raise LearningError("the library does not hold the demonstrations it was learned from; learn it again from their files")
    seen = {_digest(demo): demo.where for demo in old}
    names = set(seen.values())
    for demo in new:
        digest = _digest(demo)
        if digest in seen:
            known = f"'{demo.where}'" if seen[digest] == demo.where else f"'{demo.where}', there called '{seen[digest]}'"
            raise LearningError(f"there is the demonstration {known}, already: every demonstration counts once")
        if demo.where in names:
            raise LearningError(f"the library has another demonstration called '{demo.where}': give the new file another name")
        seen[digest] = demo.where
    return (*old, *new)


def learn_reported(
    demos: Sequence[Demo],
    config: LearnConfig | None = None,
    *,
    jobs: int = 1,
    progress: Callable[[str], None] | None = None,
    selector: Selector | None = None,
) -> tuple[Library, LearnReport]:
    """`learn`, with the report of what was left out; `selector` chooses references in place of the default."""
    config = config or LearnConfig()
    clock = _Clock(progress)
    demos, same = _distinct(_sorted(demos))
    # a tracker that stood still saw nothing
    read = tuple(without_freezes(demo) for demo in hinted(demos, config.hints))
    found = learn_symbols(read, config, selector=selector, progress=clock.stage)
    clock.stage("skills")
    groups, learned, skills, failed = _skills(found.groups, config.skills, jobs)
    clock.stage("")
    types = tuple(Type(name) for name in sorted({t for demo in read for t in demo.objects.values()}))
    margins = {name: p.margin for name, p in zip(found.places, found.relations.places, strict=True) if np.isfinite(p.margin)}
    sources = sorted({demo.source for demo in demos})
    recordings = {source: encode_demos([d for d in demos if d.source == source], source) for source in sources}
    library = Library(
        types,
        found.classifiers,
        learned,
        skills,
        found.goals,
        found.gripper,
        found.extents,
        margins,
        recordings,
        hints=config.hints.document(),
    )
    remarks = (*same, *found.remarks)
    return library, LearnReport(found, tuple(clock.spent), groups, margins, remarks, (*found.left_out, *failed))


def _skills(
    groups: Sequence[OperatorGroup], config: SkillConfig, jobs: int
) -> tuple[tuple[OperatorGroup, ...], tuple[LearnedOperator, ...], dict[str, Skill], tuple[LeftOut, ...]]:
    """The operators whose skill can be fitted, as groups and as learned, their skills, and what the others were seen in."""
    kept, learned, skills = [], [], {}
    failed: list[LeftOut] = []
    for group, fit in zip(groups, _fitted(groups, config, jobs), strict=True):
        old = group.learned
        if isinstance(fit, LearningError):
            remedy = "show it with a longer or clearer motion of the hand"
            failed += [LeftOut(e.demo, e.start_s, e.stop_s, old.operator.name, str(fit), remedy) for e in old.evidence]
            continue
        skills[old.skill], notes = fit
        kept.append(group)
        learned.append(replace(old, notes=(*old.notes, *notes)))
    if not learned:
        raise LearningError(f"no skill can be learned; first reason: {failed[0].reason}")
    return tuple(kept), tuple(learned), skills, tuple(failed)


def _fitted(groups: Sequence[OperatorGroup], config: SkillConfig, jobs: int) -> Iterator[Fit | LearningError]:
    if jobs <= 1 or len(groups) == 1 or not workers.can_fork():
        for group in groups:
            yield _fit(group, config)
        return
    with workers.pool(min(jobs, len(groups)), "fork") as pool:
        for fit in pool.map(partial(_fit_arrays, config=config), groups):
            yield fit if isinstance(fit, LearningError) else (Skill.from_arrays(fit[0]), fit[1])


def _fit(group: OperatorGroup, config: SkillConfig) -> Fit | LearningError:
    try:
        return learn_skill(group, config)
    except LearningError as error:
        return error


def _fit_arrays(group: OperatorGroup, config: SkillConfig) -> tuple[dict[str, NDArray[Any]], tuple[str, ...]] | LearningError:
    """As plain arrays, from which the parent makes read-only ones again."""
    fit = _fit(group, config)
    return fit if isinstance(fit, LearningError) else (fit[0].arrays(), fit[1])


def _sorted(demos: Sequence[Demo]) -> tuple[Demo, ...]:
    """By task, source, name and content; two demonstrations may not share source and name, which identify evidence."""
    if not demos:
        raise LearningError("there are no demonstrations to learn from")
    ordered = tuple(sorted(demos, key=lambda d: (d.task, d.source, _natural(d.name), _digest(d))))
    for where in sorted({d.where for d in ordered}):
        if sum(d.where == where for d in ordered) > 1:
            raise LearningError(f"two demonstrations are called '{where}': give their files different names")
    return ordered


def _distinct(demos: Sequence[Demo]) -> tuple[tuple[Demo, ...], tuple[str, ...]]:
    """The demonstrations without copies of earlier ones, and a line for each copy."""
    first: dict[str, Demo] = {}
    told = []
    for demo in demos:
        known = first.setdefault(_digest(demo), demo)
        if known is not demo:
            told.append(f"{demo.where} is the same recording as {known.where}: counted once")
    return tuple(first.values()), tuple(told)


def _natural(name: str) -> tuple[str, int]:
    head = name.rstrip("0123456789")
    return head, int(name[len(head) :] or 0)


def _digest(demo: Demo) -> str:
    sha = hashlib.sha256()
    for array in (
        demo.times,
        demo.T_world_ee.vector(),
        demo.aperture,
        demo.gripper_closed,
        demo.T_world_objects.vector(),
        demo.seen,
    ):
        sha.update(np.ascontiguousarray(array).tobytes())
    return sha.hexdigest()


class _Clock:
    """Seconds per stage."""

    def __init__(self, progress: Callable[[str], None] | None) -> None:
        self.progress, self.spent, self._stage, self._since = progress, list[tuple[str, float]](), "", 0.0

    def stage(self, name: str) -> None:
        now = time.perf_counter()
        if self._stage:
            self.spent.append((self._stage, now - self._since))
        self._stage, self._since = name, now
        if name and self.progress is not None:
            self.progress(name)
