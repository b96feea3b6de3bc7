"""A small asset pack of our own, with which RoboCasa's kitchens build without its ten gigabytes of meshes and photographs.

RoboCasa's package brings its layouts, styles, cabinets, drawers and counters; the meshes of sinks, stoves, appliances, food and
dishes, and all textures, come from a download. The pack is a root for ``ROBOCASA_ASSETS_PATH``: it links to what the installed
package has, and puts a model of primitive shapes (`asset_models`) or a flat colour wherever the package names a file that is not
there. Nothing of RoboCasa is copied, and RoboCasa is not imported: its object categories are read from its source.
"""

from __future__ import annotations

import ast
import os
import re
import shutil
import struct
import zlib
from collections.abc import Iterator, Mapping
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.robocasa import asset_models as models
from symskill_pddl.robocasa.asset_models import Vec3

MARKER = "symskill-assets.txt"
"""A file in the root that says whose it is; only a folder with it, or an empty one, is written to."""

SOLIDS: Mapping[str, Vec3] = {
    "blender": (0.2, 0.2, 0.4), "blender_lid": (0.12, 0.12, 0.03), "candle": (0.05, 0.05, 0.115), "cinnamon": (0.05, 0.05, 0.13),
    "digital_scale": (0.15, 0.2, 0.03), "dish_rack": (0.4, 0.3, 0.18),
    "dishwasher": (0.65, 0.6, 0.89), "electric_kettle": (0.2, 0.16, 0.24), "flower_vase": (0.15, 0.15, 0.4),
    "fridge_bottom_freezer": (0.78, 0.8, 1.75), "fridge_french_door": (0.85, 0.8, 1.78), "fridge_side_by_side": (0.85, 0.8, 1.75),
    "fruit_bowl": (0.28, 0.28, 0.12), "glass_cup": (0.05, 0.05, 0.067), "hood": (0.76, 0.6, 0.3), "jar": (0.05, 0.05, 0.07),
    "jar_lid": (0.1, 0.1, 0.02), "knife_block": (0.12, 0.18, 0.24), "oil_bottle": (0.05, 0.05, 0.15), "oven": (0.75, 0.6, 0.68),
    "paper_towel": (0.15, 0.15, 0.33), "paprika": (0.05, 0.05, 0.12), "pepper_shaker": (0.045, 0.045, 0.1),
    "plant": (0.16, 0.16, 0.24), "salt_shaker": (0.045, 0.045, 0.1), "soap_dispenser": (0.05, 0.05, 0.143),
    "stand_mixer": (0.2, 0.33, 0.33), "stool": (0.4, 0.4, 1.0), "tiered_basket": (0.3, 0.25, 0.3), "toaster": (0.28, 0.17, 0.19),
    "turmeric": (0.05, 0.05, 0.15), "utensil_rack": (0.3, 0.05, 0.32), "utensil_set": (0.14, 0.14, 0.35),
    "vinegar_bottle": (0.05, 0.05, 0.15), "wall_accessory": (0.08, 0.01, 0.12), "window": (1.0, 0.05, 1.0),
}  # fmt: skip
"""Width, depth and height of what only stands there, by RoboCasa's type of fixture [m]; styles scale it to their own size.

Jars, bottles, shakers and the like lie in folders that RoboCasa samples things to hold from, too: a hand can hold them as stored.
"""

WORKING = {
    "sink": models.sink, "stove": models.stove, "stove_wide": models.stove, "stovetop": models.stovetop,
    "microwave": models.microwave, "toaster_oven": models.toaster_oven,
    "coffee_machine": models.coffee_machine,
}  # fmt: skip
"""Fixtures that move, or whose parts RoboCasa asks for in every step."""

DISHES: Mapping[str, tuple[float, float, float, float]] = {
    "pan": (0.115, 0.045, 0.9, 0.14), "saucepan": (0.09, 0.08, 0.8, 0.14), "pot": (0.1, 0.1, 1.0, 0.0),
    "kettle_non_electric": (0.08, 0.12, 0.8, 0.0), "plate": (0.1, 0.02, 0.3, 0.0), "bowl": (0.085, 0.055, 0.3, 0.0),
    "colander": (0.11, 0.09, 0.3, 0.0), "strainer": (0.08, 0.05, 0.2, 0.0), "basket": (0.13, 0.1, 0.3, 0.0),
    "tray": (0.15, 0.03, 0.5, 0.0), "oven_tray": (0.15, 0.03, 0.5, 0.0), "baking_sheet": (0.15, 0.02, 0.5, 0.0),
    "tupperware": (0.08, 0.06, 0.2, 0.0),
}  # fmt: skip
"""Radius, height [m], mass [kg] and length of the handle [m] of what holds food."""

FLAT = ("cutting_board", "placemat", "digital_scale", "pizza", "pancake", "scissors", "bottle_opener", "can_opener")
LONG = ("utensil", "tool")
UPRIGHT = ("drink", "alcohol", "condiment", "packaged_food", "cleaner", "spice")

PALETTE: tuple[tuple[str, tuple[int, int, int]], ...] = (
    ("white", (236, 236, 230)), ("black", (35, 35, 38)), ("dark_gray", (80, 82, 86)), ("gray", (150, 152, 155)),
    ("green", (150, 172, 142)), ("blue", (96, 118, 150)), ("dark_wood", (92, 66, 48)), ("wood", (168, 128, 90)),
    ("brick", (176, 120, 100)), ("marble", (218, 216, 212)), ("metal", (172, 175, 180)), ("brass", (180, 150, 90)),
    ("tile", (200, 196, 188)), ("wall", (224, 218, 206)), ("floor", (150, 126, 100)), ("cabinet", (205, 198, 184)),
)  # fmt: skip
"""A texture has the colour of the first word that its name contains."""


def robocasa_folder() -> Path:
    """Folder of the installed package, which is not imported.

    Raises
    ------
    MissingDependencyError
        There is none.
    """
    spec = find_spec("robocasa")
    # without an origin it is a folder that happens to be called so
    if spec is None or spec.origin is None or not spec.submodule_search_locations:
        raise MissingDependencyError("RoboCasa is not installed in this environment: `make robocasa` builds one that has it")
    return Path(next(iter(spec.submodule_search_locations)))


def write_pack(root: Path, package: Path | None = None) -> int:
    """Write the asset pack; what an earlier call wrote there is replaced. The same bytes every time.

    Parameters
    ----------
    root : Path
        Folder to write, new, empty or an earlier pack.
    package : Path, optional
        RoboCasa's folder; by default the installed one's.

    Returns
    -------
    int
        Bytes written, links not counted.

    Raises
    ------
    InputError
        `root` is a folder of something else.
    MissingDependencyError
        RoboCasa is not installed.
    """
    package = package or robocasa_folder()
    if root.exists() and any(root.iterdir()) and not (root / MARKER).is_file():
        raise InputError(f"{root}: not an asset pack and not empty; name a new folder")
    shutil.rmtree(root, ignore_errors=True)
    root.mkdir(parents=True)
    bundled = package / "models" / "assets"
    for file in _files(bundled):
        _link(file, root / file.relative_to(bundled))
    written = {MARKER: b"Flat colours and primitive shapes for RoboCasa, written by symskill-pddl. Safe to delete.\n"}
    written |= {f"primitives/{name}.xml": text.encode() for name, text in _primitives().items()}
    written |= {f"primitives/{name}.png": _png(rgb) for name, rgb in PALETTE}
    written |= {path: text.encode() for path, text in _objects(package)}
    for path, content in sorted(written.items()):
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_bytes(content)
    for path, primitive in sorted((_fixture_models(package) | _textures(package)).items()):
        if not (root / path).exists():
            (root / path).parent.mkdir(parents=True, exist_ok=True)
            (root / path).symlink_to(os.path.relpath(root / "primitives" / primitive, (root / path).parent))
    return sum(len(content) for content in written.values())


def _files(folder: Path) -> list[Path]:
    return sorted(file for file in folder.rglob("*") if file.is_file())


def _link(file: Path, at: Path) -> None:
    at.parent.mkdir(parents=True, exist_ok=True)
    at.symlink_to(file)


def _primitives() -> dict[str, str]:
    """Models that many paths lead to, by name."""
    colour = {"hood": models.STEEL, "oven": models.STEEL, "dishwasher": models.STEEL}
    made = {name: models.solid(name, size, colour.get(name, "0.8 0.78 0.74 1")) for name, size in SOLIDS.items()}
    made |= {name: model() for name, model in WORKING.items()}
    return made | {"handle": models.handle(), "panel": models.panel()}


def _fixture_models(package: Path) -> dict[str, str]:
    """Which primitive each model is that the package's registries and sources name, by its path in the root."""
    found = {}
    for registry in _files(package / "models" / "assets" / "fixtures" / "fixture_registry"):
        if registry.stem in SOLIDS or registry.stem in WORKING:
            for path in re.findall(r"^\s+xml:\s*(\S+)", registry.read_text(encoding="utf-8"), re.MULTILINE):
                found[path if path.endswith(".xml") else f"{path}/model.xml"] = f"{registry.stem}.xml"
    for source, pattern, primitive in (
        ("cabinet_panels.py", r"fixtures/handles/\w+/model\.xml", "handle.xml"),
        ("cabinets.py", r"fixtures/cabinets/cabinet_panels/\w+/model\.xml", "panel.xml"),
    ):
        text = (package / "models" / "fixtures" / source).read_text(encoding="utf-8")
        found |= dict.fromkeys(re.findall(pattern, text), primitive)
    return found


def _textures(package: Path) -> dict[str, str]:
    """Which flat colour each texture is that the package names, by its path in the root."""
    found = {}
    sources = [file for file in _files(package / "models") if file.suffix in (".xml", ".yaml", ".py")]
    for file in sources:
        text = file.read_text(encoding="utf-8")
        for path in re.findall(r"(?:generative_)?textures/[\w./-]+\.png", text):
            found[path] = f"{_colour(path)}.png"
        for path in re.findall(r"file=\"((?:\.\./handles/)?visuals/[\w./-]+\.png)\"", text):
            at = os.path.normpath(file.parent / path)
            found[os.path.relpath(at, package / "models" / "assets")] = "metal.png" if "handles" in path else "wood.png"
    return found


def _colour(path: str) -> str:
    return next((word for word, _ in PALETTE if word in path), PALETTE[zlib.crc32(path.encode()) % len(PALETTE)][0])


def _png(rgb: tuple[int, int, int]) -> bytes:
    """An image of 4 by 4 pixels of one colour."""
    rows = (b"\0" + bytes(rgb) * 4) * 4
    chunks = ((b"IHDR", struct.pack(">IIBBBBB", 4, 4, 8, 2, 0, 0, 0)), (b"IDAT", zlib.compress(rows, 9)), (b"IEND", b""))
    body = b"".join(struct.pack(">I", len(data)) + tag + data + struct.pack(">I", zlib.crc32(tag + data)) for tag, data in chunks)
    return b"\x89PNG\r\n\x1a\n" + body


def _categories(package: Path) -> dict[str, Any]:
    """RoboCasa's table of object categories: a call of `dict` with literals, read without running it."""
    source = (package / "models" / "objects" / "kitchen_objects.py").read_text(encoding="utf-8")
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name) and node.targets[0].id == "OBJ_CATEGORIES":
            table: dict[str, Any] = _literal(node.value)
            return table
    raise MissingDependencyError(f"{package}: no table of object categories in it; this RoboCasa is of another version")


def _literal(node: ast.expr) -> Any:
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "dict":
        return {word.arg: _literal(word.value) for word in node.keywords if word.arg is not None and word.arg != "exclude"}
    return ast.literal_eval(node)


def _objects(package: Path) -> Iterator[tuple[str, str]]:
    """One model for each category that RoboCasa samples objects of by default, as its path in the root and its text."""
    for name, category in sorted(_categories(package).items()):
        kinds = [kind for kind in ("objaverse", "lightwheel") if kind in category]
        if not kinds:
            continue
        # some categories look into the folder of another one; then better where it has one of its own
        kind = next((kind for kind in kinds if "model_folders" not in category[kind]), kinds[0])
        options = category[kind]
        folder = options.get("model_folders", [f"{kind}/{name}"])[0]
        below = "/lid" if options.get("is_auxiliary_obj") else ""
        types = category["types"]
        text = _object(name, (types,) if isinstance(types, str) else types, options.get("scale", 1.0))
        yield f"objects/{folder}/{name}_primitive{below}/model.xml", text


def _object(name: str, types: tuple[str, ...], scale: float | list[float]) -> str:
    """What a category looks like once RoboCasa has scaled it: narrow enough for a hand, every one a little different."""
    factors = tuple(scale) if isinstance(scale, list) else (scale, scale, scale)
    if name in DISHES:
        radius, height, mass, grip = DISHES[name]
        return models.dish(name, factors[0], radius, height, "0.3 0.3 0.33 1" if grip else models.WHITE, mass, grip)
    chance = zlib.crc32(name.encode())
    u, v, w = ((chance >> shift & 255) / 255 for shift in (0, 8, 16))
    rgba = f"{0.35 + 0.6 * u:.2f} {0.3 + 0.55 * v:.2f} {0.2 + 0.4 * w:.2f} 1"
    mass = round(0.06 + 0.08 * u, 3)
    if name in FLAT:
        half = (0.06, 0.1, 0.01)
    elif any(kind in LONG for kind in types):
        half = (0.012, 0.07 + 0.02 * v, 0.012)
    elif any(kind in UPRIGHT for kind in types):
        return models.round_food(name, (0.024 + 0.005 * u) / factors[0], (0.045 + 0.02 * v) / factors[2], rgba, mass)
    else:
        half = (0.019 + 0.007 * u, 0.024 + 0.018 * v, 0.021 + 0.006 * w)
    return models.box_food(name, (half[0] / factors[0], half[1] / factors[1], half[2] / factors[2]), rgba, mass)
