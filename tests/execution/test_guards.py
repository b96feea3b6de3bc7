import os
import re
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from fake_world import OBJECTS, FakeWorld, atoms, make_library

from symskill_pddl.execution.executor import execute
from symskill_pddl.execution.guards import GuardedWorld, WorldFailedError
from symskill_pddl.execution.outcome import Category, Cause
from symskill_pddl.execution.trace import TraceWriter, read_trace
from symskill_pddl.geometry import Pose
from symskill_pddl.planning import Builtin
from symskill_pddl.scene import Command, Scene

LIBRARY = make_library()
IN_CABINET = atoms("food-in-cabinet cheese cabinet")
UP = Command.of([0.0, 0.0, 0.1], [0.0, 0.0, 0.0], False)


def without(scene: Scene, name: str) -> Scene:
    rows = [i for i, obj in enumerate(scene.objects) if obj != name]
    objects = {obj: type_ for obj, type_ in scene.objects.items() if obj != name}
    return replace(scene, objects=objects, T_world_objects=scene.T_world_objects[rows])


def more(scene: Scene) -> Scene:
    poses = Pose.stack([*(scene.T_world_objects[i] for i in range(len(scene.objects))), Pose.identity()])
    return replace(scene, objects={**scene.objects, "vase": "vase"}, T_world_objects=poses)


def no_pose(scene: Scene) -> Scene:
    p = np.array(scene.T_world_objects.p)
    p[0] = np.nan
    return replace(scene, T_world_objects=Pose(p, scene.T_world_objects.q))


def raises(scene: Scene) -> Scene:
    raise ZeroDivisionError("division by\x1b[2J zero")


class Misbehaving(FakeWorld):
    """From its `at`-th step on it shows what `change` makes of the scene."""

    def __init__(self, change, at=20) -> None:
        super().__init__()
        self.change, self.at, self.commands = change, at, []

    def step(self, command: Command) -> Scene:
        self.commands.append(command)
        scene = super().step(command)
        return self.change(scene) if len(self.commands) >= self.at else scene


WAYS = {
    "time is no number": (lambda s: replace(s, time=float("nan")), "the world's time after .* s is nan"),
    "time goes back": (lambda s: replace(s, time=s.time - 1.0), "went back from .* s to"),
    "an object vanishes": (lambda s: without(s, "cheese"), "'cheese' has vanished; .* says in `unseen` which"),
    "an object comes": (more, "'vase' has come"),
    "another order": (lambda s: replace(s, objects=dict(reversed(s.objects.items()))), "types or order have changed"),
    "an object without a pose": (no_pose, "a pose holds a number that is not finite"),
    "a hand without a pose": (
        lambda s: replace(s, T_world_ee=Pose([np.nan, 0, 0], [1.0, 0, 0, 0])),
        "a pose holds a number that is not finite",
    ),
    "fingers without an aperture": (lambda s: replace(s, aperture=float("nan")), "the aperture is nan"),
    "it raises": (raises, r"the world raised ZeroDivisionError: division by\\x1b\[2J zero"),
    "its clock stands": (lambda s: replace(s, time=0.95), r"clock stands at 0\.95 s, for 20 steps"),
}


@pytest.mark.parametrize(("change", "message"), WAYS.values(), ids=WAYS.keys())
@pytest.mark.parametrize("monitor", [True, False])
def test_a_world_that_misbehaves_ends_the_run_with_the_robot_held(change, message, monitor, tmp_path: Path):
    world = Misbehaving(change)
    with TraceWriter(tmp_path / "trace.jsonl") as trace:
        outcome = execute(
            world,
            LIBRARY,
            LIBRARY.domain(),
            IN_CABINET,
            Builtin(),
            objects=OBJECTS,
            rng=np.random.default_rng(0),
            trace=trace,
            monitor=monitor,
        )
    assert (outcome.success, outcome.category, outcome.cause) == (False, Category.WORLD, Cause.EXTERNAL)
    assert re.search(message, outcome.reason)
    # held within two periods of the first scene that showed it, or as soon as the clock has stood for that long
    assert not any(command.twist.any() for command in world.commands[world.at + 2 :])
    assert not world.commands[-1].twist.any()
    told = read_trace(tmp_path / "trace.jsonl").outcome
    assert told is not None
    assert (told.category, told.reason) == ("world failed", outcome.reason)


def test_a_camera_that_is_slower_than_the_control_is_no_failure():
    class Slow(FakeWorld):
        shown = None

        def step(self, command: Command) -> Scene:
            scene = super().step(command)
            if self.shown is None or round(self.time / self.period_s) % 2 == 0:
                self.shown = scene
            return self.shown

    world = GuardedWorld(Slow())
    for _ in range(50):
        world.step(UP)
    assert world.last.time > 2.0


def test_a_robot_is_held_while_its_clock_stands_and_goes_on_when_it_goes_on():
    inner = FakeWorld()
    world, told = GuardedWorld(inner), []
    step, stands = inner.step, [False]

    def watched(command: Command) -> Scene:
        told.append(command.twist.any())
        before = inner.time
        scene = step(command)
        if stands[0]:
            inner.time = before
            scene = replace(scene, time=before)
        return scene

    inner.step = watched  # type: ignore[method-assign]
    world.step(UP)
    stands[0] = True
    for _ in range(5):
        world.step(UP)
    stands[0] = False
    world.step(UP)
    world.step(UP)
    assert told == [True, True, True, False, False, False, False, True]


def test_a_world_that_cannot_be_acted_on_is_refused_at_once():
    world = FakeWorld()
    world.time = float("nan")
    with pytest.raises(WorldFailedError, match="time at its start is nan"):
        GuardedWorld(world)


def test_stopping_is_done_once_and_bears_a_world_that_is_gone():
    world = Misbehaving(raises, at=2)
    guarded = GuardedWorld(world)
    guarded.step(UP)
    guarded.stop()
    guarded.stop()
    assert len(world.commands) == 2


SCRIPT = """
import os, signal, sys
import numpy as np
from fake_world import OBJECTS, FakeWorld, atoms, make_library
from symskill_pddl.execution.executor import execute
from symskill_pddl.planning import Builtin

class Watched(FakeWorld):
    last = None
    def step(self, command):
        self.last = command
        if self.time > 1.0 and command.twist.any():
            os.kill(os.getpid(), {number})
        return super().step(command)

world, library = Watched(), make_library()
try:
    goal, rng = atoms("food-in-cabinet cheese cabinet"), np.random.default_rng(0)
    execute(world, library, library.domain(), goal, Builtin(), objects=OBJECTS, rng=rng)
finally:
    print("last twist", float(abs(world.last.twist).max()), flush=True)
"""


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGINT"])
def test_a_signal_stops_the_robot_before_the_process_ends(name: str):
    number = getattr(signal, name)
    here = Path(__file__).parents[1]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(here), str(here.parent)])}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT.format(number=int(number))], capture_output=True, text=True, env=env, check=False
    )
    assert "last twist 0.0" in done.stdout
    assert done.returncode in (128 + number, -number)
