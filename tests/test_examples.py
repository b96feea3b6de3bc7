"""The example of docs/worlds.md: short, and it does what it says."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from symskill_pddl.demos import load_demos
from symskill_pddl.execution.replay import replay
from symskill_pddl.execution.trace import read_trace
from symskill_pddl.library import Library
from symskill_pddl.pddl import read_domain, read_plan, read_problem

ROOT = Path(__file__).parent.parent
EXAMPLE = ROOT / "examples" / "my_world.py"


@pytest.fixture(scope="module")
def example():
    spec = importlib.util.spec_from_file_location("my_world", EXAMPLE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_it_is_short():
    assert len(EXAMPLE.read_text().splitlines()) < 100
    assert "examples/my_world.py" in (ROOT / "docs" / "worlds.md").read_text()


def test_as_a_program(tmp_path):
    done = subprocess.run([sys.executable, EXAMPLE, tmp_path], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "the goal holds"
    assert len(load_demos(tmp_path / "demos.hdf5")) == 5
    assert Library.load(tmp_path / "library").operators
    domain = read_domain((tmp_path / "domain.pddl").read_text())
    problem = read_problem((tmp_path / "problem.pddl").read_text(), domain)
    plan = read_plan((tmp_path / "plan.txt").read_text(), domain, problem.object_types)
    # what the planner said from the file's point of view is what the robot did
    assert plan.steps == read_trace(tmp_path / "trace.jsonl").of("plan")[0].steps


def test_the_box_is_where_the_goal_says(example, tmp_path):
    world = example.Table(np.random.default_rng(5), on="right")
    outcome = example.main(tmp_path, world)
    assert outcome.success
    assert outcome.replans == 0
    assert world.grasp is None
    off = world.at["box"].p - world.at["left"].p
    assert np.all(np.abs(off[:2]) < 0.08)
    assert off[2] == pytest.approx(0.025)


def test_somebody_takes_the_box_back(example, tmp_path):
    class Rough(example.Table):
        taken = False

        def step(self, command):
            scene = super().step(command)
            if self.grasp is not None and not self.taken and self.hand.p[2] > 0.1:
                self.taken, self.grasp = True, None
                self.at["box"] = example.Pose(self.at["right"].p + np.array([0.02, 0.0, 0.025]), example.UPRIGHT)
                scene = self.observe()
            return scene

    world = Rough(np.random.default_rng(5), on="right")
    outcome = example.main(tmp_path, world)
    assert world.taken
    assert outcome.success
    assert outcome.replans >= 1
    trace = read_trace(tmp_path / "trace.jsonl")
    assert trace.outcome.success
    assert all(decision.same for decision in replay(trace))
