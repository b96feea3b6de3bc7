"""robosuite and RoboCasa, imported late and quietly. Only this file imports them."""

from __future__ import annotations

import contextlib
import importlib
import io
import logging
import os
import sys
from collections.abc import Iterator
from copy import deepcopy
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

from symskill_pddl.errors import MissingDependencyError
from symskill_pddl.robocasa.assets import robocasa_folder

ASSETS = "ROBOCASA_ASSETS_PATH"
"""The variable that RoboCasa reads when it is imported: where its models and textures are."""
PACK = Path(".robocasa-assets")
"""Where `make robocasa` writes the small asset pack: in the working directory, or beside the environment."""
HOW = "`make robocasa` builds an environment that has it"


@lru_cache(maxsize=1)
def load_robocasa() -> tuple[ModuleType, ModuleType]:
    """The modules robosuite and robocasa.

    Where no assets are named and the small pack is there, RoboCasa is told to use that.

    Raises
    ------
    MissingDependencyError
        One of them is not installed, or they do not fit together.
    """
    robocasa_folder()
    os.environ.setdefault("MUJOCO_GL", "disabled")
    if ASSETS not in os.environ:
        for pack in (PACK, Path(sys.prefix).parent / PACK):
            if pack.is_dir():
                os.environ[ASSETS] = str(pack.resolve())
                break
    wanted = os.environ["MUJOCO_GL"]
    previous = logging.root.manager.disable
    logging.disable(logging.WARNING)
    try:
        # both greet on standard output, which belongs to the command line
        with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
            return importlib.import_module("robosuite"), importlib.import_module("robocasa")
    except ImportError as error:
        raise MissingDependencyError(f"RoboCasa cannot be imported ({error}): {HOW}") from error
    except (AssertionError, TypeError) as error:
        raise MissingDependencyError(f"RoboCasa does not work with the robosuite of this environment ({error}): {HOW}") from error
    finally:
        logging.disable(previous)
        os.environ["MUJOCO_GL"] = wanted


@contextlib.contextmanager
def quick_yaml() -> Iterator[None]:
    """In this context a YAML file is parsed once: RoboCasa parses that of a style for every fixture, most of a reset's time."""
    yaml: Any = importlib.import_module("yaml")
    slow = yaml.safe_load

    def quick(stream: Any) -> Any:
        return deepcopy(_parsed(stream if isinstance(stream, str) else stream.read()))

    yaml.safe_load = quick
    try:
        yield
    finally:
        yaml.safe_load = slow


@lru_cache
def _parsed(text: str) -> Any:
    yaml = importlib.import_module("yaml")
    return yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))


def load_mujoco() -> ModuleType:
    """The mujoco module, with its warnings in the log."""
    load_robocasa()
    module = importlib.import_module("mujoco")
    module.set_mju_user_warning(logging.getLogger(__name__).warning)
    return module
