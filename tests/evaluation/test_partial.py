"""An evaluation that is killed goes on where it was: nothing lost, nothing counted twice."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from symskill_pddl.errors import FormatError, InputError
from symskill_pddl.evaluation.partial import Partial, partial_path
from symskill_pddl.evaluation.results import EpisodeResult, Settings, load_results
from symskill_pddl.library import Library

TASKS = ("StoreCheese",)
SETTINGS = Settings(library="abc", planner="builtin", monitor=True, disturbances=(), seed=0, trials=4)


def episode(seed: int) -> EpisodeResult:
    return EpisodeResult(
        seed=seed, success=True, category="success", reason="", replans=0, recoveries=0, steps=3, time_s=1.0 + seed
    )


def keep(path: Path, *seeds: int) -> None:
    with Partial(path, SETTINGS, TASKS) as partial:
        for seed in seeds:
            partial.add("StoreCheese", episode(seed))


def seeds(path: Path) -> list[int]:
    with Partial(path, SETTINGS, TASKS) as partial:
        return [seed for _, seed in partial.done]


def test_episodes_are_kept_and_found_again(tmp_path: Path) -> None:
    path = partial_path(tmp_path / "results.json")
    assert path.name == "results.json.partial.jsonl"
    keep(path, 0, 2)
    keep(path, 1)
    with Partial(path, SETTINGS, TASKS) as partial:
        assert partial.done == {("StoreCheese", seed): episode(seed) for seed in (0, 1, 2)}
        partial.remove()
    assert not path.exists()


@pytest.mark.parametrize("cut", [1, 20, 1_000_000])
def test_a_cut_last_line_is_run_again(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "p.jsonl"
    keep(path, 0, 1)
    content = path.read_bytes()
    path.write_bytes(content[: max(5, len(content) - cut)])
    expected = [0] if cut < 1_000_000 else []
    assert seeds(path) == expected
    keep(path, 1, 3)
    assert seeds(path) == [*expected, 1, 3]


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"seed": 7}, "seed 0, now 7"),
        ({"trials": 9}, "trials 4, now 9"),
        ({"library": "xyz"}, "library abc, now xyz"),
        ({"world": "elsewhere"}, "world kitchen, now elsewhere"),
        ({"monitor": False}, "monitor True, now False"),
        ({"resampling": False}, "resampling True, now False"),
        ({"disturbances": ("drop@op=1",)}, "disturbances none, now drop@op=1"),
    ],
)
def test_other_settings_are_refused(tmp_path: Path, changed: dict[str, object], message: str) -> None:
    path = tmp_path / "p.jsonl"
    keep(path, 0)
    before = path.read_bytes()
    with pytest.raises(InputError, match=message):
        Partial(path, SETTINGS.model_copy(update=changed), TASKS)
    with pytest.raises(InputError, match="tasks StoreCheese, now StoreCheese OpenSingleDoor"):
        Partial(path, SETTINGS, (*TASKS, "OpenSingleDoor"))
    assert path.read_bytes() == before
    assert seeds(path) == [0]


def test_without_a_finished_episode_it_begins_anew(tmp_path: Path) -> None:
    path = tmp_path / "p.jsonl"
    keep(path)
    with Partial(path, SETTINGS.model_copy(update={"seed": 7}), TASKS) as partial:
        partial.add("StoreCheese", episode(7))
    with pytest.raises(InputError, match="seed 7, now 0"):
        Partial(path, SETTINGS, TASKS)


@pytest.mark.parametrize(
    ("number", "text"), [(1, "{}"), (1, "settings"), (2, '{"task": "StoreCheese"}'), (2, '{"task": 3, "episode": {}}')]
)
def test_a_damaged_file_is_refused_with_the_line(tmp_path: Path, number: int, text: str) -> None:
    path = tmp_path / "p.jsonl"
    keep(path, 0, 1)
    lines = path.read_text().splitlines()
    lines[number - 1] = text
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(FormatError, match=rf"p.jsonl:{number}: not a line of an evaluation"):
        Partial(path, SETTINGS, TASKS)


def test_two_evaluations_do_not_write_one_file(tmp_path: Path) -> None:
    path = tmp_path / "p.jsonl"
    with Partial(path, SETTINGS, TASKS), pytest.raises(InputError, match="another evaluation is writing"):
        Partial(path, SETTINGS, TASKS)


def test_a_folder_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cannot write"):
        Partial(tmp_path / "no" / "p.jsonl", SETTINGS, TASKS)


PROGRAM = """
import os, sys, time
from pathlib import Path
import symskill_pddl.evaluation.suite as suite
from symskill_pddl.cli import main
from symskill_pddl.evaluation.results import EpisodeResult

def run_one(library, settings, task, seed, failed=None):
    if {whole} <= len(Path({log!r}).read_text().splitlines() if Path({log!r}).exists() else ()):
        time.sleep(3600)
    with open({log!r}, "a") as log:
        log.write(f"{{os.getpid()}} {{seed}}\\n")
    good = seed % 3 > 0
    return EpisodeResult(seed=seed, success=good, category="success" if good else "time limit", reason="", replans=seed % 2,
                         recoveries=0, steps=1, time_s=float(seed))

# worker processes import this file too
suite.run_one = run_one
if __name__ == "__main__":
    main()
"""


def call(folder: Path, output: str, *options: str, whole: int = 1000) -> list[str]:
    """The command line of an evaluation of 12 made-up episodes, which logs process and seed of each; so many of them end."""
    Library((), (), (), {}).save(folder / "library")
    program = folder / f"program{whole}.py"
    program.write_text(PROGRAM.format(whole=whole, log=str(folder / "log")))
    fixed = ["evaluate", str(folder / "library"), "--tasks", "StoreCheese", "--trials", "12", "--seed", "5"]
    return [sys.executable, str(program), *fixed, "-o", str(folder / output), *options]


def lines(path: Path) -> list[str]:
    return path.read_text().splitlines() if path.exists() else []


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_killed_evaluation_goes_on_where_it_was(tmp_path: Path, jobs: int) -> None:
    partial, log = tmp_path / "results.json.partial.jsonl", tmp_path / "log"
    killed = subprocess.Popen(
        call(tmp_path, "results.json", "--jobs", str(jobs), whole=4), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    while len(lines(partial)) < 5 and killed.poll() is None:
        time.sleep(0.02)
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    kept = len(lines(partial)) - 1
    assert 4 <= kept <= 5  # two processes may both begin a fifth
    assert not (tmp_path / "results.json").exists()
    wait_until_gone({int(line.split()[0]) for line in lines(log)})

    log.unlink()
    again = call(tmp_path, "results.json", "--jobs", str(jobs))
    done = subprocess.run(again, capture_output=True, text=True, check=True)
    assert f"{kept} of them done before" in done.stderr
    # only what was missing has been run, each episode once
    assert len({line.split()[1] for line in lines(log)}) == len(lines(log)) == 12 - kept
    assert not partial.exists()

    subprocess.run(call(tmp_path, "whole.json"), capture_output=True, check=True)
    assert (tmp_path / "results.json").read_bytes() == (tmp_path / "whole.json").read_bytes()
    (task,) = load_results(tmp_path / "results.json").tasks
    assert [e.seed for e in task.episodes] == list(range(5, 17))


def test_ablations_and_suites_stand_in_the_results(tmp_path: Path) -> None:
    flags = ("--no-resampling", "--no-replanning", "--no-obstacles", "--disturb", "drop@t=3")
    done = call(tmp_path, "results.json", *flags)
    done[done.index("--tasks") : done.index("--tasks") + 2] = ["--suite", "disturbed"]
    subprocess.run(done, capture_output=True, check=True)
    results = load_results(tmp_path / "results.json")
    found = results.settings
    assert (found.monitor, found.resampling, found.replanning, found.obstacles) == (True, False, False, False)
    assert found.disturbances == ("close-door@op=4", "drop@t=3")
    assert [task.task for task in results.tasks] == ["StoreCheese"]


def test_the_same_episodes_without_a_mechanism_are_compared(tmp_path: Path) -> None:
    against = ("--against", "monitor", "--against", "tracking", "--json")
    done = subprocess.run(call(tmp_path, "results.json", *against), capture_output=True, text=True, check=True)
    found = json.loads(done.stdout)
    assert set(found["against"]) == {"monitor", "tracking"}
    # these made-up episodes end alike with and without
    (row,) = found["against"]["monitor"]
    assert (row["both"], row["neither"], row["difference"], row["p_value"]) == (8, 4, 0.0, 1.0)
    settings = {name: load_results(tmp_path / f"results.no-{name}.json").settings for name in ("monitor", "tracking")}
    assert (settings["monitor"].monitor, settings["monitor"].tracking) == (False, True)
    assert (settings["tracking"].monitor, settings["tracking"].tracking) == (True, False)
    # called again, nothing of it is run again
    (tmp_path / "log").unlink()
    subprocess.run(call(tmp_path, "results.json", *against), capture_output=True, check=True)
    assert lines(tmp_path / "log") == []


def test_other_settings_after_a_kill_are_bad_input(tmp_path: Path) -> None:
    keep(tmp_path / "results.json.partial.jsonl", 0)
    done = subprocess.run(call(tmp_path, "results.json", "--no-obstacles"), capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith("symskill: error: ")
    assert "obstacles True, now False" in done.stderr
    assert done.stderr.count("\n") == 1


def wait_until_gone(processes: set[int]) -> None:
    """Workers end when the evaluation that started them is killed."""
    deadline = time.monotonic() + 20
    while processes and time.monotonic() < deadline:
        processes = {p for p in processes if running(p)}
        time.sleep(0.05)
    assert not processes


def running(process: int) -> bool:
    try:
        os.kill(process, 0)
        # a zombie has ended; nobody may be there to collect it
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except (ProcessLookupError, FileNotFoundError):
        return False
