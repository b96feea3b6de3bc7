import pytest

from symskill_pddl.errors import InputError
from symskill_pddl.learning.vision.endpoints import endpoint_named


def test_names_addresses_and_keys():
    endpoint = endpoint_named("openai:qwen:7b", "http://localhost:8000/v1/", {})
    assert (endpoint.model, endpoint.url, endpoint.headers()) == ("qwen:7b", "http://localhost:8000/v1", {})
    assert endpoint_named("gemini:m", environment={"GOOGLE_API_KEY": "k"}).headers() == {"x-goog-api-key": "k"}
    assert "GEMINI" not in repr(endpoint_named("gemini:m", environment={"GEMINI_API_KEY": "GEMINI"}))


@pytest.mark.parametrize(
    ("name", "url", "message"),
    [
        ("gpt", None, "expected KIND:MODEL"),
        ("openai:", None, "expected KIND:MODEL"),
        ("claude:x", None, "with a kind of"),
        ("openai:m", None, "OPENAI_API_KEY; a server of your own needs its address"),
        ("gemini:m", None, "GEMINI_API_KEY or GOOGLE_API_KEY"),
        ("openai:m", "file:///etc/passwd", "http:// or https:// is needed"),
    ],
)
def test_what_cannot_be_asked(name, url, message):
    with pytest.raises(InputError, match=message):
        endpoint_named(name, url, {})
