"""symskill learn --traces: costs from recorded runs, into a library."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from symskill_pddl.execution.lines import GroundStep, Header, StepLine, TickLine, VerdictLine
from symskill_pddl.execution.trace import TraceWriter
from symskill_pddl.library import Experience, Library


def trace(path: Path, *steps: tuple[str, str], monitor: bool = True) -> Path:
    """A run of steps, each with the verdict that ended it after 3 s."""
    step = {"args": (), "pre": (), "add": (), "delete": (), "maintain": (), "absent": (), "cost": 1.0}
    numbers = {"phases": 1, "exit_s": 1.0, "budget_s": 9.0, "grace_s": 1.0, "stall_s": 1.0, "blocked_s": 2.0}
    empty = {"later": (), "gripper": (), "state": (), "inherited": (), "assumed": ()}
    with TraceWriter(path) as writer:
        writer.write(Header(monitor=monitor))
        for index, (name, verdict) in enumerate(steps):
            start = VerdictLine(kind="Continue", reason="")
            writer.write(
                StepLine(
                    time=10.0 * index,
                    index=index,
                    step=GroundStep(name=name, **step),
                    still_speed=0.005,
                    still_turn=0.03,
                    attempt=0,
                    verdict=start,
                    **numbers,
                    **empty,
                )
            )
            tick = {"stage": 0, "stage_s": 0.0, "settling": False, "closing": False, "speed": 0.0, "turn": 0.0, "rest_s": 0.0}
            end = VerdictLine(kind=verdict, reason="")
            writer.write(TickLine(time=10.0 * index + 3.0, added=(), removed=(), verdict=end, **tick))
    return path


def test_runs_make_costs(symskill: Callable[..., Any], library: Path, tmp_path: Path) -> None:
    operator = Library.load(library).operators[0].operator.name
    runs = tmp_path / "runs"
    runs.mkdir()
    first = trace(runs / "1.jsonl", (operator, "EffectsHold"), (operator, "Stalled"), ("warp", "EffectsHold"))
    second = trace(runs / "2.jsonl", (operator, "EffectsHold"))
    # as a shell expands `--traces runs/*.jsonl --into library`
    done = symskill("learn", "--traces", first, second, "--into", library)
    assert done.status == 0, done.err
    assert f"{operator}: 2 of 3 tries worked, cost 5 s" in done.err
    assert "the runs have steps 'warp', which is no operator of the library: left out" in done.err
    learned = Library.load(library)
    assert learned.learned(operator).experience == Experience(3, 2, 6.0)
    assert learned.learned(operator).operator.cost == 5.0  # 3 s, and the next one works with 3/5
    assert symskill("export", library, "-o", tmp_path / "pddl", "--dialect", "costs").status == 0
    text = (tmp_path / "pddl" / "domain.pddl").read_text()
    assert "; carried out 3 times, 2 with success, took 3.0 s on average; the next one works with 0.60" in text
    assert "(increase (total-cost) 500)" in text
    before = (library / "library.json").read_bytes()
    again = symskill("learn", "--traces", first, "--into", library)
    assert (again.status, (library / "library.json").read_bytes()) == (2, before)
    assert "is counted in the library already: every run counts once" in again.error


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (("--into", "LIBRARY"), "nothing to learn from"),
        (("--traces", "RUN", "-o", "LIBRARY"), "nothing to learn from"),
        (("--traces", "BLIND", "--into", "LIBRARY"), "a run without monitor, which says nothing of single steps"),
        (("--traces", "NONE", "--into", "LIBRARY"), "there is no trace"),
        (("--traces", "RUN", "RUN", "--into", "LIBRARY"), "the same run as another one"),
    ],
)
def test_what_cannot_be_learned_from(
    symskill: Callable[..., Any], library: Path, tmp_path: Path, call: tuple[str, ...], message: str
) -> None:
    files = {
        "LIBRARY": library,
        "RUN": trace(tmp_path / "run.jsonl", ("pick", "EffectsHold")),
        "BLIND": trace(tmp_path / "blind.jsonl", ("pick", "EffectsHold"), monitor=False),
        "NONE": tmp_path / "none.jsonl",
    }
    before = (library / "library.json").read_bytes()
    done = symskill("learn", *(files.get(word, word) for word in call))
    assert done.status == 2
    assert message in done.error
    assert (library / "library.json").read_bytes() == before
