"""The table of disturbances. A new one is a new line."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from math import inf, radians
from typing import TYPE_CHECKING

from numpy.random import Generator

from symskill_pddl.kitchen import layout
from symskill_pddl.kitchen.disturbances.hand import drop, obstacle, push
from symskill_pddl.kitchen.disturbances.kind import Arguments, Doing, Kind, periods
from symskill_pddl.kitchen.disturbances.sight import freeze, noise
from symskill_pddl.kitchen.disturbances.things import close, move_plate, put_lid_back, shift

if TYPE_CHECKING:
    from symskill_pddl.kitchen.world import Kitchen

_MOST_S = 5.0


def any_of_them(kitchen: Kitchen, _: Arguments, rng: Generator) -> Doing | None:
    """One of all that are possible now, drawn, with its defaults; for a few seconds at most."""
    objects = kitchen.observe().objects
    names = [name for name, kind in KINDS.items() if name != ANY and not kind.lacks(objects)]
    for name in rng.permutation(names).tolist():
        effect = KINDS[name].effect(kitchen, Arguments(KINDS[name].defaults), rng)
        if effect is not None:
            kitchen.note(name)
            return _for_a_while(kitchen, effect)
    return None


def _for_a_while(kitchen: Kitchen, effect: Doing) -> Doing:
    with closing(effect):
        for _ in periods(kitchen, _MOST_S):
            if next(effect, kitchen) is kitchen:
                return
            yield


def _about(*types: str) -> Callable[[tuple[str, ...]], bool]:
    """Whether a task is about a loose thing of these types, or of any."""
    names = {name for scene in layout.SCENES.values() for name, thing in scene.loose.items() if not types or thing.type in types}
    return lambda focus: not names.isdisjoint(focus)


def _closes(name: str, part: layout.Part) -> Kind:
    """Shutting a part: strong enough for its friction fifteen times over. It concerns tasks about the part or its unit."""
    effort = {"Nm" if part.joint == "hinge" else "N": 15.0 * part.friction, "s": 5.0}
    return Kind(close(name), effort, part=name, concerns=lambda focus: name in focus or part.unit in focus)


ANY = "any"
KINDS: dict[str, Kind] = {
    **{f"close-{name}": _closes(name, part) for name, part in layout.PARTS.items()},
    "drop": Kind(drop, {"s": 0.5}, concerns=_about()),
    "shift": Kind(shift, {"m": 0.05}, nameable=True, concerns=_about()),
    "move-plate": Kind(move_plate, {"m": 0.1}, needs=("container",), nameable=True, concerns=_about("container")),
    "put-lid-back": Kind(put_lid_back, needs=("lid", "cookware"), concerns=_about("lid")),
    "push": Kind(push, {"N": 20.0, "s": 0.5}),
    layout.OBSTACLE: Kind(obstacle, {"m": 0.18, "s": 5.0}, adds={layout.OBSTACLE: layout.OBSTACLE}),
    "freeze": Kind(freeze, {"s": 3.0}, nameable=True),
    "noise": Kind(noise, {"m": 0.005, "rad": radians(2.0), "s": inf}),
    ANY: Kind(any_of_them, adds={layout.OBSTACLE: layout.OBSTACLE}),
}
