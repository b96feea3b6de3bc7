"""Ask an endpoint: bounded time and retries, answers checked against what was allowed and kept in files.

A server may stall, drip, answer with brackets without end: every request runs beside us and is given up when its time is over,
whatever it is waiting for, and all that is wrong with an answer is a `VisionError`.

The cache holds replies under the hash of the request without its headers, so a learned library can be made again without the
network. A key stands in no file, and what a server says is printed with the key blotted out.
"""

from __future__ import annotations

import hashlib
import http.client
import json
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from typing import Any

from symskill_pddl.errors import QUOTED, FormatError, InputError, LearningError, shown
from symskill_pddl.files import make_folder, write_atomic
from symskill_pddl.learning.vision.endpoints import Endpoint, Question
from symskill_pddl.reading import parse_json, read_bytes, whole


class VisionError(LearningError):
    """The model gave no usable answer."""


@dataclass(frozen=True)
class AskConfig:
    """How long and how often."""

    timeout_s: float = 60.0
    """Of one request, from the resolution of the server's name to the last byte of its reply."""
    attempts: int = 3
    """Requests for one question, the first included."""
    backoff_s: float = 1.0
    """Before the second attempt; twice as long before every further one."""
    max_wait_s: float = 20.0
    """No server makes us wait longer than this between attempts."""
    max_reply_bytes: int = 1_000_000


class _RefusedError(VisionError):
    """The server answered with a status that is no success."""

    def __init__(self, status: int, said: str, retry_after: str) -> None:
        super().__init__(f"HTTP status {status}: {said}")
        self.status, self.retry_after_s = status, whole(retry_after.strip())


class _NoRedirect(urllib.request.HTTPRedirectHandler):
    """A redirected request would carry the key to another address."""

    def redirect_request(self, *_: Any) -> None:
        return None


class Asker:
    """One endpoint, its cache, and the count of requests that went out.

    Parameters
    ----------
    endpoint : Endpoint
    config : AskConfig, optional
    cache : Path, optional
        Folder of kept answers; none are kept without one.
    sleep : callable
        Waits that many seconds.
    """

    def __init__(
        self,
        endpoint: Endpoint,
        config: AskConfig | None = None,
        cache: Path | None = None,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        self.endpoint, self.config, self.cache, self.requests = endpoint, config or AskConfig(), cache, 0
        self._sleep = sleep
        self._opener = urllib.request.build_opener(_NoRedirect)

    def ask(self, question: Question) -> dict[str, str]:
        """The answer: for every field one of its words.

        Raises
        ------
        VisionError
            If no attempt gave one; the message holds the last reason.
        """
        body = json.dumps(self.endpoint.body(question), sort_keys=True).encode()
        kept = self._kept(body)
        if kept is not None:
            return _checked(self.endpoint, kept, question)
        reason, wait = "", self.config.backoff_s
        for attempt in range(self.config.attempts):
            if attempt:
                self._sleep(min(wait, self.config.max_wait_s))
                wait = 2 * wait
            try:
                reply = self._understood(self._post(body))
                answer = _checked(self.endpoint, reply, question)
            except _RefusedError as error:
                reason = str(error)
                if error.status not in (408, 409, 425, 429) and error.status < 500:
                    break  # what was refused stays refused
                wait = max(wait, float(error.retry_after_s or 0))
            except VisionError as error:
                reason = str(error)
            else:
                self._keep(body, reply)
                return answer
        raise VisionError(self._clean(f"{self.endpoint.model} at {self.endpoint.url}: {reason}"))

    def _post(self, body: bytes) -> bytes:
        """The reply to one request, all of it within the time; each kind of failure is a `VisionError`."""
        self.requests += 1
        result: SimpleQueue[bytes | BaseException] = SimpleQueue()

        def exchange() -> None:
            try:
                result.put(self._exchange(body))
            except BaseException as error:  # noqa: BLE001 - it is raised where it is waited for
                result.put(error)

        # no time limit of a socket covers a name that is not resolved, or a byte now and then; who exceeds it is left alone
        Thread(target=exchange, daemon=True, name="request").start()
        slow = f"no reply within {self.config.timeout_s:g} s"
        try:
            found = result.get(timeout=self.config.timeout_s)
        except Empty:
            raise VisionError(slow) from None
        match found:
            case bytes():
                return found
            case TimeoutError() | urllib.error.URLError(reason=TimeoutError()):
                raise VisionError(slow)
            case urllib.error.URLError() | http.client.HTTPException() | OSError() | ValueError():
                raise VisionError(f"not reached: {shown(getattr(found, 'reason', None) or found)}")
            case _:
                raise found

    def _exchange(self, body: bytes) -> bytes:
        headers = {"Content-Type": "application/json", **self.endpoint.headers()}
        request = urllib.request.Request(self.endpoint.address(), data=body, headers=headers, method="POST")
        try:
            with self._opener.open(request, timeout=self.config.timeout_s) as response:
                return bytes(response.read(self.config.max_reply_bytes + 1))
        except urllib.error.HTTPError as error:
            with error:
                said = error.read(1000).decode("utf-8", "replace")
            raise _RefusedError(error.code, said, error.headers.get("Retry-After", "") if error.headers else "") from None

    def _understood(self, content: bytes) -> Any:
        if len(content) > self.config.max_reply_bytes:
            raise VisionError(f"the reply is longer than {self.config.max_reply_bytes} bytes")
        try:
            return parse_json(content, "the reply")
        except FormatError as error:
            raise VisionError(f"{error}: {shown(content[:200].decode('utf-8', 'replace'), 80)}") from None

    def _clean(self, text: str) -> str:
        """One line, without the key."""
        plain = " ".join(text.split())
        return shown(plain.replace(self.endpoint.key, "***") if self.endpoint.key else plain, 2 * QUOTED)

    def _file(self, body: bytes) -> Path | None:
        name = hashlib.sha256(self.endpoint.address().encode() + b"\0" + body).hexdigest()
        return None if self.cache is None else self.cache / f"{name}.json"

    def _kept(self, body: bytes) -> Any | None:
        file = self._file(body)
        if file is None or not file.is_file():
            return None
        try:
            return parse_json(read_bytes(file, "kept answer"), "")["reply"]
        except (InputError, LookupError, TypeError):
            raise VisionError(f"the kept answer '{file}' is damaged; delete it to ask again") from None

    def _keep(self, body: bytes, reply: Any) -> None:
        file = self._file(body)
        if file is not None:
            make_folder(file.parent)
            text = json.dumps({"model": self.endpoint.model, "address": self.endpoint.address(), "reply": reply}, indent=1)
            write_atomic(file, self._clean_json(text).encode())

    def _clean_json(self, text: str) -> str:
        return text.replace(self.endpoint.key, "***") if self.endpoint.key else text


def _checked(endpoint: Endpoint, reply: Any, question: Question) -> dict[str, str]:
    """The answer in a reply, if it is one of those allowed."""
    try:
        text = endpoint.text(reply)
    except (KeyError, IndexError, TypeError):
        raise VisionError("the reply holds no answer") from None
    try:
        answer = parse_json(text, "the answer")
    except FormatError as error:
        raise VisionError(f"{error}: {shown(text, 80)}") from None
    if not isinstance(answer, Mapping):
        raise VisionError(f"the answer is no JSON object: {shown(text, 80)}")
    for name, words in question.choices.items():
        if answer.get(name) not in words:
            raise VisionError(f"the answer's '{name}' is '{shown(answer.get(name), 80)}', which the scene does not hold")
    return {name: str(answer[name]) for name in question.choices}
