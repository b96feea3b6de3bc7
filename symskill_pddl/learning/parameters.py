"""Every parameter of learning with its value, unit and reason, read from the configurations themselves.

The unit is the ending of the name; the reason is the text below the field.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

import numpy as np

from symskill_pddl.learning.learn import LearnConfig

UNITS = {"_m_s": "m/s", "_rad_s": "rad/s", "_m_rad": "m/rad", "_m": "m", "_rad": "rad", "_s": "s"}


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
        if is_dataclass(value):
            yield from _walked(value, f"{name}.")
            continue
        unit = next((u for ending, u in UNITS.items() if f.name.endswith(ending)), "")
        shown = np.degrees(value) if unit.startswith("rad") else np.asarray(value)
        text = " to ".join(f"{v:.4g}" for v in np.atleast_1d(shown).tolist())
        yield Explained(
            name, text, unit.replace("rad", "deg") if unit.startswith("rad") else unit, _reasons(type(config)).get(f.name, "")
        )


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
