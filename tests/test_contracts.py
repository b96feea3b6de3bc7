"""The room table is checked, and the check covers every room."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from symskill_pddl.worlds import ARENAS

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "symskill_pddl"
HEAVY = ("numpy", "scipy", "sklearn", "cvxpy", "h5py", "numba", "mujoco", "robosuite", "unified_planning")
SIMULATORS = ("mujoco", "robosuite")
WORLDS = tuple(where.split(":")[0].rsplit(".", 1)[0] for where in ARENAS.values())
NO_WORLD = ("learning", "skills", "pddl", "planning", "execution", "evaluation")


def contracts() -> list[dict[str, object]]:
    return list(tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"])


def rooms() -> set[str]:
    files = {p.stem for p in PACKAGE.glob("*.py")} - {"__init__"}
    return files | {p.parent.name for p in PACKAGE.glob("*/__init__.py")}


def test_every_room_has_a_contract_and_every_contract_a_room() -> None:
    sources = {str(m).split(".")[1] for c in contracts() for m in c["source_modules"]}  # type: ignore[attr-defined]
    assert sources == rooms()


def test_every_room_is_forbidden_to_some_other() -> None:
    forbidden = {str(m).split(".")[1] for c in contracts() for m in c["forbidden_modules"] if str(m).startswith("symskill_pddl.")}  # type: ignore[attr-defined]
    # these are for everybody
    assert forbidden | {"arrays", "errors", "files", "reading", "workers"} >= rooms()


def test_contracts_hold() -> None:
    done = subprocess.run([Path(sys.executable).parent / "lint-imports"], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize(
    ("modules", "unwanted"),
    [
        ("symskill_pddl.symbols", HEAVY),
        ("symskill_pddl.pddl", HEAVY),
        ("symskill_pddl.planning", HEAVY),
        ("symskill_pddl.execution.monitor", HEAVY),
        ("symskill_pddl.cli.app", HEAVY),
        ("symskill_pddl.learning", SIMULATORS),
        ("symskill_pddl.demos", SIMULATORS),
        ("symskill_pddl.execution.executor", SIMULATORS),
        ("symskill_pddl.kitchen", SIMULATORS),
        ("symskill_pddl.evaluation.suite", WORLDS),
        ("symskill_pddl.kitchen.arena", SIMULATORS),
        ("symskill_pddl.report", SIMULATORS),
    ],
)
def test_importing_a_room_loads_nothing_it_should_not_need(modules: str, unwanted: tuple[str, ...]) -> None:
    code = f"import sys, {modules}; print(*sorted(set(sys.modules) & set({unwanted!r})))"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
    assert done.stdout.split() == []


@pytest.mark.parametrize(
    ("file", "line", "contract"),
    [
        ("symbols.py", "import symskill_pddl.scene", "symbols imports errors"),
        ("pddl/names.py", "import numpy", "need no numpy"),
        ("execution/executor.py", "import mujoco", "know a simulator"),
        ("learning/goals.py", "import symskill_pddl.kitchen", "knows no world"),
        ("evaluation/trial.py", "from symskill_pddl.kitchen import make", "knows no world"),
    ],
)
def test_a_forbidden_import_is_found(tmp_path: Path, file: str, line: str, contract: str) -> None:
    for source in PACKAGE.rglob("*.py"):
        target = tmp_path / source.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(source.read_text())
    (tmp_path / "pyproject.toml").write_text((ROOT / "pyproject.toml").read_text())
    broken = tmp_path / "symskill_pddl" / file
    broken.write_text(f"{broken.read_text()}\n{line}\n")
    program = "import sys; sys.path.insert(0, '.'); from importlinter.cli import lint_imports_command; lint_imports_command()"
    done = subprocess.run(
        [sys.executable, "-c", program, "--no-cache"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 1, done.stdout + done.stderr
    assert any(contract in row and "BROKEN" in row for row in done.stdout.splitlines()), done.stdout


def worlds() -> set[str]:
    """The rooms that the contract about worlds names."""
    (contract,) = (c for c in contracts() if "knows no world" in str(c["name"]))
    assert {f"symskill_pddl.{room}" for room in NO_WORLD} <= set(contract["source_modules"])  # type: ignore[call-overload]
    return {str(m).removeprefix("symskill_pddl.") for m in contract["forbidden_modules"]}  # type: ignore[attr-defined]


@pytest.mark.parametrize("room", NO_WORLD)
def test_what_learns_plans_and_runs_does_not_even_name_a_world(room: str) -> None:
    sources = [p for p in (PACKAGE / room).rglob("*") if p.suffix in (".py", ".j2")]
    assert len(sources) > 3
    for source in sources:
        text = source.read_text().lower()
        assert [name for name in worlds() if name in text] == [], source


def test_worlds_are_in_the_contract_and_do_not_know_each_other() -> None:
    assert worlds() >= {world.removeprefix("symskill_pddl.") for world in WORLDS}
    for world in worlds():
        for source in (PACKAGE / world).rglob("*.py"):
            imports = [line for line in source.read_text().splitlines() if "import" in line]
            assert not [line for line in imports for other in worlds() - {world} if f"symskill_pddl.{other}" in line], source
