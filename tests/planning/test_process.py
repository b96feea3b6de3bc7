"""Programs that misbehave: every bound is held, and nothing of them is left."""

import importlib.util
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.planning import Limits, process
from symskill_pddl.planning.process import plan_files, run, watched, work_folder

BENCHMARK = Path(__file__).parents[2] / "benchmarks" / "misbehaving_planners.py"
needs_proc = pytest.mark.skipif(not Path("/proc/self/environ").exists(), reason="needs /proc to look for processes")
spec = importlib.util.spec_from_file_location("misbehaving_planners", BENCHMARK)
ways = sys.modules["misbehaving_planners"] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(ways)


@pytest.fixture
def mark(request, tmp_path, monkeypatch):
    """Temporary files go where they are counted."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    return f"symskill-test-{os.getpid()}-{abs(hash(request.node.name))}"


@needs_proc
@pytest.mark.parametrize("name", ways.WAYS)
def test_nothing_is_left_of_a_planner_that(name, mark, tmp_path):
    way = ways.WAYS[name]
    found = ways.ask(way, mark, time_s=0.3)
    assert found.status.value == way.status
    assert way.said in " ".join(found.messages)
    assert ways.left(mark) == 0
    assert not list(tmp_path.iterdir())


@needs_proc
@pytest.mark.parametrize(("name", "started"), [("detaches, goes on", 5), ("ignores SIGTERM", 3), ("floods its output", 3)])
def test_a_planner_ends_with_the_process_that_asks_it(name, started, mark, tmp_path):
    ways.kill_while_asking(ways.WAYS[name], mark, started)
    assert ways.left(mark) == 0
    assert not list(tmp_path.iterdir())


def sh(script, folder, **more):
    return run(["sh", "-c", script], folder, Limits(), time_s=60.0, **more)


def test_what_a_program_says_and_reads(tmp_path):
    (tmp_path / "in").write_text("hello")
    with work_folder() as folder:
        ended = sh("pwd; cat; echo there >&2; exit 7", folder, stdin=tmp_path / "in")
        assert (ended.status, ended.stopped) == (7, "")
        assert ended.output == f"{folder}\nhellothere\n"
        assert ended.printed == len(ended.output)
        assert ended.last_line == "hellothere"
        assert sh("kill -9 $$", folder).status == -9
    assert not folder.exists()


def test_of_much_output_the_last_is_kept(monkeypatch):
    monkeypatch.setattr(process, "_TEXT_BYTES", 1000)
    with work_folder() as folder:
        ended = sh("head -c 3000000 /dev/zero | tr '\\0' x; echo; echo end", folder)
    assert len(ended.output) == 1000
    assert ended.output.endswith("x\nend\n")
    assert ended.printed == 3_000_005


def test_what_it_said_last_fits_into_a_message():
    with work_folder() as folder:
        said = sh("printf 'first\\n\\033]52;c;AAAA\\007'; head -c 100000 /dev/zero | tr '\\0' x", folder).last_line
    assert len(said) <= 300
    assert "\033" not in said
    assert said.endswith("xxx")


def test_a_program_is_asked_before_it_is_ended(monkeypatch):
    """An anytime planner writes its best plan when it is asked to end; here as soon as there was time for it to be ready."""
    monkeypatch.setattr(process, "_GRACE_S", 60.0)
    monkeypatch.setattr(process, "_GRACE_PART", 1000.0)
    script = "trap 'echo best; exit 0' TERM; echo ready; while :; do sleep 0.01; done 2>&-"
    with work_folder() as folder:
        for time_s in (0.2, 2.0, 20.0):
            ended = run(["sh", "-c", script], folder, Limits(), time_s=time_s)
            if "ready" in ended.output:
                break
    assert ended.out_of_time
    assert ended.output.splitlines()[-1] == "best"


def test_temporary_files_go_into_the_folder():
    with work_folder() as folder:
        assert Path(sh("mktemp", folder).last_line).parent == folder


def test_no_time_is_out_of_time():
    with work_folder() as folder:
        assert run(["true"], folder, Limits(), time_s=0.0).out_of_time


@pytest.mark.parametrize(
    ("word", "why"), [("/no/such/planner", "No such file"), ("/etc/passwd", "Permission denied"), ("/etc", "Permission denied")]
)
def test_what_cannot_be_started(word, why):
    with work_folder() as folder, pytest.raises(InputError, match=f"cannot run the planner '{word}': {why}"):
        run([word], folder, Limits(), time_s=60.0)


def test_other_systems_are_told(monkeypatch, tmp_path):
    monkeypatch.setattr(process.os, "name", "nt")
    with pytest.raises(InputError, match="need Linux or macOS"):
        run(["true"], tmp_path, Limits(), time_s=1.0)


def test_planning_is_imported_where_there_is_no_module_resource():
    code = "import sys; sys.modules.update(resource=None, fcntl=None); import symskill_pddl.planning"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_plan_files_in_order(tmp_path):
    names = ["plan.txt", "plan.txt.10", "plan.txt.2", "plan_3.SOL", "planner.log", "domain.pddl", "sas_plan", "plan.log"]
    for name in names:
        (tmp_path / name).write_text(name)
    assert plan_files(tmp_path, "plan.txt") == ("plan.txt", "plan.txt.2", "plan_3.SOL", "plan.txt.10")
    assert plan_files(tmp_path, "plan") == ("plan_3.SOL",)


def test_only_regular_files_of_the_folder_are_plans(tmp_path):
    folder = tmp_path / "folder"
    folder.mkdir()
    (tmp_path / "outside").write_text("outside")
    os.mkfifo(folder / "plan.1")
    (folder / "plan.2").mkdir()
    (folder / "plan.3").symlink_to(tmp_path / "outside")
    (folder / "plan.4").symlink_to("/dev/zero")
    (folder / "plan.5").symlink_to("plan.5")
    (folder / "plan.6").symlink_to("best")
    (folder / "best").write_bytes(b"(move b)\xff\n")
    (folder / "plan.7").write_text("")
    assert plan_files(folder, "plan.txt") == ("(move b)\ufffd\n",)


def test_of_a_long_plan_file_the_beginning_is_read(tmp_path, monkeypatch):
    monkeypatch.setattr(process, "_TEXT_BYTES", 10)
    (tmp_path / "plan.txt").write_text("0123456789abc")
    assert plan_files(tmp_path, "plan.txt") == ("0123456789",)


def ended(process):
    process.stdin.close()
    process.stdout.close()
    return process.wait()


@pytest.fixture
def kept(mark, request):
    """Start a shell script under watch."""
    started = []

    def start(script):
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
        started.append(subprocess.Popen(watched(["sh", "-c", script, "sh", mark]), start_new_session=True, **pipes))
        return started[-1]

    yield start
    for each in started:
        each.terminate()
        ended(each)


def test_a_program_that_is_watched_has_its_streams_and_its_status(kept):
    program = kept("read word; echo got $word; exit 5")
    assert program.communicate(b"hello\n") == (b"got hello\n", None)
    assert program.returncode == 5
    assert ended(kept("kill -9 $$")) == -9
    assert ended(kept("kill -ABRT $$")) == -6


@needs_proc
def test_all_of_a_program_that_is_watched_ends_when_it_is_no_longer_wanted(kept, mark):
    program = kept("setsid sh -c 'echo ready; sleep 60; :' $1 & sleep 60; :")
    assert program.stdout.readline() == b"ready\n"
    program.terminate()
    assert ended(program) == 0
    assert ways.left(mark) == 0


@needs_proc
def test_all_of_a_program_that_is_watched_ends_with_who_started_it(mark):
    script = "setsid sh -c 'echo ready; sleep 60; :' $1 & sleep 60; :"
    code = "import subprocess, sys; from symskill_pddl.planning.process import watched; "
    code += f"subprocess.run(watched(['sh', '-c', {script!r}, 'sh', {mark!r}]))"
    asking = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE)
    assert asking.stdout.readline() == b"ready\n"
    asking.kill()
    ended_asking = asking.wait()
    asking.stdout.close()
    assert ended_asking == -9
    assert ways.left(mark) == 0


def test_no_place_for_a_temporary_folder(monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", "/no/such/folder")
    with pytest.raises(InputError, match="cannot make a temporary folder for a planner: No such file"), work_folder():
        pass


@needs_proc
def test_who_stops_what_watches_it_is_out_of_time(monkeypatch, mark):
    monkeypatch.setattr(process, "_PATIENCE_S", 0.0)
    found = ways.ask(ways.Way("kill -STOP $PPID; sleep 60", "timeout"), mark, time_s=0.3)
    assert found.status.value == "timeout"
    assert ways.left(mark) == 0


def test_time_without_end():
    with work_folder() as folder:
        assert run(["true"], folder, Limits(time_s=float("inf")), time_s=float("inf")).status == 0
