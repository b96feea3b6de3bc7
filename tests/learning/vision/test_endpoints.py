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
        ("openai:m", "file:///etc/passwd", "http:// or https:// and a host are needed"),
    ],
)
def test_what_cannot_be_asked(name, url, message):
    with pytest.raises(InputError, match=message):
        endpoint_named(name, url, {})


@pytest.mark.parametrize(
    "url",
    [
        "http://[::1",
        "http://",
        "http://:80",
        "http://host:99999",
        "http://host:x",
        "http://ho st",
        "http://h\n",
        "//host",
        "",
        "http://\x1b]52;c;\x07",
    ],
)
def test_an_address_that_is_none(url):
    with pytest.raises(InputError, match=r"--references-url .* is no address of a model"):
        endpoint_named("openai:m", url, {})


@pytest.mark.parametrize("url", ["https://me:secret@host/v1", "https://host/v1?key=secret", "https://host/#secret"])
def test_an_address_holds_no_secret(url):
    with pytest.raises(InputError, match="has no user") as caught:
        endpoint_named("openai:m", url, {})
    assert "secret" not in str(caught.value)


@pytest.mark.parametrize("key", ["sk-MADE-UP\nx", "sk-MADE-UP x", "sk-MADE-UP\u00e9", "sk-MADE-UP\0"])
def test_a_key_that_cannot_be_one_is_not_shown(key):
    with pytest.raises(InputError, match="the key in OPENAI_API_KEY holds a character") as caught:
        endpoint_named("openai:m", None, {"OPENAI_API_KEY": key})
    assert "MADE-UP" not in str(caught.value)


def test_a_key_goes_over_plain_http_to_this_machine_only():
    keys = {"OPENAI_API_KEY": "k"}
    for url in (
        "http://localhost:8000/v1",
        "http://127.0.0.1/",
        "http://[::1]:8000",
        "http://127.3.2.1",
        "https://elsewhere.org",
    ):
        assert endpoint_named("openai:m", url, keys).key == "k"
    for url in ("http://elsewhere.org/v1", "http://192.168.1.5:8000", "HTTP://localhost.org", "http://127.0.0.1.org"):
        with pytest.raises(InputError, match=r"OPENAI_API_KEY; https is needed, or --insecure"):
            endpoint_named("openai:m", url, keys)
        assert endpoint_named("openai:m", url, keys, insecure=True).key == "k"
        assert endpoint_named("openai:m", url, {}).key == ""
