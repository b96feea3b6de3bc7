"""The kinematics of a recorded MuJoCo model: bodies, joints, inertias, sites and primitive shapes, and nothing else of its XML.

A model's XML may include files, name meshes, textures and plugins, and multiply parts. A recording carries its whole model, and
only where its bodies are matters here: what is read is listed, all else is left out before MuJoCo sees the text, and what would
change the bodies themselves (`include`, `attach`, `replicate`, ...) is refused. MuJoCo opens no file.
"""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from typing import Any, NoReturn
from xml.parsers import expat

from symskill_pddl.errors import FormatError, UnsafeError, shown

LONGEST, DEEPEST, MOST_ELEMENTS = 64_000_000, 200, 200_000

_FRAME = {"pos", "quat", "axisangle", "xyaxes", "zaxis", "euler"}
_COMMON = {"name", "class"}
_KEPT: dict[str, set[str]] = {
    "compiler": {
        "angle",
        "autolimits",
        "coordinate",
        "eulerseq",
        "fusestatic",
        "inertiafromgeom",
        "inertiagrouprange",
        "settotalmass",
    },
    "default": {"class"},
    "body": {"name", "childclass", "mocap", "gravcomp", *_FRAME},
    "frame": {"name", "childclass", *_FRAME},
    "inertial": {"mass", "diaginertia", "fullinertia", *_FRAME},
    "joint": {*_COMMON, "type", "group", "pos", "axis", "range", "limited", "ref", "springref", "armature", "damping", "margin"},
    "freejoint": {"name", "group", "align"},
    "geom": {*_COMMON, "type", "contype", "conaffinity", "group", "size", "fromto", "mass", "density", "margin", "gap", *_FRAME},
    "site": {*_COMMON, "type", "group", "size", "fromto", *_FRAME},
}
"""Elements that are read, and of each the attributes."""
_INSIDE = {
    "mujoco": {"compiler", "default", "worldbody"},
    "default": {"default", "joint", "geom", "site"},
    "worldbody": {"body", "frame", "joint", "freejoint", "inertial", "geom", "site"},
}
_INSIDE["body"] = _INSIDE["frame"] = _INSIDE["worldbody"]
_REFUSED = {"include", "attach", "replicate", "composite", "flexcomp"}
"""They would make bodies of what does not stand there."""
_TEXTS = {"name", "class", "childclass"}
_NO_NUMBER = re.compile(r"(?i)\b[+-]?(nan|inf|infinity)\b")
_ASSET_GEOMS = ("mesh", "hfield", "sdf")


def kinematic_xml(xml: str) -> tuple[str, frozenset[str]]:
    """The model without anything that needs an asset, and the names of the bodies that had a shape to touch before.

    Raises
    ------
    FormatError
        If the text is not XML, or is not a MuJoCo model.
    UnsafeError
        If it includes what does not stand in it.
    """
    root = _parsed(xml)
    if root.tag != "mujoco" or root.find("worldbody") is None:
        raise FormatError(
            f"the model is not a MuJoCo model: its root is <{shown(root.tag, 40)}>, expected <mujoco> with a <worldbody>"
        )
    if found := next((e.tag for e in root.iter() if e.tag in _REFUSED), None):
        raise UnsafeError(f"the model has <{found}>: a recorded model has to carry all its bodies itself")
    shaped = frozenset(body.get("name", "") for body in root.iter("body") if any(map(_collides, body.findall("geom"))))
    kept = ET.Element("mujoco")
    _copy_inside(root, kept)
    # a link that lost its meshes may have no mass left; kinematics does not care, the compiler does
    compiler = ET.SubElement(kept, "compiler")
    compiler.attrib |= {"boundmass": "0.001", "boundinertia": "0.000001", "balanceinertia": "true"}
    return ET.tostring(kept, encoding="unicode"), shaped


def _copy_inside(there: ET.Element, here: ET.Element) -> None:
    for child in there:
        if child.tag not in _INSIDE.get(there.tag, ()):
            continue
        if child.tag == "geom" and (child.get("type") in _ASSET_GEOMS or child.get("mesh") is not None):
            continue
        allowed = _KEPT.get(child.tag, set())
        copy = ET.SubElement(here, child.tag, {key: value for key, value in child.attrib.items() if key in allowed})
        # MuJoCo would print a warning, and write it into a file where we run
        if bad := next((k for k, v in copy.attrib.items() if k not in _TEXTS and _NO_NUMBER.search(v)), None):
            raise FormatError(f"the model's <{child.tag}> has a '{bad}' that is no number")
        _copy_inside(child, copy)


def _collides(geom: ET.Element) -> bool:
    return geom.get("contype", "1") != "0" or geom.get("conaffinity", "1") != "0"


def _parsed(xml: str) -> ET.Element:
    """The document, which declares no entities and is neither very long nor very deep."""
    if len(xml) > LONGEST:
        raise FormatError(f"the model is longer than {LONGEST} characters")
    builder = ET.TreeBuilder()
    depth = count = 0

    def start(tag: str, attributes: dict[str, str]) -> None:
        nonlocal depth, count
        depth, count = depth + 1, count + 1
        if depth > DEEPEST or count > MOST_ELEMENTS:
            raise FormatError(f"the model has more than {MOST_ELEMENTS} elements, or {DEEPEST} within one another")
        builder.start(tag, attributes)

    def end(tag: str) -> None:
        nonlocal depth
        depth -= 1
        builder.end(tag)

    def refuse(*_: Any) -> NoReturn:
        raise UnsafeError("the model has a document type declaration, which no model needs")

    parser = expat.ParserCreate()
    parser.StartElementHandler, parser.EndElementHandler, parser.StartDoctypeDeclHandler = start, end, refuse
    try:
        parser.Parse(xml, True)
    except expat.ExpatError as error:
        raise FormatError(f"the model is not well-formed XML: {error}") from None
    except UnicodeEncodeError:
        raise FormatError("the model holds a text that is no Unicode") from None
    return builder.close()
