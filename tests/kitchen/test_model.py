"""Scenes as models: dishes that weigh and measure what the tables say, and meshes that have to be there."""

from dataclasses import replace

import numpy as np
import pytest

from symskill_pddl.errors import MissingDependencyError
from symskill_pddl.geometry import Pose
from symskill_pddl.kitchen import layout, model
from symskill_pddl.kitchen.loose import Lid, Loose, Mesh, Vessel, body_of
from symskill_pddl.kitchen.physics import Physics

pytestmark = pytest.mark.simulation


@pytest.mark.parametrize("scene", layout.SCENES.values(), ids=list(layout.SCENES))
def test_what_is_loose_weighs_what_the_table_says(scene):
    physics = Physics(scene)
    for name, thing in scene.loose.items():
        ears = 0.02 if isinstance(thing.shape, Vessel) and thing.shape.ears else 0.0
        assert physics.model.body(body_of(name)).mass[0] == pytest.approx(thing.mass + ears, abs=1e-6)


@pytest.mark.parametrize("name", ["pan", "lid", "red-plate", "block", "bread"])
def test_what_is_loose_is_as_high_as_the_table_says(name):
    # it stands on the counter, free, half its height above it
    physics = Physics(layout.PLAY)
    for i, other in enumerate(layout.PLAY.loose):
        physics.set_loose(other, Pose(np.array([0.8, -0.7 + 0.28 * i, 0.10]), np.array([1.0, 0, 0, 0])))
    for _ in range(30):
        physics.advance(np.zeros(6), False, 25)
    assert physics.T_world(name).p[2] == pytest.approx(layout.PLAY.loose[name].half[2], abs=0.0015)
    assert physics.speed(name) < 1e-3


def test_a_lid_fits_its_pan_with_room_for_what_is_in_it():
    lid, pan = layout.PLAY.loose["lid"].shape, layout.PLAY.loose["pan"].shape
    assert isinstance(lid, Lid)
    assert isinstance(pan, Vessel)
    assert pan.radius - lid.skirt_radius >= 0.007
    assert lid.radius > pan.radius + pan.wall / 2
    room = pan.rim_z - pan.floor_z + lid.dome
    assert all(2 * layout.PLAY.loose[name].half[2] < room for name in layout.PLAY.of_type("thing"))


def test_a_missing_mesh_is_one_line_that_lists_what_exists():
    scene = layout.SceneLayout("test", {}, {}, {"plum": Loose("food", Mesh("plum", (0.02, 0.02, 0.02)), 0.1)})
    with pytest.raises(MissingDependencyError, match=r"no object 'plum' .*it has: bottle, bread") as error:
        model.scene_model(scene)
    assert "\n" not in str(error.value)


def test_a_scene_is_compiled_once_and_copied():
    assert model._compiled(layout.KITCHEN) is model._compiled(layout.KITCHEN)
    one, other = model.scene_model(layout.KITCHEN), model.scene_model(layout.KITCHEN)
    one.body_pos[1] += 1.0
    assert not np.array_equal(one.body_pos, other.body_pos)
    assert replace(layout.KITCHEN) != layout.KITCHEN
