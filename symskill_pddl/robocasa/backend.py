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
from xml.etree import ElementTree

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.robocasa.assets import robocasa_folder

ASSETS = "ROBOCASA_ASSETS_PATH"
"""The variable that RoboCasa reads when it is imported: where its models and textures are."""
PACK = Path(".robocasa-assets")
"""Where `make robocasa` writes the small asset pack: in the working directory, or beside the environment."""
PARTS = ("arenas", "fixtures", "objects", "scenes", "textures")
"""Folders that every root of assets has."""
HOW = "`make robocasa` builds an environment that has it"
HOW_ASSETS = f"`make robocasa` makes small ones, or set {ASSETS} to where they are"


def assets_folder() -> Path:
    """Where RoboCasa is to take its models and textures from: what the variable names, else the small pack, else its own.

    Raises
    ------
    MissingDependencyError
        RoboCasa is not installed, or its assets are not there.
    InputError
        The variable names a folder that is none, or not of assets.
    """
    own, named = robocasa_folder() / "models" / "assets", os.environ.get(ASSETS)
    packs = (pack.resolve() for pack in (PACK, Path(sys.prefix).parent / PACK) if pack.is_dir())
    root = Path(named) if named else next(packs, own)
    missing = next((name for name in PARTS if not (root / name).is_dir()), None)
    if missing is None:
        return root
    if named:
        what = f"has no '{missing}'" if root.is_dir() else "is no folder"
        raise InputError(f"{ASSETS}='{named}' {what}; it has to be the root of RoboCasa's assets, or of those by `make robocasa`")
    raise MissingDependencyError(f"RoboCasa's assets are not there ('{root}' has no '{missing}'): {HOW_ASSETS}")


@contextlib.contextmanager
def reading_assets() -> Iterator[None]:
    """In this context a file of the assets that is missing or damaged is the user's to know, in one line."""
    root = assets_folder()
    try:
        yield
    except (OSError, ElementTree.ParseError) as error:
        where = f"{damaged}: " if isinstance(error, ElementTree.ParseError) and (damaged := _damaged(root)) else ""
        raise InputError(f"RoboCasa's assets in '{root}': {where}{error}; write or download them anew") from error
    except ValueError as error:
        # MuJoCo says so of a model that it cannot compile
        if not str(error).startswith(("Error: ", "XML Error: ")):
            raise
        raise InputError(f"RoboCasa's assets in '{root}': {' '.join(str(error).split())}; write or download them anew") from error


def _damaged(root: Path) -> Path | None:
    """The first file that is no XML, though its name says so."""
    for folder, _, names in sorted(os.walk(root)):
        for file in (Path(folder, name) for name in sorted(names) if name.endswith(".xml")):
            try:
                ElementTree.parse(file)
            except (OSError, ElementTree.ParseError):
                return file
    return None


@lru_cache(maxsize=1)
def load_robocasa() -> tuple[ModuleType, ModuleType]:
    """The modules robosuite and robocasa.

    Raises
    ------
    MissingDependencyError
        One of them is not installed, or they do not fit together, or there are no assets.
    """
    os.environ[ASSETS] = str(assets_folder())
    os.environ.setdefault("MUJOCO_GL", "disabled")
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
