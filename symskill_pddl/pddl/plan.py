"""Plans as text: the formats that planners print, read strictly.

A step is ``(operator object ...)`` on a line of its own, in any case. Tolerated around it: a time before (``0.000:``), a duration
after (``[1.0]``), a comment, blank lines. A line ``; cost = 3 (unit cost)`` gives the cost.
Anything else is an error with its line.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from symskill_pddl.errors import InputError, ParseError
from symskill_pddl.symbols import Domain, Plan

_COST = re.compile(r";\s*cost\s*=\s*([0-9.]+)", re.IGNORECASE)
_STEP = re.compile(r"(?:([0-9]+(?:\.[0-9]*)?)\s*:)?\s*\(([^()]*)\)\s*(?:\[\s*([0-9]+(?:\.[0-9]*)?)\s*\]\)?)?")


def write_plan(plan: Plan) -> str:
    """One step a line, and the cost as a last comment where it is known."""
    lines = ["(" + " ".join((name, *args)) + ")" for name, args in plan.steps]
    if plan.cost is not None:
        lines.append(f"; cost = {plan.cost:g}")
    return "".join(line + "\n" for line in lines)


def step_lines(output: str, domain: Domain) -> str:
    """The lines of a program's output that are steps of known operators, for `read_plan`; everything else is talk."""
    known = {op.name.lower() for op in domain.operators}
    kept = []
    for line in output.splitlines():
        match = _STEP.fullmatch(line.partition(";")[0].strip())
        if match and match[2].lower().split()[:1] and match[2].lower().split()[0] in known:
            kept.append(line)
    return "".join(line + "\n" for line in kept)


def read_plan(text: str, domain: Domain, objects: Mapping[str, str], source: str = "<plan>") -> Plan:
    """Parse a plan; every step has to be a known operator with known objects of the right number and types.

    Parameters
    ----------
    objects : mapping of str to str
        Object name to type. Names are matched without regard to case.

    Raises
    ------
    ParseError
        With the line: not a step, or an unknown or ill-typed one.
    """
    spelled = {name.lower(): name for name in objects}
    operators = {op.name.lower(): op.name for op in domain.operators}
    steps: list[tuple[float, int, tuple[str, tuple[str, ...]]]] = []
    cost: float | None = None
    for number, line in enumerate(text.splitlines(), start=1):
        if match := _COST.match(line.strip()):
            cost = float(match[1])
        code = line.partition(";")[0].strip()
        if not code:
            continue
        match = _STEP.fullmatch(code)
        column = line.index(code[0]) + 1
        if match is None:
            raise ParseError(
                f"expected a step like '(pick apple table)', got '{code}'", source=source, line=number, column=column
            )
        words = match[2].lower().split()
        if not words:
            raise ParseError("expected an operator's name, got '()'", source=source, line=number, column=column)
        name, args = operators.get(words[0], words[0]), tuple(spelled.get(word, word) for word in words[1:])
        try:
            domain.ground(domain.operator(name), args, objects)
        except InputError as error:
            raise ParseError(str(error), source=source, line=number, column=column) from None
        steps.append((float(match[1]) if match[1] else float(len(steps)), len(steps), (name, args)))
    timed = sorted(steps, key=lambda s: s[:2])  # a temporal plan may list its steps in any order
    return Plan(tuple(step for _, _, step in timed), cost)
