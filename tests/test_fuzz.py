"""Every reader takes whatever it is given, or refuses it: a few spoilt files each, and the cases that fuzzing found."""

import importlib.util
import sys
from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from symskill_pddl.errors import MissingDependencyError, SymSkillError

ROOT = Path(__file__).parent.parent
KEPT = Path(__file__).parent / "data" / "fuzz"


def _module(name):
    if name not in sys.modules:
        spec = importlib.util.spec_from_file_location(name, ROOT / "benchmarks" / f"{name}.py")
        sys.modules[name] = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(sys.modules[name])
    return sys.modules[name]


READERS = _module("fuzz_readers").READERS
MUTATIONS = _module("fuzz_mutations")
QUICK = sorted(READERS.keys() - {"library"})  # whose seed is learned; tests/test_library.py has it


@pytest.fixture(scope="module")
def seeds(tmp_path_factory):
    """Folders of files that are right, made when they are asked for."""
    made = {}

    def seed(name):
        if name not in made:
            made[name] = tmp_path_factory.mktemp(name)
            READERS[name].seed(made[name])
        return made[name]

    return seed


def _read(name, case):
    try:
        READERS[name].read(case)
    except MissingDependencyError:
        pytest.skip("needs what is not installed here")
    except SymSkillError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("name", QUICK)
def test_what_is_right_is_read(seeds, tmp_path, name):
    MUTATIONS.copy(seeds(name), tmp_path / "case")
    assert _read(name, tmp_path / "case") == ""


@pytest.mark.parametrize("name", QUICK)
@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(number=st.integers(0, 10**9))
def test_what_is_spoilt_is_read_or_refused(seeds, tmp_path, name, number):
    case = tmp_path / "case"
    MUTATIONS.copy(seeds(name), case)
    MUTATIONS.spoil(Random(f"{name} {number}"), case)
    READERS[name].repair(case)
    assert len(_read(name, case)) < 20_000


@pytest.mark.parametrize("case", sorted(KEPT.glob("*/*")), ids=lambda case: f"{case.parent.name}-{case.name}")
def test_what_fuzzing_found_stays_mended(tmp_path, case):
    MUTATIONS.copy(case, tmp_path / "case")
    assert len(_read(case.parent.name, tmp_path / "case")) < 20_000
