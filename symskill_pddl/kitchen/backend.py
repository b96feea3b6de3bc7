"""robosuite and mujoco, imported late and quietly.

Only this file imports them: learning and planning have to run, and start fast, on machines without either.
"""

from __future__ import annotations

import importlib
import logging
import os
from functools import lru_cache
from types import ModuleType

from symskill_pddl.errors import MissingDependencyError


@lru_cache(maxsize=1)
def load_mujoco() -> ModuleType:
    """The mujoco module.

    Raises
    ------
    MissingDependencyError
        It is not installed, or of a version that robosuite cannot work with.
    """
    # mujoco and robosuite look for a GL library at import unless they are told not to
    os.environ.setdefault("MUJOCO_GL", "disabled")
    try:
        module = importlib.import_module("mujoco")
    except ImportError as error:
        raise MissingDependencyError(f"the simulated kitchen needs mujoco ({error}): pip install 'mujoco>=3.3,<3.10'") from error
    check_version(module.__version__)
    # left alone, mujoco prints its warnings on standard output and into a file in the working directory
    module.set_mju_user_warning(logging.getLogger(__name__).warning)
    return module


def check_version(version: str) -> None:
    """Raise MissingDependencyError unless robosuite 1.5 works with this mujoco (later ones changed `mj_fullM` and `qM`)."""
    number = tuple(int(part) for part in version.split(".")[:2])
    if not (3, 3) <= number < (3, 10):
        raise MissingDependencyError(f"robosuite works with mujoco 3.3 to 3.9, found {version}: pip install 'mujoco>=3.3,<3.10'")


@lru_cache(maxsize=1)
def load_robosuite() -> ModuleType:
    """The robosuite module, with the warnings of its start-up (private macros, optional robots) silenced.

    Raises
    ------
    MissingDependencyError
        It, or a system library it needs, is missing.
    """
    load_mujoco()
    wanted = os.environ["MUJOCO_GL"]
    previous = logging.root.manager.disable
    logging.disable(logging.WARNING)
    try:
        return importlib.import_module("robosuite")
    except ImportError as error:
        raise missing(error) from error
    finally:
        logging.disable(previous)
        # robosuite sets it to 'egl', which stops mujoco from starting in child processes on machines without libEGL
        os.environ["MUJOCO_GL"] = wanted


def missing(error: ImportError) -> MissingDependencyError:
    """One line that says what to install when importing robosuite failed with `error`."""
    if "libGL" in str(error) or "cv2" in str(error):
        return MissingDependencyError(
            f"robosuite cannot load OpenCV ({error}): pip uninstall -y opencv-python, "
            "then pip install --force-reinstall opencv-python-headless, which needs no libGL"
        )
    return MissingDependencyError(f"the simulated kitchen needs robosuite ({error}): pip install 'robosuite>=1.5.2,<1.6'")
