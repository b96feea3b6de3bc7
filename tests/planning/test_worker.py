"""Whatever an engine does, there is an answer in time, and the next question is answered as if nothing had been."""

import os
import time
from threading import Thread

import pytest

from symskill_pddl.planning import worker
from symskill_pddl.planning.worker import POOL, Remote

ENGINE = "tests.planning.broken"


@pytest.fixture(autouse=True)
def pool():
    yield
    POOL.end()


def remote(how="well"):
    return Remote(ENGINE, {"how": how})


def test_it_answers_and_is_kept():
    first, second = remote(), remote()
    answers = [r.ask(60.0, None, args=("a",)) for r in (first, second, first)]
    assert {(a.status, a.plan) for a in answers} == {("solved", (("step", ("well", "a")),))}
    assert len({a.messages for a in answers}) == 1  # one process
    assert POOL.processor_s > 0.0


@pytest.mark.parametrize("time_s", [float("inf"), 1e308])
def test_a_limit_longer_than_any_clock_is_one(time_s):
    assert remote().ask(time_s, None, args=()).status == "solved"


@pytest.mark.parametrize(
    ("how", "said"),
    [
        ("load", "ValueError: cannot load"),
        ("raise", "RuntimeError: Expecting: ground_literal here"),
        ("exit", "SystemExit: 3"),
        ("crash", "the process of broken ended by the signal SIGSEGV"),
        ("vanish", "the process of broken ended with status 7"),
        ("hoard", "ran out of memory, 4096 MiB"),
    ],
)
def test_what_breaks_is_a_status_with_a_message(how, said):
    breaking = remote(how)
    for _ in range(2):
        reply = breaking.ask(60.0, 4096)
        assert (reply.status, reply.messages) == ("failed", (said,))
    assert remote().ask(60.0, None).status == "solved"


def test_a_module_that_is_not_there():
    reply = Remote("tests.planning.no_such_engine", {}).ask(60.0, None)
    assert reply.status == "failed"
    assert "ended with status 1 while it was started" in reply.messages[0]


@pytest.mark.parametrize("how", ["sleep", "busy"])
def test_one_that_does_not_come_back_is_ended(how):
    assert remote().ask(60.0, None).status == "solved"  # the process runs
    begin = time.monotonic()
    reply = remote(how).ask(0.2, None)
    assert reply.status == "timeout"
    assert "ended" in reply.messages[0]
    assert time.monotonic() - begin < 60.0  # of 600 s, and of hours
    assert remote().ask(60.0, None).status == "solved"


def test_the_kernel_ends_one_that_nobody_waits_for():
    """As when the asking process is killed."""
    alone = worker.Worker(ENGINE)
    alone.start(time.monotonic() + 60.0)
    with pytest.raises(worker.OverdueError):
        alone.ask(1, {"how": "busy"}, {}, 0.05, None)
    assert alone._process.wait(60.0) == -14  # SIGALRM
    alone.end()


def test_an_engine_that_is_still_being_imported_is_not_ended():
    slow = remote()
    assert slow.ask(1e-6, None).messages == ("broken was still being loaded",)
    assert slow.ask(60.0, None).status == "solved"


def test_what_an_engine_prints_goes_nowhere(capfd):
    assert remote("talk").ask(60.0, None).plan == (("step", ("talk",)),)
    assert capfd.readouterr() == ("", "")


def test_threads_ask_different_processes():
    asleep = Thread(target=lambda: remote("sleep").ask(2.0, None))
    asleep.start()
    assert remote().ask(60.0, None).status == "solved"
    asleep.join()


def test_only_so_many_domains_are_kept():
    remotes = [remote(str(i)) for i in range(worker._LOADED + 3)]
    for _ in range(2):
        for i, each in enumerate(remotes):
            assert each.ask(60.0, None).plan == (("step", (str(i),)),)
    (only,) = POOL._idle[ENGINE]
    assert len(only.loaded) == worker._LOADED


def test_a_copy_of_this_process_starts_its_own():
    here = remote()
    mine = here.ask(60.0, None).messages
    readable, writable = os.pipe()
    child = os.fork()
    if not child:
        os.write(writable, here.ask(60.0, None).messages[0].encode())
        POOL.end()
        os._exit(0)
    os.close(writable)
    with os.fdopen(readable) as stream:
        theirs = stream.read()
    os.waitpid(child, 0)
    assert theirs.isdigit()
    assert theirs != mine[0]
    assert here.ask(60.0, None).messages == mine
