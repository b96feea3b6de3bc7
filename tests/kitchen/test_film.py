import numpy as np
import pytest

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.kitchen import film as module
from symskill_pddl.kitchen import make
from symskill_pddl.kitchen.film import Film, captioned, encoder
from symskill_pddl.scene import Command

pytestmark = pytest.mark.simulation

AWAY = Command.of([0.0, 0.3, 0.2], [0.0, 0.0, 0.5], False)


@pytest.fixture
def kitchen():
    return make("OpenDrawer", 0)


@pytest.fixture
def film(kitchen):
    try:
        with Film(kitchen) as film:
            yield film
    except MissingDependencyError as error:
        pytest.skip(str(error))


def frames(path):
    reader = encoder().read_frames(str(path))
    width, height = next(reader)["size"]
    return [np.frombuffer(frame, np.uint8).reshape(height, width, 3) for frame in reader]


def test_a_film_shows_the_episode_step_by_step(kitchen, film, tmp_path):
    film.caption = "moving on"
    for _ in range(9):
        kitchen.step(AWAY)
    end = kitchen.physics.data.qpos.copy()
    drawn = []
    film.save(tmp_path / "a.mp4", drawn.append)
    assert sum(drawn) == len(film) == 10
    first, *_, last = shown = frames(tmp_path / "a.mp4")
    assert len(shown) == 10
    assert np.mean(np.abs(first.astype(int) - last) > 30) > 0.005
    # what was drawn later is what a camera would have seen then, up to the encoder's losses
    assert np.mean(np.abs(film.frame(9).astype(int) - last) > 30) < 0.002
    assert [p.name for p in tmp_path.iterdir()] == ["a.mp4"]
    np.testing.assert_array_equal(kitchen.physics.data.qpos, end)


def test_a_filmed_episode_goes_as_any_other(film, kitchen):
    other = make("OpenDrawer", 0)
    for k in range(10):
        scene, same = kitchen.step(AWAY), other.step(AWAY)
        if k == 5:
            film.frame(3)
    assert scene.T_world_ee.vector().tobytes() == same.T_world_ee.vector().tobytes()
    assert kitchen.physics.data.qpos.tobytes() == other.physics.data.qpos.tobytes()


def test_a_moment_is_seen_again_as_it_was(film, kitchen):
    camera = film._camera
    before = camera.image()
    moment = camera.moment()
    for _ in range(5):
        kitchen.step(AWAY)
    assert np.any(camera.image() != before)
    np.testing.assert_array_equal(camera.image(moment), before)


def test_a_film_that_cannot_be_written(film, tmp_path):
    with pytest.raises(InputError, match="there is no folder"):
        film.save(tmp_path / "nowhere" / "a.mp4")


def test_the_caption_is_drawn_at_the_lower_edge():
    image = np.full((60, 200, 3), 128, np.uint8)
    written = captioned(image, "12.3 s")
    assert written.shape == image.shape
    np.testing.assert_array_equal(written[:42], image[:42])
    assert written[42:].max() > 200
    assert written[42:].min() < 50


def test_without_an_encoder_one_line_says_what_to_install(monkeypatch):
    def absent(name):
        raise ImportError(f"No module named '{name}'")

    monkeypatch.setattr(module.importlib, "import_module", absent)
    with pytest.raises(MissingDependencyError, match="pip install imageio-ffmpeg") as error:
        module.check_film()
    assert "\n" not in str(error.value)
