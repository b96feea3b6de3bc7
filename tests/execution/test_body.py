from dataclasses import replace

import pytest
from fake_world import OBJECTS, FakeWorld

from symskill_pddl.errors import InputError
from symskill_pddl.execution.body import same_objects
from symskill_pddl.scene import Scene


def without(scene: Scene, name: str) -> Scene:
    rows = [i for i, obj in enumerate(scene.objects) if obj != name]
    objects = {obj: type_ for obj, type_ in scene.objects.items() if obj != name}
    return replace(scene, objects=objects, T_world_objects=scene.T_world_objects[rows])


def test_a_scene_keeps_its_objects():
    scene = FakeWorld().observe()
    assert same_objects(scene, scene) is scene
    less = without(scene, next(iter(OBJECTS)))
    with pytest.raises(InputError, match=f"'{next(iter(OBJECTS))}' has vanished; .* says in `unseen` which"):
        same_objects(less, scene)
    with pytest.raises(InputError, match=f"'{next(iter(OBJECTS))}' has come"):
        same_objects(scene, less)
    turned = replace(scene, objects=dict(reversed(scene.objects.items())), T_world_objects=scene.T_world_objects)
    with pytest.raises(InputError, match="types or order have changed"):
        same_objects(turned, scene)
