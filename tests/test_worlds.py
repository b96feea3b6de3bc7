import pytest
from toy_arena import ToyArena

from symskill_pddl.arena import Arena, Disturbed, Filmable, Recordable
from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.worlds import ARENAS, DEFAULT, MAX_SEED, arena_named, check_seed, check_task, ready


@pytest.mark.parametrize("name", ARENAS)
def test_every_world_of_the_table_is_an_arena(name: str) -> None:
    arena = arena_named(name)
    assert isinstance(arena, Arena)
    assert arena.name == name
    assert set(arena.tasks.values()) <= {"atomic", "composed", "play", "play goal"}
    for preset in arena.presets.values():
        assert set(preset.tasks) <= set(arena.tasks)
        for spec in preset.disturbances:
            arena.check_disturbance(spec)
    with pytest.raises(InputError, match="earthquake"):
        arena.check_disturbance("earthquake@t=1")


def test_the_default_can_be_recorded_and_filmed() -> None:
    arena = arena_named(DEFAULT)
    assert isinstance(arena, Recordable)
    assert isinstance(arena, Filmable)
    episode = arena.open("OpenDrawer", 0)
    assert isinstance(episode, Disturbed)
    assert episode.goals == (("OpenDrawer", ("drawer", "drawer-unit")),)
    assert arena.open("StoreCheese", 0).goals == (
        ("PnPCabToCounter", ("cheese", "cabinet", "counter")),
        ("CloseSingleDoor", ("door", "cabinet")),
    )


def test_one_of_your_own() -> None:
    arena = arena_named("toy_arena:ARENA")
    assert arena.name == "toy"
    assert arena_named("toy_arena:ARENA") is arena


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("moon", "unknown world 'moon'; there are: kitchen.*; or say MODULE:NAME"),
        ("", "unknown world ''"),
        (":ARENA", "unknown world ':ARENA'"),
        ("..toy_arena:ARENA", "unknown world '..toy_arena:ARENA'"),
        ("no_such_module:ARENA", "world 'no_such_module:ARENA': No module named 'no_such_module'"),
        ("toy_arena:MOON", "world 'toy_arena:MOON': module 'toy_arena' has no attribute 'MOON'"),
        ("toy_arena:NO_ARENA", "is no arena, which has: check_disturbance, name, open, presets, tasks"),
    ],
)
def test_a_world_that_is_not_there(name: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        arena_named(name)


@pytest.mark.parametrize("seed", [-1, 2**31, 2**64])
def test_a_seed_that_no_world_takes(seed: int) -> None:
    check_seed(0)
    check_seed(MAX_SEED)
    with pytest.raises(InputError, match=f"a seed is at (least|most) .*, got {seed}"):
        check_seed(seed)


def test_a_task_that_is_not_there() -> None:
    arena = arena_named("toy_arena:ARENA")
    check_task(arena, "OpenUp")
    with pytest.raises(InputError, match="unknown task 'Fly'; the world 'toy' has: OpenUp, PutIn, StoreIt"):
        check_task(arena, "Fly")


class Unprovided(ToyArena):
    """A world whose simulator is not installed."""

    def check_ready(self) -> None:
        raise MissingDependencyError("no simulator here")


UNPROVIDED = Unprovided()


def test_a_world_says_before_the_work_what_it_lacks() -> None:
    assert ready("toy_arena:ARENA", "OpenUp") is arena_named("toy_arena:ARENA")
    with pytest.raises(InputError, match="unknown task 'Fly'"):
        ready("toy_arena:ARENA", "Fly")
    for task in (None, "OpenUp"):
        with pytest.raises(MissingDependencyError, match="no simulator here"):
            ready("test_worlds:UNPROVIDED", task)
