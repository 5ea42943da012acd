"""A browser's part in tests of the page's server."""

import http.client
import json
from collections.abc import Callable
from urllib.parse import urlsplit

from websockets.sync.client import ClientConnection, connect

from trundle.serve.server import PageServer

WAIT_S = 60.0
"""How long a message may take before a test gives up."""


class Visitor:
    """Talks HTTP and WebSocket to a server, with the cookie that a browser would have."""

    def __init__(self, server: PageServer) -> None:
        self._arrive(server.address)

    @classmethod
    def of_address(cls, address: str) -> "Visitor":
        visitor = cls.__new__(cls)
        visitor._arrive(address)
        return visitor

    def _arrive(self, address: str) -> None:
        parts = urlsplit(address)
        self.port, self.token = parts.port, parts.query.removeprefix("token=")
        self.cookie = self.welcome()

    @property
    def host(self) -> str:
        return f"127.0.0.1:{self.port}"

    def welcome(self) -> str:
        """Open the printed address; return the cookie."""
        status, headers, _ = self.get(f"/?token={self.token}")
        assert status == 200
        return headers["Set-Cookie"].partition(";")[0]

    def get(self, path: str, **headers: str) -> tuple[int, http.client.HTTPMessage, bytes]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=WAIT_S)
        try:
            connection.request("GET", path, headers={name.replace("_", "-"): text for name, text in headers.items()})
            response = connection.getresponse()
            return response.status, response.headers, response.read()
        finally:
            connection.close()

    def see(self, path: str) -> tuple[int, http.client.HTTPMessage, bytes]:
        """Get with the cookie."""
        return self.get(path, Cookie=self.cookie)

    def open(self, **options: object) -> "OpenPage":
        """Open the WebSocket, as the page does."""
        given = {"origin": f"http://{self.host}", "cookie": self.cookie, **options}
        headers = {"Cookie": given.pop("cookie")} if given["cookie"] else {}
        given.pop("cookie", None)
        return OpenPage(
            connect(
                f"ws://{self.host}/ws",
                additional_headers=headers,
                compression=None,
                max_size=None,
                max_queue=None,
                proxy=None,
                **given,
            )
        )


class OpenPage:
    """A page's WebSocket; keeps everything that it got."""

    def __init__(self, connection: ClientConnection) -> None:
        self._connection = connection
        self.socket = connection.__enter__()
        self.got: list[dict] = []

    def __enter__(self) -> "OpenPage":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._connection.__exit__(None, None, None)

    def send(self, kind: str, **fields: object) -> None:
        self.socket.send(json.dumps({"type": kind, **fields}))

    def wait(self, kind: str, accept: Callable[[dict], bool] = lambda _: True) -> dict:
        """The next message of a type that is accepted."""
        while True:
            message = json.loads(self.socket.recv(timeout=WAIT_S))
            self.got.append(message)
            if message["type"] == kind and accept(message):
                return message

    def ping(self) -> None:
        """Wait until the server has answered everything before."""
        echo = float(len(self.got))
        self.send("ping", echo=echo)
        self.wait("pong", lambda message: message["echo"] == echo)
