"""What a question looks like on the wire: OpenAI's chat completions (which most local servers speak), Gemini's generateContent.

A question is a text, some PNG pictures, and for every field of the answer the words that it may be. Keys come from the
environment and go into a header, so that no body, file or address holds one.
"""

from __future__ import annotations

import base64
import os
import re
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from ipaddress import ip_address
from typing import Any
from urllib.parse import urlsplit

from symskill_pddl.errors import InputError, alternatives, shown


@dataclass(frozen=True)
class Question:
    """`choices`: for every field of the answer, the words that it may be."""

    text: str
    pictures: tuple[bytes, ...]
    choices: Mapping[str, tuple[str, ...]]


@dataclass(frozen=True)
class Endpoint(ABC):
    """A model behind an address.

    Attributes
    ----------
    model : str
    url : str
        Base address, without a slash at its end.
    key : str
        Sent in a header; not part of the representation.
    """

    model: str
    url: str
    key: str = field(default="", repr=False)

    @abstractmethod
    def address(self) -> str:
        """Where to post."""

    @abstractmethod
    def headers(self) -> dict[str, str]:
        """Of the request, with the key."""

    @abstractmethod
    def body(self, question: Question) -> dict[str, Any]:
        """The request as JSON."""

    @abstractmethod
    def text(self, reply: Any) -> str:
        """The model's words in a reply; KeyError, IndexError or TypeError if there are none."""


class OpenAI(Endpoint):
    """``POST {url}/chat/completions`` with a JSON schema as the form of the answer."""

    def address(self) -> str:
        return f"{self.url}/chat/completions"

    def headers(self) -> dict[str, str]:
        return {"Authorization": f"Bearer {self.key}"} if self.key else {}

    def body(self, question: Question) -> dict[str, Any]:
        pictures = [
            {"type": "image_url", "image_url": {"url": f"data:image/png;base64,{_encoded(p)}"}} for p in question.pictures
        ]
        schema = {
            "type": "object",
            "properties": {name: {"type": "string", "enum": list(words)} for name, words in question.choices.items()},
            "required": list(question.choices),
            "additionalProperties": False,
        }
        return {
            "model": self.model,
            "messages": [{"role": "user", "content": [{"type": "text", "text": question.text}, *pictures]}],
            "response_format": {"type": "json_schema", "json_schema": {"name": "answer", "strict": True, "schema": schema}},
        }

    def text(self, reply: Any) -> str:
        return str(reply["choices"][0]["message"]["content"])


class Gemini(Endpoint):
    """``POST {url}/v1beta/models/MODEL:generateContent`` with a response schema."""

    def address(self) -> str:
        return f"{self.url}/v1beta/models/{self.model}:generateContent"

    def headers(self) -> dict[str, str]:
        return {"x-goog-api-key": self.key} if self.key else {}

    def body(self, question: Question) -> dict[str, Any]:
        pictures = [{"inline_data": {"mime_type": "image/png", "data": _encoded(p)}} for p in question.pictures]
        schema = {
            "type": "OBJECT",
            "properties": {name: {"type": "STRING", "enum": list(words)} for name, words in question.choices.items()},
            "required": list(question.choices),
        }
        return {
            "contents": [{"role": "user", "parts": [{"text": question.text}, *pictures]}],
            "generationConfig": {"responseMimeType": "application/json", "responseSchema": schema},
        }

    def text(self, reply: Any) -> str:
        return str(reply["candidates"][0]["content"]["parts"][0]["text"])


_MODEL = re.compile(r"[\w.:/@+-]+", re.ASCII)
KINDS: dict[str, tuple[type[Endpoint], str, tuple[str, ...]]] = {
    "openai": (OpenAI, "https://api.openai.com/v1", ("OPENAI_API_KEY",)),
    "gemini": (Gemini, "https://generativelanguage.googleapis.com", ("GEMINI_API_KEY", "GOOGLE_API_KEY")),
}
"""By name: how it is asked, where by default, and in which environment variables its key may be."""


def endpoint_named(
    name: str, url: str | None = None, environment: Mapping[str, str] | None = None, *, insecure: bool = False
) -> Endpoint:
    """The endpoint ``openai:MODEL`` or ``gemini:MODEL``, at another base address if one is given.

    `insecure`: a key may go over plain http to another machine, where everybody on the way can read it.

    Raises
    ------
    InputError
        For another name or an address that is none; if the default address is asked without a key in the environment; if the key
        cannot stand in a header, or would be sent over plain http to another machine.
    """
    environment = os.environ if environment is None else environment
    kind, colon, model = name.partition(":")
    if kind not in KINDS or not colon or not _MODEL.fullmatch(model):
        raise InputError(f"references '{shown(name, 80)}': expected KIND:MODEL with a kind of {alternatives(KINDS)}")
    adapter, usual, variables = KINDS[kind]
    readable = url is not None and _readable_on_the_way(url)
    variable, key = next(((v, value) for v in variables if (value := environment.get(v, "").strip())), ("", ""))
    if not key and url is None:
        named = " or ".join(variables)
        raise InputError(f"{kind} needs a key in the environment variable {named}; a server of your own needs its address")
    if not all("!" <= character <= "~" for character in key):
        raise InputError(f"the key in {variable} holds a character that a key cannot have, such as a blank or the end of a line")
    if key and readable and not insecure:
        raise InputError(
            f"--references-url '{shown(url, 80)}': over plain http everybody on the way could read the key of {variable}; "
            "https is needed, or --insecure"
        )
    return adapter(model, (url or usual).rstrip("/"), key)


def _readable_on_the_way(url: str) -> bool:
    """Whether a base address, checked here, is of plain http to another machine."""
    try:
        parts = urlsplit(url)
        host, _ = parts.hostname or "", parts.port
        valid = all("!" <= character <= "~" for character in url) and parts.scheme in ("http", "https") and host
    except ValueError:
        valid = False
    if not valid:
        raise InputError(
            f"--references-url '{shown(url, 80)}' is no address of a model: http:// or https:// and a host are needed, such as "
            "http://localhost:8000/v1"
        )
    if parts.username is not None or parts.query or parts.fragment:
        raise InputError("--references-url: a base address has no user, no '?' and no '#'; a key comes from the environment")
    try:
        own = ip_address(host).is_loopback
    except ValueError:
        own = host == "localhost" or host.endswith(".localhost")
    return parts.scheme == "http" and not own


def _encoded(picture: bytes) -> str:
    return base64.b64encode(picture).decode("ascii")
