import os
import subprocess
import sys

import pytest

from symskill_pddl.errors import MissingDependencyError
from symskill_pddl.kitchen.backend import check_version, missing


@pytest.mark.parametrize(
    "text", ["libGL.so.1: cannot open shared object file: No such file or directory", "No module named 'cv2'"]
)
def test_a_missing_libgl_says_what_to_install(text):
    message = str(missing(ImportError(text)))
    assert "pip install --force-reinstall opencv-python-headless" in message
    assert text in message
    assert "\n" not in message


def test_another_missing_module_names_robosuite():
    assert "pip install 'robosuite" in str(missing(ImportError("No module named 'robosuite'")))


@pytest.mark.parametrize("version", ["3.2.7", "3.10.0", "4.0.0"])
def test_a_mujoco_robosuite_cannot_use_is_refused(version):
    with pytest.raises(MissingDependencyError, match=f"found {version}"):
        check_version(version)
    check_version("3.9.0")


def test_importing_the_kitchen_imports_neither_robosuite_nor_mujoco():
    code = "import sys, symskill_pddl.kitchen; print(sorted({'mujoco', 'robosuite', 'numba'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


@pytest.mark.simulation
def test_starting_robosuite_is_silent():
    code = "from symskill_pddl.kitchen.backend import load_robosuite; load_robosuite()"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert (done.stdout, done.stderr) == ("", "")


def test_child_processes_are_not_told_to_look_for_a_display():
    code = "import os; from symskill_pddl.kitchen.backend import load_robosuite; load_robosuite(); print(os.environ['MUJOCO_GL'])"
    environment = {name: value for name, value in os.environ.items() if name != "MUJOCO_GL"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert done.stdout == "disabled\n"
