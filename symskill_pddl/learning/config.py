"""The settings of learning, and the TOML file that sets any of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from symskill_pddl.errors import InputError, alternatives
from symskill_pddl.learning.hints import Hints
from symskill_pddl.learning.scale import RelationConfig
from symskill_pddl.learning.skills import SkillConfig
from symskill_pddl.learning.states import StateConfig
from symskill_pddl.reading import parse_toml, read_text


@dataclass(frozen=True)
class LearnConfig:
    """All settings of learning, stage by stage: the sections of a file of settings."""

    states: StateConfig = field(default_factory=StateConfig)
    relations: RelationConfig = field(default_factory=RelationConfig)
    skills: SkillConfig = field(default_factory=SkillConfig)
    hints: Hints = field(default_factory=Hints)

    def with_older_hints(self, document: Mapping[str, Any]) -> LearnConfig:
        """The same with the hints of a library too, as far as there are no others here."""
        return replace(self, hints=Hints.of(merged(document, self.hints.document())))


def read_config(path: Path) -> LearnConfig:
    """The settings of a TOML file with a table per stage, such as ``[relations]`` with ``gap = 1.0``; the others stay.
    ``[hints]`` are those of `hints`.

    Raises
    ------
    InputError
        If the file cannot be read, or names a setting that does not exist, or a value is no positive number.
    """
    document = read_toml(path)
    config = LearnConfig()
    _known(path, "table", document, {f.name for f in fields(config)})
    if "hints" in document:
        config = replace(config, hints=Hints.of(document.pop("hints"), str(path)))
    for stage, values in document.items():
        if not isinstance(values, dict):
            raise InputError(f"{path}: '{stage}' has to be a table, [{stage}], with settings below it")
        old = getattr(config, stage)
        _known(path, f"setting of [{stage}]", values, {f.name for f in fields(old)})
        new = {name: _number(path, f"{stage}.{name}", value, getattr(old, name)) for name, value in values.items()}
        config = replace(config, **{stage: replace(old, **new)})
    return config


def read_toml(path: Path) -> dict[str, Any]:
    """A TOML file, as tables.

    Raises
    ------
    InputError
        If it cannot be read.
    FormatError
        If it is no TOML; the message has the place.
    """
    return parse_toml(read_text(path, "file of settings"), f"'{path}'")


def _known(path: Path, what: str, found: Mapping[str, Any], known: set[str]) -> None:
    unknown = sorted(found.keys() - known)
    if unknown:
        raise InputError(f"{path}: there is no {what} '{unknown[0]}'; there are: {alternatives(known)}")


def _number(path: Path, name: str, value: object, default: float) -> float:
    whole = isinstance(default, int)
    if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)) or not 0 < value < float("inf"):
        raise InputError(f"{path}: {name} has to be a positive {'whole ' if whole else ''}number, got {value!r}")
    return value if whole else float(value)


def merged(old: Mapping[str, Any], new: Mapping[str, Any]) -> dict[str, Any]:
    """Two tables of hints as one, in which the new ones count."""
    both = {k: {**old[k], **new[k]} for k in old.keys() & new.keys() if isinstance(old[k], dict) and isinstance(new[k], dict)}
    return {**old, **new, **both}
