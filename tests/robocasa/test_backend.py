"""Which assets are taken, and what is said when they are missing or damaged. Needs no RoboCasa."""

from pathlib import Path

import pytest

from symskill_pddl.errors import InputError, MissingDependencyError
from symskill_pddl.robocasa import backend
from symskill_pddl.robocasa.backend import ASSETS, PACK, PARTS, assets_folder, reading_assets


def root_at(path: Path, parts: tuple[str, ...] = PARTS) -> Path:
    for name in parts:
        (path / name).mkdir(parents=True)
    return path


@pytest.fixture(autouse=True)
def package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An installed package without assets, and a working directory without a pack."""
    monkeypatch.setattr(backend, "robocasa_folder", lambda: tmp_path / "robocasa")
    monkeypatch.setattr("sys.prefix", str(tmp_path / "venv"))
    monkeypatch.delenv(ASSETS, raising=False)
    monkeypatch.chdir(tmp_path)
    return tmp_path / "robocasa"


def test_what_the_variable_names_comes_first_then_the_pack_then_the_package(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(MissingDependencyError, match=r"RoboCasa's assets are not there .* 'arenas'\): `make robocasa`"):
        assets_folder()
    own = root_at(package / "models" / "assets")
    assert assets_folder() == own
    pack = root_at(tmp_path / PACK)
    assert assets_folder() == pack
    named = root_at(tmp_path / "named")
    monkeypatch.setenv(ASSETS, str(named))
    assert assets_folder() == named


def test_a_name_that_is_no_root_of_assets_is_refused_although_there_are_others(
    package: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root_at(package / "models" / "assets")
    monkeypatch.setenv(ASSETS, str(tmp_path / "nowhere"))
    with pytest.raises(InputError, match=r"ROBOCASA_ASSETS_PATH='.*nowhere' is no folder"):
        assets_folder()
    monkeypatch.setenv(ASSETS, str(root_at(tmp_path / "half", PARTS[:2])))
    with pytest.raises(InputError, match="has no 'objects'"):
        assets_folder()


def test_a_missing_or_damaged_file_is_named_in_one_line(package: Path) -> None:
    own = root_at(package / "models" / "assets")
    (own / "objects" / "pan.xml").write_text("<mujoco/>")
    (own / "objects" / "pot.xml").write_text("<mujoco")
    with pytest.raises(InputError, match=r"No such file or directory: .*gone.xml") as missing, reading_assets():
        (own / "gone.xml").read_text()
    with pytest.raises(InputError, match=r"pot.xml: unclosed token") as damaged, reading_assets():
        backend.ElementTree.parse(own / "objects" / "pot.xml")
    with pytest.raises(InputError, match=r"error decoding PNG file 'a.png' Element name 'wall'") as compiled, reading_assets():
        raise ValueError("Error: error decoding PNG file 'a.png'\nElement name 'wall'")
    assert all("\n" not in str(error.value) for error in (missing, damaged, compiled))


def test_what_has_nothing_to_do_with_assets_stays_what_it_is(package: Path) -> None:
    root_at(package / "models" / "assets")
    with pytest.raises(ValueError, match="not a file"), reading_assets():
        raise ValueError("not a file")
