"""Objects of a recorded kitchen whose task is not known: what its description names, with bodies' own frames.

An environment that somebody else wrote describes its episodes as RoboCasa's do (``ep_meta``): its things, with their categories,
and the fixtures that it is about. These, the fixtures that things were put at, and the parts of them that move are its objects.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

from symskill_pddl.demos.replay import TrackedObject, type_name
from symskill_pddl.robocasa.recorded_kitchen import mapping

_GROUP = re.compile(r"(_main)?_group(_\d+)?$")


def described_objects(objects: tuple[TrackedObject, ...], meta: Mapping[str, Any]) -> dict[TrackedObject, str]:
    """Of all that a model holds, what an episode's description names, each with its type."""
    cfgs = meta.get("object_cfgs")
    things = {str(c.get("name")): c for c in cfgs if isinstance(c, dict)} if isinstance(cfgs, list) else {}
    named = [str(name) for name in mapping(meta.get("fixture_refs")).values()]
    named += [str(mapping(c.get("placement")).get("fixture")) for c in things.values()]
    classes = mapping(meta.get("fixtures"))
    # a longer name first: parts belong to the fixture whose name theirs begins with
    fixtures = sorted(set(named), key=lambda name: (-len(name), name))
    found: dict[TrackedObject, str] = {}
    for tracked in objects:
        if tracked.name in things:
            category = mapping(things[tracked.name].get("info")).get("cat")
            found[tracked] = str(category) if category else type_name(tracked.name)
            continue
        owner = next((f for f in fixtures if tracked.name == f or tracked.name.startswith(f"{f}_")), None)
        if owner is None:
            continue
        if tracked.name == owner:
            kind = mapping(classes.get(owner)).get("cls")
            found[tracked] = str(kind).lower() if kind else type_name(_GROUP.sub("", owner))
        elif tracked.moves:
            part = type_name(tracked.name.removeprefix(f"{owner}_"))
            found[tracked] = re.sub(r"^(hinge)?(left|right)?(?=door$)", "", part)
    return {tracked: re.sub(r"\s+", "-", kind) for tracked, kind in found.items()}
