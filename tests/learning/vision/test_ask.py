import json
import time

import pytest

from symskill_pddl.learning.vision.ask import AskConfig, Asker, VisionError
from symskill_pddl.learning.vision.endpoints import Question, endpoint_named

from .conftest import KEY

QUESTION = Question("where?", (b"png-1", b"png-2"), {"before": ("cabinet", "counter"), "after": ("cabinet", "counter")})
GOOD = {"before": "cabinet", "after": "counter"}


def asker(model, cache=None, kind="openai", waits=None, **config):
    model.kind = kind
    endpoint = endpoint_named(f"{kind}:some-model", model.url, {"OPENAI_API_KEY": KEY, "GEMINI_API_KEY": KEY})
    config = AskConfig(**{"timeout_s": 60.0, "attempts": 3, "backoff_s": 0.01, **config})
    return Asker(endpoint, config, cache, (waits if waits is not None else []).append)


@pytest.mark.parametrize("kind", ["openai", "gemini"])
def test_a_good_answer_and_what_was_asked(model, kind):
    model.replies = [GOOD]
    assert asker(model, kind=kind).ask(QUESTION) == GOOD
    ((path, headers, body),) = model.seen
    text = json.dumps(body)
    assert KEY not in text
    assert text.count('"enum": ["cabinet", "counter"]') == 2
    assert "cG5nLTE=" in text  # the first picture
    if kind == "openai":
        assert path == "/chat/completions"
        assert headers["Authorization"] == f"Bearer {KEY}"
        assert body["response_format"]["json_schema"]["strict"] is True
    else:
        assert path == "/v1beta/models/some-model:generateContent"
        assert headers["X-Goog-Api-Key" if "X-Goog-Api-Key" in headers else "X-goog-api-key"] == KEY
        assert body["generationConfig"]["responseMimeType"] == "application/json"


@pytest.mark.parametrize(
    ("reply", "reason"),
    [
        ({"before": "fridge", "after": "counter"}, "'before' is 'fridge', which the scene does not hold"),
        ({"before": "cabinet"}, "'after' is 'None', which the scene does not hold"),
        (b"<html>not found</html>", "the reply: is no JSON"),
        (b"[1, 2]", "the reply holds no answer"),
        (b'{"choices": []}', "the reply holds no answer"),
        (b'{"choices": [{"message": {"content": "the counter, I think"}}]}', "the answer: is no JSON"),
        (b'{"choices": [{"message": {"content": "7"}}]}', "the answer is no JSON object"),
        (b"7" * 2000, "the reply is longer than 1000 bytes"),
        ((500, b"overloaded"), "HTTP status 500: overloaded"),
        ((302, b"", {"Location": "http://127.0.0.1:9/"}), "HTTP status 302"),
        ("hang", "no reply within 0.3 s"),
        ("stall", "no reply within 0.3 s"),
        ("drip", "no reply within 0.3 s"),
        ("drip-head", "no reply within 0.3 s"),
        (b"9" * 900, "the reply: a number has 900 digits"),
        (b'{"choices": NaN}', "the reply: NaN is no number of JSON"),
        (b"\xff\xfe", "the reply: holds a text that is no Unicode"),
        (b'{"choices": [{"message": {"content": "[[[["}}]}', "the answer: is no JSON"),
        ((429, b"", {"Retry-After": "\u00b2".encode().decode("latin-1")}), "HTTP status 429"),
        ("drop", "not reached"),
    ],
)
def test_what_is_no_answer_is_an_error_after_a_few_attempts(model, reply, reason):
    model.replies, waits = [reply], []
    timeout_s = 0.3 if "within 0.3 s" in reason else 60.0
    with pytest.raises(VisionError, match=reason):
        asker(model, waits=waits, timeout_s=timeout_s, attempts=2, max_reply_bytes=1000).ask(QUESTION)
    while timeout_s < 60.0 and len(model.seen) < 2:  # a busy server sees what it was asked after nobody waits any more
        time.sleep(0.01)
    assert len(model.seen) == (1 if reason == "HTTP status 302" else 2)
    assert waits == ([] if reason == "HTTP status 302" else [0.01])


def test_brackets_without_end_are_an_error(model):
    model.replies = [b"[" * 100_000]
    with pytest.raises(VisionError, match="the reply: is nested too deeply"):
        asker(model, attempts=1).ask(QUESTION)


def test_nobody_there():
    endpoint = endpoint_named("openai:m", "http://127.0.0.1:9", {})
    with pytest.raises(VisionError, match=r"m at http://127.0.0.1:9: not reached"):
        Asker(endpoint, AskConfig(attempts=2, timeout_s=60.0), sleep=lambda _: None).ask(QUESTION)


def test_it_asks_again_waits_longer_and_no_longer_than_it_may(model):
    model.replies, waits = [(503, b""), (429, b"", {"Retry-After": "700"}), b"nonsense", GOOD], []
    assert asker(model, waits=waits, attempts=4, backoff_s=1.0, max_wait_s=5.0).ask(QUESTION) == GOOD
    assert waits == [1.0, 5.0, 5.0]


def test_what_is_refused_is_not_asked_again_and_the_key_is_blotted_out(model):
    model.replies = [(401, f"Incorrect API key provided: {KEY}".encode())]
    with pytest.raises(VisionError) as caught:
        asker(model).ask(QUESTION)
    assert len(model.seen) == 1
    assert KEY not in str(caught.value)
    assert "Incorrect API key provided: ***" in str(caught.value)
    assert caught.value.__cause__ is None
    assert caught.value.__context__ is None


def test_answers_are_kept_and_no_key_with_them(model, tmp_path):
    model.replies = [lambda body: {**GOOD, "note": KEY}]
    first = asker(model, tmp_path / "kept")
    assert first.ask(QUESTION) == first.ask(QUESTION) == GOOD
    assert first.requests == len(model.seen) == 1
    (file,) = (tmp_path / "kept").iterdir()
    assert KEY not in file.read_text()
    assert KEY not in repr(first.endpoint)
    other = Question("what else?", QUESTION.pictures, QUESTION.choices)
    first.ask(other)
    assert first.requests == 2
    # recorded replies are replayed where nobody answers
    model.replies = ["drop"]
    assert asker(model, tmp_path / "kept").ask(QUESTION) == GOOD


def test_a_damaged_kept_answer_is_said(model, tmp_path):
    model.replies = [GOOD]
    asker(model, tmp_path).ask(QUESTION)
    (file,) = tmp_path.iterdir()
    file.write_text("{")
    with pytest.raises(VisionError, match="is damaged; delete it"):
        asker(model, tmp_path).ask(QUESTION)


def test_a_bad_answer_is_not_kept(model, tmp_path):
    model.replies = [{"before": "moon", "after": "counter"}]
    with pytest.raises(VisionError):
        asker(model, tmp_path).ask(QUESTION)
    assert list(tmp_path.iterdir()) == []
