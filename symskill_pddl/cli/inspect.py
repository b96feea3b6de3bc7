"""The command inspect: what is in recordings, and what learning would stumble over, before anything is learned."""

from __future__ import annotations

from dataclasses import asdict
from math import degrees
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from symskill_pddl.cli.console import emit_json, remark, say, table
from symskill_pddl.cli.options import ForceFlag, JsonFlag
from symskill_pddl.cli.options import output as checked_output
from symskill_pddl.cli.recordings import FORMATS, read_recordings
from symskill_pddl.errors import SymSkillError
from symskill_pddl.files import DRAWING

if TYPE_CHECKING:
    from symskill_pddl.demos import Demo
    from symskill_pddl.demos.gravity import Up
    from symskill_pddl.demos.inspection import Inspection
    from symskill_pddl.demos.timeline import Cut

_MOST_MOVES = 6


def inspect(
    files: Annotated[list[Path], typer.Argument(metavar="DEMOS...", help=f"Files of demonstrations. {FORMATS}")],
    json: JsonFlag = False,
    picture: Annotated[
        Path | None, typer.Option("--picture", metavar="FILE.svg", help="Draw objects, fingers and cuts over time.")
    ] = None,
    force: ForceFlag = False,
) -> None:
    """Look at recordings before learning: clock, gripper, jitter, drop-outs, what moves when, and what is suspicious."""
    from symskill_pddl.demos.gravity import up_axis
    from symskill_pddl.demos.inspection import inspect_demo
    from symskill_pddl.demos.suspicions import suspicions
    from symskill_pddl.demos.timeline import timeline_svg

    target = checked_output(picture, DRAWING, force=force, inputs=files) if picture is not None else None
    said: list[str] = []
    demos = tuple(demo for file in files for demo in _read(file, said))
    found = tuple(inspect_demo(demo) for demo in demos)
    cuts, failed = _cuts(demos)
    lines = (*said, *suspicions(demos, found), *failed)
    up = up_axis(demos)
    if json:
        emit_json(_document(found, cuts, lines, up))
    else:
        _tell(found, cuts, lines, up)
    if target is not None:
        target.write(timeline_svg(demos, found, cuts).encode())
        remark(f"{picture}: drawn")


def _read(file: Path, said: list[str]) -> tuple[Demo, ...]:
    """Demonstrations of ours, or a recording of any format that import reads, and what there is to say about that."""
    from symskill_pddl.demos import is_ours, load_demos
    from symskill_pddl.demos.importing import ImportConfig

    if file.is_dir() or (file.exists() and not is_ours(file)):
        return read_recordings(file, ImportConfig(), said.append)
    return load_demos(file)


def _cuts(demos: tuple[Demo, ...]) -> tuple[dict[str, tuple[Cut, ...]], list[str]]:
    """Where learning cuts each recording, and why it could not."""
    from symskill_pddl.demos import without_freezes
    from symskill_pddl.demos.timeline import Cut
    from symskill_pddl.learning.episodes import segment_all

    cuts: dict[str, tuple[Cut, ...]] = {}
    failed = []
    for demo in demos:
        times = demo.times - demo.times[0]
        try:
            episodes = segment_all([without_freezes(demo)])
        except SymSkillError as error:
            failed.append(f"{demo.where}: learning cannot cut it: {error}")
            continue
        cuts[demo.where] = tuple(
            Cut(float(times[e.begin]), float(times[e.end if e.end is not None else e.stop]), e.obj) for e in episodes
        )
        if not episodes:
            failed.append(f"{demo.where}: learning finds nothing that the hand does")
    return cuts, failed


def _tell(found: tuple[Inspection, ...], cuts: dict[str, tuple[Cut, ...]], lines: tuple[str, ...], up: Up | None) -> None:
    for one in found:
        clock, grip = one.clock, one.grip
        gaps = f", {len(clock.gaps)} gaps" if clock.gaps else ""
        say(f"{one.where} ({one.task}): {clock.duration_s:.1f} s, {clock.rate_hz:.3g} samples per second{gaps}")
        follows = "do not move" if grip.follows is None else f"follow the command ({grip.follows:.0%})"
        say(
            f"  gripper {100 * grip.narrowest_m:.1f} to {100 * grip.widest_m:.1f} cm, told to close {grip.closed:.0%} of "
            f"the time in {grip.switches} changes; the fingers {follows}"
        )
        rows = [
            (
                track.name,
                track.type,
                f"{track.seen:.0%}",
                f"{1000 * track.jitter_m:.2f} / {degrees(track.jitter_rad):.2f}",
                f"{len(track.unseen)} / {len(track.frozen)} / {track.jumps}",
                _listed([f"{a:.1f}-{b:.1f}" for a, b in track.moves]),
            )
            for track in one.tracks
        ]
        table("", ("object", "type", "seen", "jitter mm / deg", "lost / frozen / jumps", "moves, s"), rows)
        say("  cuts, s: " + (_listed([f"{c.label} {c.start_s:.1f}-{c.stop_s:.1f}" for c in cuts.get(one.where, ())]) or "none"))
        say()
    say("up: not told by these recordings" if up is None else f"up: {up.axis} (lead {up.lead:.2f})")
    say("suspicious:" if lines else "nothing is suspicious")
    for line in lines:
        say(f"  {line}")


def _listed(texts: list[str]) -> str:
    more = f" and {len(texts) - _MOST_MOVES} more" if len(texts) > _MOST_MOVES else ""
    return ", ".join(texts[:_MOST_MOVES]) + more


def _document(
    found: tuple[Inspection, ...], cuts: dict[str, tuple[Cut, ...]], lines: tuple[str, ...], up: Up | None
) -> dict[str, Any]:
    return {
        "recordings": [{**asdict(one), "cuts": [asdict(cut) for cut in cuts.get(one.where, ())]} for one in found],
        "up": None if up is None else asdict(up),
        "suspicious": list(lines),
    }
