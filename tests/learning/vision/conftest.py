"""A real HTTP server on this machine that answers as a model would, or not."""

import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

KEY = "secret-key-0123456789"


class Model:
    """`replies` are used up one by one, the last one stays.

    Each is a dict (the answer), bytes, (status, bytes), or a word: 'hang', 'drop', 'stall', 'drip', 'drip-head'.
    """

    def __init__(self):
        self.replies, self.seen, self.kind = [], [], "openai"
        self.closed = threading.Event()
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        self._server.daemon_threads = True
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    @property
    def url(self):
        return f"http://127.0.0.1:{self._server.server_address[1]}"

    def close(self):
        self.closed.set()
        self._server.shutdown()
        self._server.server_close()

    def _handler(model):  # noqa: N805
        class Handler(BaseHTTPRequestHandler):
            def do_POST(self):
                body = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
                model.seen.append((self.path, dict(self.headers), body))
                reply = model.replies[0] if len(model.replies) == 1 else model.replies.pop(0)
                if callable(reply):
                    reply = reply(body)
                if reply == "hang":
                    model.closed.wait()
                    return
                if reply in ("stall", "drip", "drip-head"):
                    self._slow(reply)
                    return
                if reply == "drop":
                    self.connection.close()
                    return
                status, content, headers = 200, reply, {}
                if isinstance(reply, dict):
                    content = model.wrapped(json.dumps(reply))
                elif isinstance(reply, tuple):
                    status, content, headers = (*reply, {})[:3]
                self.send_response(status)
                for name, value in headers.items():
                    self.send_header(name, value)
                self.send_header("Content-Length", str(len(content)))
                self.end_headers()
                self.wfile.write(content)

            def _slow(self, how):
                """A status of failure whose body never comes; or a byte now and then, of the body or of the head."""
                if how == "drip-head":
                    self.wfile.write(b"HTTP/1.0 200 OK\r\n")
                else:
                    self.send_response(500 if how == "stall" else 200)
                    self.send_header("Content-Length", "1000")
                    self.end_headers()
                while not model.closed.wait(0.05):
                    if how != "stall":
                        try:
                            self.wfile.write(b"x")
                            self.wfile.flush()
                        except OSError:  # who asked has gone
                            return

            def log_message(self, *_):
                pass

        return Handler

    def wrapped(self, text):
        if self.kind == "gemini":
            return json.dumps({"candidates": [{"content": {"parts": [{"text": text}]}}]}).encode()
        return json.dumps({"choices": [{"message": {"content": text}}]}).encode()


@pytest.fixture
def model():
    model = Model()
    yield model
    model.close()
