"""The commands in benchmarks/ about the kitchen: small runs of them, in processes of their own."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from symskill_pddl.kitchen import make

pytestmark = pytest.mark.simulation
FOLDER = Path(__file__).parents[2] / "benchmarks"


def run(name, *arguments):
    return subprocess.run([sys.executable, FOLDER / name, *map(str, arguments)], capture_output=True, text=True, check=False)


def test_random_motion_does_no_harm_and_is_the_same_in_another_process(tmp_path):
    page = tmp_path / "page.md"
    page.write_text("# Title\n\n<!-- stability -->\nold\n<!-- end of stability -->\nkept\n")
    done = run("stability.py", "--tasks", "PnPCounterToStove,Play", "--seeds", 2, "--seconds", 2, "--again", 1, "-o", page)
    assert done.returncode == 0, done.stdout + done.stderr
    text = page.read_text()
    assert text.startswith("# Title\n\n<!-- stability -->\n## Stability")
    assert text.endswith("kept\n")
    assert text.count("| 1 of 1 |") == 2
    assert "old" not in text


def test_speed_is_told_as_ratios(tmp_path):
    page = tmp_path / "page.md"
    done = run("speed.py", "--tasks", "OpenDrawer", "--rounds", 1, "-o", page)
    assert done.returncode == 0, done.stdout + done.stderr
    text = page.read_text()
    assert "| kitchen's loop to bare steps | 0." in text
    assert "torque law" in text


def test_what_got_through_a_surface_is_found(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    from stability import Solids

    solids = Solids(make("OpenDrawer", 0).physics)
    points = np.array(
        [[0.5, 0.0, 0.1], [0.5, 0.0, -0.02], [0.5, 0.0, -0.5], [0.93, 0.0, 0.5], [5.0, 0.0, 0.0], [-1.0, 0.0, -0.9]]
    )
    found = [(1, "inside counter_top"), (2, "inside base_cabinet"), (3, "inside wall"), (4, "out of the room")]
    assert list(solids.around(points)) == found
