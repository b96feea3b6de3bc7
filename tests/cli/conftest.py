from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from symskill_pddl.cli import main

ROOT = Path(__file__).parent.parent.parent
ROBOSUITE = ROOT / "tests" / "data" / "robosuite"


@dataclass(frozen=True)
class Done:
    """What a call of the program did."""

    status: int
    out: str
    err: str

    @property
    def error(self) -> str:
        """The one line of the error."""
        lines = [line for line in self.err.splitlines() if line.startswith("symskill: error: ")]
        assert len(lines) == 1, self.err
        assert self.err.endswith(lines[0] + "\n"), self.err
        return lines[0].removeprefix("symskill: error: ")


@pytest.fixture
def symskill(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Callable[..., Done]:
    """Call the program in this process."""

    def call(*arguments: object) -> Done:
        capsys.readouterr()
        monkeypatch.setattr(sys, "argv", ["symskill", *map(str, arguments)])
        status = 0
        try:
            main()
        except SystemExit as exit_:
            status = exit_.code if isinstance(exit_.code, int) else int(exit_.code is not None)
        captured = capsys.readouterr()
        return Done(status, captured.out, captured.err)

    return call


DOMAIN = """(define (domain toys)
  (:requirements :strips :typing)
  (:types toy box - object)
  (:predicates (in ?toy - toy ?box - box) (held ?toy - toy) (lost ?toy - toy))
  (:action take
    :parameters (?toy - toy ?box - box)
    :precondition (and (in ?toy ?box))
    :effect (and (held ?toy) (not (in ?toy ?box))))
  (:action put
    :parameters (?toy - toy ?box - box)
    :precondition (and (held ?toy))
    :effect (and (in ?toy ?box) (not (held ?toy)))))
"""
PROBLEM = """(define (problem tidy) (:domain toys)
  (:objects ball car - toy red blue - box)
  (:init (in ball red) (in car blue))
  (:goal (and (in ball blue))))
"""


@pytest.fixture
def toys(tmp_path: Path) -> tuple[Path, Path]:
    """A small domain and a problem of it, as files."""
    domain, problem = tmp_path / "toys.pddl", tmp_path / "tidy.pddl"
    domain.write_text(DOMAIN)
    problem.write_text(PROBLEM)
    return domain, problem


@pytest.fixture(scope="session")
def lift(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with `lift.hdf5`, imported from a person's recording, and `library`, learned from it. Not to be changed."""
    from symskill_pddl.cli.work import learn_from
    from symskill_pddl.demos import import_robosuite, save_demos

    folder = tmp_path_factory.mktemp("lift")
    save_demos(folder / "lift.hdf5", import_robosuite(ROBOSUITE / "panda_lift.hdf5"))
    learn_from([folder / "lift.hdf5"], folder / "library")
    return folder


@pytest.fixture
def demos(lift: Path, tmp_path: Path) -> Path:
    """A file of demonstrations, one's own."""
    return Path(shutil.copy(lift / "lift.hdf5", tmp_path / "lift.hdf5"))


@pytest.fixture
def library(lift: Path, tmp_path: Path) -> Path:
    """A learned library, one's own."""
    return Path(shutil.copytree(lift / "library", tmp_path / "library"))
