"""Plans as text: written plainly, and read from what planners print, strictly in what they mean.

`printed` finds the plans; here every step has to be a known action with known objects of the right number and types. Of several
plans the last counts, for planners that print several print better and better ones; `remarks` say so.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

from symskill_pddl.errors import InputError, ParseError
from symskill_pddl.pddl.printed import Block, blocks, together
from symskill_pddl.symbols import Domain, Plan

Check = Callable[[str, tuple[str, ...]], object]
"""Raises `InputError` where an action does not exist or cannot take these arguments."""


@dataclass(frozen=True)
class Read:
    """A plan and what is to be said of it."""

    plan: Plan
    remarks: tuple[str, ...] = ()


def write_plan(plan: Plan) -> str:
    """One step a line, with its time where the plan has times, and the cost as a last comment where it is known."""
    lines = ["(" + " ".join((name, *args)) + ")" for name, args in plan.steps]
    if plan.times is not None:
        timed = zip(lines, plan.times, strict=True)
        lines = [f"{_time(start)}: {line}" + ("" if length is None else f" [{_time(length)}]") for line, (start, length) in timed]
    if plan.cost is not None:
        lines.append(f"; cost = {plan.cost:g}")
    return "".join(line + "\n" for line in lines)


def _time(seconds: float) -> str:
    """In microseconds, with three places at least: what planners keep apart has to stay apart."""
    whole, _, fraction = f"{seconds:.6f}".partition(".")
    return f"{whole}.{fraction[:3]}{fraction[3:].rstrip('0')}"


def read_plan(text: str, domain: Domain, objects: Mapping[str, str], source: str = "<plan>") -> Plan:
    """Parse a plan of a domain of ours; of several, the last.

    Parameters
    ----------
    objects : mapping of str to str
        Object name to type. Names are matched without regard to case.

    Raises
    ------
    ParseError
        With the line: there is no plan, or a step is malformed, unknown or ill-typed.
    """
    return read_plans(text, domain, objects, source)[-1].plan


def read_plans(text: str, domain: Domain, objects: Mapping[str, str], source: str = "<plan>") -> tuple[Read, ...]:
    """Every plan in a text, in its order; raises as `read_plan`."""

    def check(name: str, args: tuple[str, ...]) -> object:
        return domain.ground(domain.operator(name), args, objects)

    return printed_plans(text, [o.name for o in domain.operators], list(objects), check, source)


def printed_plans(
    text: str, actions: Collection[str], objects: Collection[str], check: Check, source: str = "<plan>", *, timed: bool = False
) -> tuple[Read, ...]:
    """Every plan in a text, in its order; raises `ParseError` as `read_plan`, where the last of them is not in order.

    `timed` says that actions take time and may do so together.
    """
    named, spelled = {a.lower(): a for a in actions}, {o.lower(): o for o in objects}
    found = blocks(text, named.keys(), source)
    read: list[Read] = []
    for i, block in enumerate(found):
        last = i + 1 == len(found)
        try:
            plan = _plan(block, named, spelled, check, source)
        except ParseError:
            if last:
                raise
            continue
        said = [f"of {len(found)} plans in {source} this is number {i + 1}"] if len(found) > 1 else []
        same = next(together(block.lines), None) if block.clock and not timed else None
        if same is not None:
            one, other = same
            said.append(
                f"the steps on the lines {one.at[0]} and {other.at[0]} of {source} start at the same time, {one.start:g}: "
                "their order is that of the lines, not of the times"
            )
        read.append(Read(plan, tuple(said)))
    return tuple(read)


def _plan(block: Block, named: Mapping[str, str], spelled: Mapping[str, str], check: Check, source: str) -> Plan:
    steps = []
    for i, line in enumerate(block.lines):
        name, args = named.get(line.words[0], line.words[0]), tuple(spelled.get(w, w) for w in line.words[1:])
        try:
            check(name, args)
        except InputError as error:
            raise ParseError(str(error), source=source, line=line.at[0], column=line.at[1]) from None
        steps.append((line.start if line.start is not None else float(i), i, line, (name, args)))
    steps.sort(key=lambda s: s[:2])  # a temporal plan may list its steps in any order
    timed = block.clock and all(line.start is not None for line in block.lines)
    times = tuple((start, line.length) for start, _, line, _ in steps) if timed else None
    return Plan(tuple(step for *_, step in steps), block.cost, times)
