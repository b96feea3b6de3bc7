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
        It is not installed.
    """
    # mujoco and robosuite look for a GL library at import unless they are told not to
    os.environ.setdefault("MUJOCO_GL", "disabled")
    try:
        return importlib.import_module("mujoco")
    except ImportError as error:
        raise MissingDependencyError(f"the simulated kitchen needs mujoco ({error}): pip install 'mujoco>=3.3,<3.10'") from error


@lru_cache(maxsize=1)
def load_robosuite() -> ModuleType:
    """The robosuite module, with the warnings of its start-up (private macros, optional robots) silenced.

    Raises
    ------
    MissingDependencyError
        It, or a system library it needs, is missing.
    """
    load_mujoco()
    previous = logging.root.manager.disable
    logging.disable(logging.WARNING)
    try:
        return importlib.import_module("robosuite")
    except ImportError as error:
        raise missing(error) from error
    finally:
        logging.disable(previous)


def missing(error: ImportError) -> MissingDependencyError:
    """One line that says what to install when importing robosuite failed with `error`."""
    if "libGL" in str(error) or "cv2" in str(error):
        return MissingDependencyError(
            f"robosuite cannot load OpenCV ({error}): pip uninstall -y opencv-python, "
            "then pip install --force-reinstall opencv-python-headless, which needs no libGL"
        )
    return MissingDependencyError(f"the simulated kitchen needs robosuite ({error}): pip install 'robosuite>=1.5.2,<1.6'")
