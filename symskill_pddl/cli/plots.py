"""The pictures of a library's skills, drawn over the demonstrations that lie in it."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path

import numpy as np

from symskill_pddl.cli.console import progress
from symskill_pddl.cli.options import output
from symskill_pddl.demos import Demo, decode_demos
from symskill_pddl.files import PICTURE, make_folder
from symskill_pddl.library import LearnedOperator, Library
from symskill_pddl.report import skill_pictures
from symskill_pddl.skills import Phase, Trajectory


def draw_skills(library: Library, folder: Path, *, force: bool = False) -> tuple[Path, ...]:
    """Write `SKILL-PHASE.png` for every phase of every skill into the folder, and say which files these are."""
    demos = {d.where: d for source, content in sorted(library.recordings.items()) for d in decode_demos(content, source)}
    starts = [(e.demo, e.start_s) for learned in library.operators for e in learned.evidence]
    make_folder(folder)
    written = {
        (name, i): output(folder / f"{name}-{i}.png", PICTURE, force=force)
        for name, skill in library.skills.items()
        for i in range(1, len(skill.phases) + 1)
    }
    with progress(f"drawing {len(library.skills)} skills", total=len(library.skills)) as advance:
        for name, skill in library.skills.items():
            users = [learned for learned in library.operators if learned.skill == name]
            shown = [_shown(phase, users, demos, starts) for phase in skill.phases]
            for i, picture in enumerate(skill_pictures(name, skill, shown), 1):
                written[name, i].write(picture)
            advance()
    return tuple(file.path for file in written.values())


def _shown(
    phase: Phase, operators: Sequence[LearnedOperator], demos: dict[str, Demo], starts: Sequence[tuple[str, float]]
) -> list[Trajectory]:
    """What the hand did in the phase's frame from an operator's start to the next one's, with the phase's finger command."""
    found = []
    for evidence in (e for learned in operators for e in learned.evidence):
        demo, binding = demos.get(evidence.demo), dict(evidence.binding)
        if demo is None or binding.get(phase.frame) not in demo.objects:
            continue
        stop = min((s for where, s in starts if where == evidence.demo and s > evidence.start_s), default=float(demo.times[-1]))
        during = (demo.times >= evidence.start_s) & (demo.times <= stop)
        index = np.flatnonzero(during & (demo.gripper_closed == phase.close_gripper))
        if len(index) < 2:
            continue
        # the longest stretch: the fingers may be told so before, too
        cuts = [0, *(np.flatnonzero(np.diff(index) > 1) + 1).tolist(), len(index)]
        first, stop = max(pairwise(cuts), key=lambda cut: cut[1] - cut[0])
        rows = index[first:stop]
        if len(rows) >= 2:
            T = demo.pose(binding[phase.frame])[rows].inverse() @ demo.T_world_ee[rows]
            found.append(Trajectory(demo.times[rows], T))
    return found
