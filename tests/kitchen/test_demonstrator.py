"""The demonstrator does every atomic task, as people do: it starts and ends at rest near its start, and errs without failing."""

from functools import cache

import numpy as np
import pytest

from symskill_pddl.demonstrator.hand import MAX_LINEAR_M_S
from symskill_pddl.demonstrator.human import Faults, Person
from symskill_pddl.demos.demo import Demo
from symskill_pddl.errors import InputError
from symskill_pddl.geometry import Pose, rotation_distance
from symskill_pddl.kitchen import layout, make, task_named
from symskill_pddl.kitchen.demo_door import AJAR_DEG
from symskill_pddl.kitchen.demo_part import seen
from symskill_pddl.kitchen.demonstrator import WAYS, demonstrate
from symskill_pddl.kitchen.record import record

pytestmark = pytest.mark.simulation

ATOMIC = [task for task in WAYS if task_named(task).kind == "atomic"]


@cache
def shown(task: str) -> Demo:
    return record(task, 1, 3)[0]


def turned(demo: Demo) -> np.ndarray:
    """Angle of the door [deg] over time."""
    door = seen(demo.scene(0), "door")
    return np.degrees([door.position(demo.pose("door")[i]) for i in range(len(demo.times))])


@pytest.mark.parametrize("task", ATOMIC)
def test_a_demonstration_is_a_20_hz_recording_from_rest_to_rest(task: str) -> None:
    demo = shown(task)
    assert demo.task == task
    assert demo.attributes["success"] == 1
    assert np.allclose(np.diff(demo.times), 0.05)
    assert demo.times[0] == 0.0
    assert 10.0 < demo.times[-1] < 60.0
    assert np.linalg.norm(demo.T_world_ee.p[-1] - demo.T_world_ee.p[0]) < 0.06
    for part in (slice(0, 5), slice(-18, None)):
        assert np.ptp(demo.T_world_ee.p[part], axis=0).max() < 0.012
    assert np.linalg.norm(np.diff(demo.T_world_ee.p, axis=0), axis=-1).max() / 0.05 < MAX_LINEAR_M_S + 0.1
    assert not demo.gripper_closed[0]
    assert not demo.gripper_closed[-1]


@pytest.mark.parametrize("task", ATOMIC)
def test_nothing_but_the_object_of_the_task_moves(task: str) -> None:
    demo = shown(task)
    focus = make(task, int(demo.attributes["seed"])).focus[0]
    for name in demo.objects:
        way = np.linalg.norm(demo.pose(name).p - demo.pose(name).p[0], axis=-1).max()
        turn = rotation_distance(demo.pose(name), demo.pose(name)[0]).max()
        assert (max(way, 0.1 * turn) > 0.1) if name == focus else (way < 0.005 and turn < 0.1), name


@pytest.mark.parametrize(("task", "last"), [("OpenSingleDoor", 75.0), ("CloseSingleDoor", -1.0)])
def test_a_door_rests_ajar_between_two_contacts(task: str, last: float) -> None:
    angle = turned(shown(task))
    ajar = (angle > AJAR_DEG[0] - 2.0) & (angle < AJAR_DEG[1] + 2.0)
    still = np.abs(np.diff(angle, prepend=angle[0])) < 0.05
    assert (ajar & still).sum() * 0.05 > 1.5
    assert last < angle[-1] < last + 40.0


def test_food_is_put_down_and_not_dropped() -> None:
    for task in ("PnPCabToCounter", "PnPCounterToCab", "PnPStoveToCounter", "PnPCounterToStove"):
        demo = shown(task)
        food = next(n for n in layout.KITCHEN.of_type("food") if np.ptp(demo.pose(n).p, axis=0).max() > 0.1)
        opens = np.flatnonzero(np.diff(demo.gripper_closed.astype(int)) < 0)[-1]
        p = demo.pose(food).p
        assert np.linalg.norm(p[opens] - p[-1]) < 0.015
        assert rotation_distance(demo.pose(food)[opens], demo.pose(food)[-1]) < 0.15


@pytest.mark.parametrize("task", ATOMIC)
def test_all_faults_at_once_do_not_break_it(task: str) -> None:
    kitchen = make(task, 5)
    faults = Faults(pause=True, second_approach=True, nudge=True, poor_grasp=True)
    demonstrate(kitchen, np.random.default_rng(0), person=Person(), faults=faults)
    assert kitchen.succeeded()


def test_same_seed_same_bytes() -> None:
    a, b = (record("PnPCabToCounter", 1, 7)[0] for _ in range(2))
    assert a.T_world_ee.vector().tobytes() == b.T_world_ee.vector().tobytes()
    assert a.T_world_objects.vector().tobytes() == b.T_world_objects.vector().tobytes()


@pytest.mark.parametrize("name", layout.KITCHEN.parts)
def test_the_parts_of_the_demonstrator_are_the_kitchens(name: str) -> None:
    kitchen = make("CloseSingleDoor", 0)
    part = layout.PARTS[name]
    kitchen.physics.set_part(name, 0.7 * part.travel)
    kitchen.physics.forward()
    scene = kitchen.observe()
    position = seen(scene, name).position(scene.pose(name))
    assert abs(position - 0.7 * part.travel) < 1e-6
    assert np.allclose(seen(scene, name).frame(position).p, scene.pose(name).p, atol=1e-6)
    assert rotation_distance(seen(scene, name).frame(position), scene.pose(name)) < 1e-6
    assert np.allclose(seen(scene, name).frame(0.0).p, scene.pose(part.unit).p + part.home)


def test_bad_requests_are_refused() -> None:
    with pytest.raises(InputError, match="at least 1"):
        record("OpenSingleDoor", 0, 0)
    with pytest.raises(InputError, match="seed"):
        record("OpenSingleDoor", 1, -1)
    with pytest.raises(InputError, match="unknown task"):
        record("BakeCake", 1, 0)
    with pytest.raises(InputError, match="cannot be demonstrated; there are: CloseDrawer, CloseSingleDoor"):
        demonstrate(make("StoreCheese", 0), np.random.default_rng(0))


def test_failures_are_dropped_unless_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    def idle(kitchen: object, rng: np.random.Generator, **_: object) -> tuple[object, ...]:
        return (kitchen.observe(), kitchen.step(_hold()))  # type: ignore[attr-defined]

    monkeypatch.setattr("symskill_pddl.kitchen.record.demonstrate", idle)
    kept = record("OpenSingleDoor", 2, 0, keep_failed=True)
    assert [d.attributes["success"] for d in kept] == [0, 0]
    assert [d.attributes["seed"] for d in kept] == [0, 1]
    assert isinstance(kept[0].T_world_ee, Pose)
    with pytest.raises(InputError, match="only 0 succeeded"):
        record("OpenSingleDoor", 1, 0)


def _hold() -> object:
    from symskill_pddl.scene import Command

    return Command.hold(False)
