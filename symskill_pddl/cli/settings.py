"""Every parameter of learning with its value, unit and reason, read from the configurations themselves.

The unit is the ending of the name, or A, the widest opening of the hand; the reason is the text below the field.
"""

from __future__ import annotations

import ast
import inspect
import json
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from symskill_pddl.demos import Demo
from symskill_pddl.errors import FormatError, InputError, shown
from symskill_pddl.learning import LearnConfig, read_config
from symskill_pddl.learning.config import merged, read_toml
from symskill_pddl.learning.hints import Hints
from symskill_pddl.reading import parse_toml

UNITS = {"_m_s": "m/s", "_rad_s": "rad/s", "_m_rad": "m/rad", "_m": "m", "_rad": "rad", "_deg": "deg", "_s": "s"}


@dataclass(frozen=True)
class Explained:
    """`name` with its path in `LearnConfig`; angles in `value` are given in degrees, where `unit` says so."""

    name: str
    value: str
    unit: str
    reason: str


def parameters(config: LearnConfig | None = None) -> tuple[Explained, ...]:
    """All parameters of learning, in the order of its stages; one that occurs in several places is listed in each."""
    return tuple(_walked(config or LearnConfig(), ""))


def table(explained: tuple[Explained, ...]) -> str:
    """As a markdown table."""
    rows = [f"| `{e.name}` | {e.value} | {e.unit} | {e.reason} |" for e in explained]
    return "\n".join(["| parameter | value | unit | reason |", "|---|---|---|---|", *rows]) + "\n"


def _walked(config: Any, path: str) -> Iterator[Explained]:
    for f in fields(config):
        name, value = f"{path}{f.name}", getattr(config, f.name)
        if isinstance(value, Hints):
            continue
        if is_dataclass(value):
            yield from _walked(value, f"{name}.")
            continue
        reason = _reasons(type(config)).get(f.name, "")
        unit = next((u for ending, u in UNITS.items() if f.name.endswith(ending)), "A" if "[A]" in reason else "")
        shown = np.degrees(value) if unit.startswith("rad") else np.asarray(value)
        text = " to ".join(f"{v:.4g}" for v in np.atleast_1d(shown).tolist())
        yield Explained(name, text, unit.replace("rad", "deg") if unit.startswith("rad") else unit, reason)


def _reasons(of: type) -> dict[str, str]:
    """The text below each field."""
    (tree,) = ast.parse(textwrap.dedent(inspect.getsource(of))).body
    assert isinstance(tree, ast.ClassDef)
    found = {}
    for at, below in zip(tree.body, tree.body[1:], strict=False):
        text = below.value.value if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant) else None
        if isinstance(at, ast.AnnAssign) and isinstance(at.target, ast.Name) and isinstance(text, str):
            found[at.target.id] = " ".join(text.split())
    return found


def read_settings(config: Path | None, hints: Path | None, said: Sequence[str]) -> LearnConfig:
    """The settings of ``--config``, with the hints of ``--hints`` and of every ``--hint KEY=VALUE`` over its own.

    Raises
    ------
    InputError
        If a file or a hint cannot be read.
    """
    settings = read_config(config) if config is not None else LearnConfig()
    document = settings.hints.document()
    if hints is not None:
        document = merged(document, read_toml(hints))
    for text in said:
        key, equals, value = text.partition("=")
        if not equals or not key.strip():
            raise InputError(f"--hint '{text}': expected KEY=VALUE, such as joints.block=free or leave_out.objects=[\"lamp\"]")
        try:
            table = parse_toml(
                f"{key} = {value if value[:1] in list('[{') else json.dumps(value)}", f"--hint '{shown(text, 80)}'"
            )
        except FormatError as error:
            raise InputError(str(error)) from None
        document = merged(document, table)
    return replace(settings, hints=Hints.of(document))


def derived(demos: Sequence[Demo]) -> tuple[str, ...]:
    """What is not set but measured: a line each."""
    from symskill_pddl.learning.scale import aperture_of

    rates = sorted({round(1.0 / float(np.median(np.diff(d.times)))) for d in demos})
    return (f"the hand opens {100 * aperture_of(demos):.1f} cm wide (A), the recordings have {' and '.join(map(str, rates))} Hz",)
