"""The asset pack, written for a package folder of a few files that the test makes; with RoboCasa itself in test_kitchens.py."""

import hashlib
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.robocasa import asset_models as models
from symskill_pddl.robocasa.assets import DISHES, SOLIDS, WORKING, robocasa_folder, write_pack

STOVES = "default:\n  xml: fixtures/stoves/Stove001\nB:\n  xml: fixtures/stoves/B\n"
CATEGORIES = """
import os
OBJ_CATEGORIES = dict(
    apple=dict(types=("fruit"), objaverse=dict(scale=0.9, exclude=["a"] + ["b"]), aigen=dict(scale=1.0)),
    bar=dict(types=("packaged_food", "sweets"), objaverse=dict(scale=[0.75, 0.75, 1.2])),
    pan=dict(types=("receptacle"), objaverse=dict(scale=1.7)),
    saucepan=dict(types=("receptacle"), objaverse=dict(model_folders=["objaverse/pan"]), lightwheel=dict()),
    lid=dict(types=("lid"), lightwheel=dict(model_folders=["lightwheel/saucepan"], is_auxiliary_obj=True)),
    ham=dict(types=("meat"), aigen=dict(scale=1.5)),
)
"""


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A folder laid out as RoboCasa's package is."""
    files = {
        "models/objects/kitchen_objects.py": CATEGORIES,
        "models/assets/scenes/kitchen_layouts/test/layout001.yaml": "room: {}\n",
        "models/assets/fixtures/fixture_registry/stove.yaml": STOVES,
        "models/assets/fixtures/fixture_registry/hood.yaml": "default:\n  xml: fixtures/hoods/flat.xml\n",
        "models/assets/fixtures/fixture_registry/wall.yaml": "default:\n  texture: textures/bricks/red_bricks.png\n",
        "models/assets/fixtures/cabinets/drawer.xml": '<texture file="../../textures/ceramic.png"/>',
        "models/fixtures/cabinet_panels.py": 'HANDLES = {"x": "fixtures/handles/X/model.xml"}\n',
        "models/fixtures/cabinets.py": 'PANELS = {"y": "fixtures/cabinets/cabinet_panels/Y/model.xml"}\n',
        "models/fixtures/windows.py": 'W = "generative_textures/wall/tex001.png"\n',
    }
    for name, text in files.items():
        (tmp_path / "robocasa" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "robocasa" / name).write_text(text)
    return tmp_path / "robocasa"


def contents(root: Path) -> dict[str, str]:
    return {str(f.relative_to(root)): hashlib.sha256(f.read_bytes()).hexdigest() for f in sorted(root.rglob("*")) if f.is_file()}


def test_every_named_file_is_there_and_the_rest_is_linked(package: Path, tmp_path: Path) -> None:
    root = tmp_path / "pack"
    assert 0 < write_pack(root, package) < 200_000
    expected = [
        "fixtures/stoves/Stove001/model.xml", "fixtures/stoves/B/model.xml", "fixtures/hoods/flat.xml",
        "fixtures/handles/X/model.xml", "fixtures/cabinets/cabinet_panels/Y/model.xml", "textures/bricks/red_bricks.png",
        "textures/ceramic.png", "generative_textures/wall/tex001.png", "scenes/kitchen_layouts/test/layout001.yaml",
    ]  # fmt: skip
    assert [name for name in expected if not (root / name).is_file()] == []
    assert (root / "fixtures/stoves/B/model.xml").read_text() == models.stove()
    assert (root / "scenes/kitchen_layouts/test/layout001.yaml").resolve().is_relative_to(package)


def test_one_model_for_each_category_that_is_sampled(package: Path, tmp_path: Path) -> None:
    write_pack(tmp_path / "pack", package)
    found = sorted(
        str(f.parent.relative_to(tmp_path / "pack" / "objects")) for f in (tmp_path / "pack").glob("objects/**/model.xml")
    )
    # ham is of a registry nobody asks for; the saucepan has its own folder rather than the pan's; lids are one folder deeper
    assert found == [
        "lightwheel/saucepan/lid_primitive/lid",
        "lightwheel/saucepan/saucepan_primitive",
        "objaverse/apple/apple_primitive",
        "objaverse/bar/bar_primitive",
        "objaverse/pan/pan_primitive",
    ]


def test_the_same_bytes_again_and_over_an_earlier_pack(package: Path, tmp_path: Path) -> None:
    write_pack(tmp_path / "a", package)
    write_pack(tmp_path / "b", package)
    write_pack(tmp_path / "b", package)
    assert contents(tmp_path / "a") == contents(tmp_path / "b")


def test_a_folder_of_something_else_is_left_alone(package: Path, tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "file").write_text("x")
    with pytest.raises(InputError, match="not an asset pack and not empty"):
        write_pack(tmp_path / "mine", package)
    assert (tmp_path / "mine" / "file").read_text() == "x"


def test_another_version_of_robocasa_says_so(package: Path, tmp_path: Path) -> None:
    (package / "models/objects/kitchen_objects.py").write_text("X = 1\n")
    with pytest.raises(MissingDependencyError, match="another version"):
        write_pack(tmp_path / "pack", package)


def test_no_robocasa_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("symskill_pddl.robocasa.assets.find_spec", lambda name: None)
    with pytest.raises(MissingDependencyError, match="make robocasa"):
        robocasa_folder()


def built(text: str) -> tuple[mujoco.MjModel, ET.Element]:
    return mujoco.MjModel.from_xml_string(text), ET.fromstring(text)


@pytest.mark.parametrize("name", [*WORKING, *SOLIDS])
def test_fixtures_compile_and_have_what_robocasa_looks_for(name: str) -> None:
    model, tree = built(WORKING[name]() if name in WORKING else models.solid(name, SOLIDS[name], models.STEEL))
    assert tree.find("./worldbody/body/body[@name='object']") is not None
    assert mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_GEOM, "reg_main") >= 0
    assert all(geom.get("group") in ("0", "1") for geom in tree.iter("geom"))


@pytest.mark.parametrize("kind", [models.stove, models.stovetop])
def test_every_burner_has_a_knob_a_hand_can_take(kind: Callable[[], str]) -> None:
    model, tree = built(kind())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    top = model.geom("body").size[2]
    for burner in models.BURNERS:
        assert tree.find(f"./worldbody/body/body/body/joint[@name='knob_{burner}_joint']") is not None
        assert tree.find(f"./worldbody/body/body/site[@name='burner_on_{burner}']") is not None
        joint, ridge = model.joint(f"knob_{burner}_joint"), model.geom(f"knob_{burner}_ridge")
        np.testing.assert_allclose(data.xaxis[joint.id], [0.0, 0.0, 1.0])
        assert joint.range[0] == 0.0
        assert 0.35 < joint.range[1] < np.pi
        assert ridge.size[0] <= 0.02
        assert data.geom_xpos[ridge.id][2] - ridge.size[2] > top + 0.005
        assert (
            np.linalg.norm(data.site_xpos[model.site(f"burner_{burner}_place_site").id][:2] - data.geom_xpos[ridge.id][:2]) > 0.15
        )
    assert not mujoco.MjData(model).ncon


def test_a_knob_stays_where_it_is_left() -> None:
    model, _ = built(models.stove())
    data = mujoco.MjData(model)
    data.qpos[:] = 0.6
    mujoco.mj_step(model, data, 1000)
    np.testing.assert_allclose(data.qpos, 0.6, atol=0.01)


def test_the_lever_turns_about_the_upright_and_stays() -> None:
    model, tree = built(models.sink())
    for path in ("body/joint[@name='handle_joint']", "body/site[@name='water']", "body/joint[@name='spout_joint']"):
        assert tree.find(f"./worldbody/body/body/{path}") is not None
    data = mujoco.MjData(model)
    lever = model.joint("handle_joint")
    data.qpos[lever.qposadr] = 0.41
    mujoco.mj_step(model, data, 1000)
    np.testing.assert_allclose(data.qpos[lever.qposadr], 0.41, atol=0.005)
    np.testing.assert_allclose(data.xaxis[lever.id], [0.0, 0.0, 1.0])
    assert lever.range[1] > 0.6


def boxes(text: str, scale: float) -> list[np.ndarray]:
    return [
        scale * np.array(geom.get("size", "").split(), float)
        for geom in ET.fromstring(text).iter("geom")
        if geom.get("group") == "0"
    ]


@pytest.mark.parametrize("scale", [0.75, 1.0, 1.7])
def test_dishes_are_thick_whatever_they_are_scaled_by(scale: float) -> None:
    radius, height, mass, grip = DISHES["pan"]
    text = models.dish("pan", scale, radius, height, models.DARK, mass, grip)
    built(text)
    parts = boxes(text, scale)
    assert len(parts) == 10
    assert min(2 * part.min() for part in parts) > 0.0075
    region = ET.fromstring(text).find(".//geom[@name='reg_bbox']")
    assert region is not None
    low, high = (
        scale * (np.array(region.get("pos", "").split(), float) + sign * np.array(region.get("size", "").split(), float))
        for sign in (-1, 1)
    )
    np.testing.assert_allclose(low, [-radius, -radius - grip, 0.0], atol=1e-4)
    np.testing.assert_allclose(high, [radius, radius, height], atol=1e-4)


LARGEST_SCALE = 1.2
"""RoboCasa's, of the categories whose folders accessories lie in."""


@pytest.mark.parametrize(
    "name", ["candle", "cinnamon", "glass_cup", "jar", "oil_bottle", "paprika", "salt_shaker", "soap_dispenser"]
)
def test_accessories_that_are_sampled_as_objects_can_be_held_too(name: str) -> None:
    model, _ = built(models.solid(name, SOLIDS[name], models.STEEL))
    assert 0.02 < LARGEST_SCALE * SOLIDS[name][0] <= 0.06
    assert 0.05 <= model.body_mass.sum() <= 0.2


def test_what_is_held_is_narrow_enough_and_weighs_50_to_200_g(package: Path, tmp_path: Path) -> None:
    write_pack(tmp_path / "pack", package)
    for name, scale in (("apple", (0.9, 0.9, 0.9)), ("bar", (0.75, 0.75, 1.2))):
        text = (tmp_path / "pack" / f"objects/objaverse/{name}/{name}_primitive/model.xml").read_text()
        model, tree = built(text)
        geom = tree.find(".//geom[@name='main']")
        assert geom is not None
        size = np.array(geom.get("size", "").split(), float)
        assert 0.02 < 2 * size[0] * scale[0] <= 0.06
        assert 0.05 <= model.body_mass.sum() <= 0.2
