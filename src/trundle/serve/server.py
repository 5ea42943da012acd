"""`PageServer`: HTTP and WebSocket for the page, in a separate thread."""

from __future__ import annotations

import asyncio
import contextlib
import gzip
import logging
import threading
import time
from dataclasses import dataclass
from functools import partial
from types import TracebackType
from typing import Any, Self, cast
from urllib.parse import parse_qs

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from trundle.errors import InputError
from trundle.serve.access import Access
from trundle.serve.hub import Client, Hub, TooManyMessagesError, fragments, is_long
from trundle.serve.page_messages import MAX_BYTES
from trundle.serve.run_files import ServedFile, TooLargeError, find_run_file, list_run_files, read_run_file

_LOGGER = logging.getLogger(__name__)

PORT = 8765
MAX_OWNERS = 128
"""Connections with the cookie, or the token, that are open at once."""

MAX_STRANGERS = 128
"""Connections without, most of which have not said yet what they want; one more closes the oldest of them."""

MAX_BODIES_BYTES = 256 * 2**20
"""Size of all answers together that wait to be read, at most."""

TICK_S = 0.05
"""Period [s] of encoding what is new: a control period at 20 Hz, so that each step in real time can be a frame."""

_IDLE_TICK_S = 0.5
"""The same while no page is connected: then only the log is encoded, so that it does not pile up."""

HANDSHAKE_S = 5.0
_PING_S = 10.0  # a page that went without a word, such as a closed lid, is noticed after two of these
_CLOSE_S = 2.0
_START_S = 10.0

_BASE_HEADERS = {
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
_NOTHING = "default-src 'none'; frame-ancestors 'none'"
_TOO_MANY = "too many connections are open: close other pages of this server"
_SANDBOX = "sandbox allow-scripts allow-downloads; frame-ancestors 'none'"
"""Policy of a report: its scripts run, but not as pages of this server, whose cookie would let them drive."""


@dataclass(frozen=True, slots=True)
class Page:
    """The page that is served.

    Attributes:
        html: The one file.
        csp: Its Content-Security-Policy.
        framed_csp: Its policy at /frame, where a notebook shows it; None if nothing may. A frame of another site gets
            no cookie: there the token of its address lets it in.
    """

    html: str
    csp: str
    framed_csp: str | None = None


class PageServer:
    """Serves one page and its data; use it in a `with` block.

    Args:
        hub: What the page shows and asks.
        page: The page.
        host: What to bind to.
        port: The port. If 0, a free one is taken.
        access: Decides who may connect. By default, it has a new token for this host.

    Attributes:
        host: What it is bound to.
        port: The port it listens on.

    Raises:
        InputError: If it cannot listen there.
    """

    def __init__(
        self, hub: Hub, page: Page, *, host: str = "127.0.0.1", port: int = PORT, access: Access | None = None
    ) -> None:
        self._hub, self._page = hub, page
        self._access = Access(host) if access is None else access
        self._packed = gzip.compress(page.html.encode(), 9)
        self._connections = _Connections()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._ending: asyncio.Event | None = None
        self._started = threading.Event()
        self._error: OSError | None = None
        self.host, self.port = host, port
        self._thread = threading.Thread(target=self._run, name="trundle-page", daemon=True)
        self._thread.start()
        self._started.wait(_START_S)
        if self._error is not None:
            raise InputError(_explain_bind(self._error, host, port)) from self._error

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def address(self) -> str:
        """The address of the page, with its token."""
        host = {"0.0.0.0": "127.0.0.1", "::": "[::1]", "": "127.0.0.1"}.get(self.host, self.host)
        host = f"[{host}]" if ":" in host and not host.startswith("[") else host
        return f"http://{host}:{self.port}/?token={self._access.token}"

    def close(self) -> None:
        """Disconnect all pages and stop listening; closing twice does nothing."""
        loop, ending = self._loop, self._ending
        if loop is not None and ending is not None and self._thread.is_alive():
            with contextlib.suppress(RuntimeError):  # the loop has just ended
                loop.call_soon_threadsafe(ending.set)
            self._thread.join(_CLOSE_S + _START_S)

    # The server's thread --------------------------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except OSError as error:
            self._error = error
        finally:
            self._started.set()

    async def _serve(self) -> None:
        self._loop, self._ending = asyncio.get_running_loop(), asyncio.Event()
        async with serve(
            self._talk,
            self.host,
            self.port,
            process_request=self._answer,
            create_connection=cast("type[ServerConnection]", partial(_Connection, self._connections)),
            compression=None,
            max_size=MAX_BYTES,
            max_queue=32,
            open_timeout=HANDSHAKE_S,
            ping_interval=_PING_S,
            ping_timeout=_PING_S,
            close_timeout=_CLOSE_S,
            server_header=None,
            logger=_silent_logger(),
        ) as server:
            self.port = _port_of(server)
            self._started.set()
            ticking = asyncio.create_task(self._tick())
            try:
                await self._ending.wait()
            finally:
                ticking.cancel()

    async def _tick(self) -> None:
        while True:
            began = time.monotonic()
            try:
                self._hub.tick()
            except Exception as error:  # noqa: BLE001 - one step that cannot be shown does not end the page
                _LOGGER.warning("the page leaves something out: %s: %s", type(error).__name__, error)
            period = TICK_S if len(self._hub) else _IDLE_TICK_S
            await asyncio.sleep(max(0.2 * period, period - (time.monotonic() - began)))

    async def _talk(self, connection: ServerConnection) -> None:
        """Talk to one page, from its connection to its end."""
        if self._hub.is_full:
            await connection.close(1013, "too many pages are connected")
            return
        client = self._hub.connect()
        feeding = asyncio.create_task(self._feed(connection, client))
        try:
            async for data in connection:
                self._hub.receive(client, data)
        except TooManyMessagesError as error:
            await connection.close(1008, str(error))
        except ConnectionClosed:
            pass
        finally:
            self._hub.disconnect(client)
            feeding.cancel()

    async def _feed(self, connection: ServerConnection, client: Client) -> None:
        with contextlib.suppress(ConnectionClosed):
            while True:
                await client.wake.wait()
                client.wake.clear()
                while (text := client.take(self._hub.feed)) is not None:
                    await connection.send(fragments(text) if is_long(text) else text)

    # HTTP -----------------------------------------------------------------------------------------------------------

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """Return the answer to a request; None for a page that may open its WebSocket."""
        opened = cast("_Connection", connection)
        response = self._route(opened, request)
        if response is not None and not opened.hold(len(response.body)):
            return _respond(503, "busy: try again later")
        return response

    def _route(self, connection: _Connection, request: Request) -> Response | None:
        headers, access = request.headers, self._access
        if getattr(request, "method", "GET") != "GET":  # websockets below 16 parses nothing else
            return _respond(405, "only GET is answered", extra={"Allow": "GET"})
        hosts = headers.get_all("Host")
        if not access.allows_host(hosts):
            return _respond(403, "this name is not the server's: open the address that trundle printed")
        path, _, query = request.path.partition("?")
        is_socket = path == "/ws"
        if not access.allows_origin(headers.get_all("Origin"), hosts[0], required=is_socket):
            return _respond(403, "requests from other sites are refused")
        tokens = parse_qs(query).get("token", [])
        if path == "/" and tokens:
            if self._is_let_in(tokens):
                return self._welcome() if connection.admit() else _respond(503, _TOO_MANY)
            return _respond(403, "this token is not the server's: open the address that trundle printed")
        if path == "/frame" and self._page.framed_csp is not None and self._is_let_in(tokens):
            return self._send_page(headers, self._page.framed_csp) if connection.admit() else _respond(503, _TOO_MANY)
        framed = is_socket and self._page.framed_csp is not None and self._is_let_in(tokens)
        if not framed and not access.has_cookie(headers.get_all("Cookie")):
            return _respond(401, "open the address that trundle printed, with its token")
        if not connection.admit():
            return _respond(503, _TOO_MANY)
        if is_socket:
            return None
        if path == "/":
            return self._send_page(headers, self._page.csp)
        return self._send_file(path)

    def _is_let_in(self, tokens: list[str]) -> bool:
        return len(tokens) == 1 and self._access.has_token(tokens[0])

    def _welcome(self) -> Response:
        """Set the cookie, and let the browser load the page: a redirect from another site would carry no cookie."""
        html = '<!doctype html><meta http-equiv="refresh" content="0;url=/"><title>trundle</title>'
        return _respond(200, html, kind="text/html; charset=utf-8", extra={"Set-Cookie": self._access.set_cookie()})

    def _send_page(self, headers: Headers, policy: str) -> Response:
        extra = {"Content-Security-Policy": policy, "Vary": "Accept-Encoding"}
        if policy != self._page.csp:
            extra["X-Frame-Options"] = ""  # it knows no list: left out, frame-ancestors decides
        if "gzip" in ",".join(headers.get_all("Accept-Encoding")):
            return _respond(
                200, self._packed, kind="text/html; charset=utf-8", extra={**extra, "Content-Encoding": "gzip"}
            )
        return _respond(200, self._page.html, kind="text/html; charset=utf-8", extra=extra)

    def _send_file(self, path: str) -> Response:
        found = find_run_file(self._hub.folders, path)
        if found is None:
            return _respond(404, "there is no such page")
        number, folder, name = found
        try:
            if not name:
                return _respond(200, list_run_files(number, folder), kind="text/html; charset=utf-8")
            return _respond_file(read_run_file(folder, name), name)
        except TooLargeError as error:
            return _respond(413, str(error))
        except OSError:
            return _respond(404, "there is no such file in the folder of the run")


class _Connections:
    """What is open, and how much of answers waits to be read.

    Attributes:
        strangers: Connections without cookie or token, the oldest first.
        owners: Connections with one.
        bytes: Size of the answers that wait to be read.
    """

    def __init__(self) -> None:
        self.strangers: dict[_Connection, None] = {}
        self.owners: set[_Connection] = set()
        self.bytes = 0


class _Connection(ServerConnection):
    """A connection that is counted."""

    def __init__(self, connections: _Connections, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._connections = connections
        self._held = 0

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Count it as a stranger's; where there are too many, the oldest of these is closed."""
        super().connection_made(transport)
        strangers = self._connections.strangers
        if len(strangers) >= MAX_STRANGERS:
            oldest = next(iter(strangers))
            del strangers[oldest]
            oldest.transport.abort()
        strangers[self] = None

    def connection_lost(self, exc: Exception | None) -> None:
        """Remove a client from the count."""
        self._connections.strangers.pop(self, None)
        self._connections.owners.discard(self)
        self._connections.bytes -= self._held
        super().connection_lost(exc)

    def admit(self) -> bool:
        """Admit a client that has the cookie; return False if all places for these are taken."""
        if len(self._connections.owners) >= MAX_OWNERS:
            return False
        self._connections.strangers.pop(self, None)
        self._connections.owners.add(self)
        return True

    def hold(self, size: int) -> bool:
        """Count an answer of this size [bytes]; False where too much waits to be read."""
        if self._connections.bytes + size > MAX_BODIES_BYTES:
            return False
        self._held += size
        self._connections.bytes += size
        return True


def _respond(
    status: int,
    body: str | bytes,
    *,
    kind: str = "text/plain; charset=utf-8",
    extra: dict[str, str] | None = None,
) -> Response:
    reasons = {
        200: "OK",
        401: "Unauthorized",
        403: "Forbidden",
        404: "Not Found",
        405: "Method Not Allowed",
        413: "Content Too Large",
    }
    content = body.encode() if isinstance(body, str) else body
    fields = {
        **_BASE_HEADERS,
        "Content-Security-Policy": _NOTHING,
        "Content-Type": kind,
        "Content-Length": str(len(content)),
        "Connection": "close",
        **(extra or {}),
    }
    sent = {name: value for name, value in fields.items() if value}
    return Response(status, reasons.get(status, "Service Unavailable"), Headers(sent), content)


def _respond_file(file: ServedFile, name: str) -> Response:
    extra = {"Content-Security-Policy": _SANDBOX}
    if file.is_download:
        extra["Content-Disposition"] = f'attachment; filename="{name}"'
    return _respond(200, file.content, kind=file.kind, extra=extra)


def _port_of(server: Server) -> int:
    return next(iter(server.sockets)).getsockname()[1]


def _explain_bind(error: OSError, host: str, port: int) -> str:
    where = f"{host}:{port}"
    if isinstance(error, PermissionError):
        return f"the page cannot be served on {where}: ports below 1024 are reserved; give another --port"
    if "in use" in str(error):
        return f"the page cannot be served on {where}: the port is in use; give another --port, or 0 for a free one"
    return f"the page cannot be served on {where}: {error}; give another --host or --port"


def _silent_logger() -> logging.Logger:
    """Return a logger for websockets that prints nothing: what foreign clients do wrong is nothing for the terminal."""
    logger = logging.getLogger("trundle.serve.sockets")
    logger.propagate = False
    logger.setLevel(logging.CRITICAL + 1)
    return logger
