from synthetic import record
from typer.testing import CliRunner

from symskill_pddl.cli.app import app
from symskill_pddl.demos import save_demos

from .conftest import KEY


def learn(model, tmp_path, monkeypatch, *more):
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    save_demos(tmp_path / "food.hdf5", record("PnPCabToCounter", 1, faults=False))
    options = ["--references", "openai:m", "--references-url", model.url, "--references-cache", str(tmp_path / "kept")]
    return CliRunner().invoke(app, ["learn", str(tmp_path / "food.hdf5"), "-o", str(tmp_path / "library"), *options, *more])


def test_learn_reports_the_agreement_and_tells_the_key_to_nobody(model, tmp_path, monkeypatch):
    model.replies = [{"before": "cabinet", "after": "counter"}]
    done = learn(model, tmp_path, monkeypatch)
    assert done.exit_code == 0
    assert "references: 1 of 1 episodes answered; 2 of 2 resting places as the default selector has them (100 %)" in done.output
    files = [f for f in tmp_path.rglob("*") if f.is_file()]
    assert len(files) > 3
    assert all(KEY.encode() not in f.read_bytes() for f in files)
    assert KEY not in done.output


def test_a_model_that_does_not_answer_is_an_error_and_no_library_is_made(model, tmp_path, monkeypatch):
    model.replies = [(403, KEY.encode())]
    done = learn(model, tmp_path, monkeypatch)
    assert "HTTP status 403: ***" in str(done.exception)
    assert not (tmp_path / "library").exists()


def test_an_address_without_a_model_is_refused():
    done = CliRunner().invoke(app, ["learn", "x.hdf5", "-o", "library", "--references-url", "http://localhost"])
    assert "belong to --references KIND:MODEL" in str(done.exception)
