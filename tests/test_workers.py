"""Workers end with the process that started them."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from symskill_pddl import workers

needs_fork = pytest.mark.skipif(not workers.can_fork(), reason="needs processes that start as copies")


def told() -> str:
    return os.environ["SYMSKILL_TOLD"]


def tell(word: str) -> None:
    os.environ["SYMSKILL_TOLD"] = word


@pytest.mark.parametrize("method", [pytest.param("fork", marks=needs_fork), "spawn"])
def test_a_pool_begins_as_it_is_told(method: str) -> None:
    with workers.pool(1, method, tell, ("hello",)) as pool:
        assert pool.submit(told).result() == "hello"
        assert pool.submit(os.getpid).result() != os.getpid()


PROGRAM = """
import os, sys, time
from pathlib import Path
from symskill_pddl import workers
def work(folder):
    Path(folder, str(os.getpid())).touch()
    {what}
if __name__ == "__main__":
    with workers.pool(2, {method!r}) as pool:
        list(pool.map(work, [sys.argv[1]] * 6))
"""
IDLE = "time.sleep(3600)"
BUSY = "sum(range(10**12))"
"""In one call that never lets another thread have its turn."""


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="needs /proc to look for processes")
@pytest.mark.parametrize("method", [pytest.param("fork", marks=needs_fork), "spawn"])
@pytest.mark.parametrize("what", [IDLE, BUSY])
def test_workers_of_a_killed_process_end(tmp_path: Path, method: str, what: str) -> None:
    program, folder = tmp_path / "program.py", tmp_path / "started"
    program.write_text(PROGRAM.format(what=what, method=method))
    folder.mkdir()
    parent = subprocess.Popen([sys.executable, program, folder])
    while len(list(folder.iterdir())) < 2 and parent.poll() is None:
        time.sleep(0.01)
    parent.send_signal(signal.SIGKILL)
    parent.wait()
    started = {int(path.name) for path in folder.iterdir()}
    assert len(started) == 2
    for _ in range(500):
        if not (started := {pid for pid in started if running(pid)}):
            break
        time.sleep(0.02)
    assert not started


def running(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
