import numpy as np
import pytest

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.kitchen import make

pytestmark = pytest.mark.simulation


def test_a_picture_shows_something(tmp_path):
    from symskill_pddl.kitchen.render import picture

    try:
        path = picture(make("OpenSingleDoor", 0), tmp_path / "kitchen.png")
    except MissingDependencyError as error:
        pytest.skip(str(error))
    from PIL import Image

    with Image.open(path) as image:
        assert np.asarray(image).std() > 10.0


def test_an_unknown_camera_lists_the_cameras():
    from symskill_pddl.kitchen.render import picture

    with pytest.raises(InputError, match=r"inside.*overview"):
        picture(make("OpenSingleDoor", 0), "never.png", camera="nowhere")


def test_without_a_library_one_line_says_what_to_install(monkeypatch):
    from symskill_pddl.kitchen import render

    def absent(name: str):
        raise ImportError("Unable to load the library")

    monkeypatch.setattr(render.importlib, "import_module", absent)
    with pytest.raises(MissingDependencyError, match="libegl1 or libosmesa6") as error:
        render.Camera(make("OpenSingleDoor", 0))
    assert "\n" not in str(error.value)
