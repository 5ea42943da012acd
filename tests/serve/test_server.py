"""What the server lets in, and what it sends, by real sockets."""

import contextlib
import gzip
import json
import socket
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar
from urllib.parse import urlsplit

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from serve.conftest import Served
from support.page_visitor import WAIT_S
from trundle.errors import InputError
from trundle.serve import server as server_module
from trundle.serve.page_messages import Order
from trundle.serve.server import Page, PageServer

Answer = TypeVar("Answer")


def test_the_printed_address_lets_in_and_the_page_carries_its_policy(served: Served) -> None:
    visitor = served.visit()
    assert urlsplit(served.server.address).hostname == "127.0.0.1"
    status, headers, body = visitor.see("/")
    assert (status, body) == (200, b"<!doctype html><title>trundle</title>")
    assert headers["Content-Security-Policy"] == "default-src 'none'"
    assert headers["X-Content-Type-Options"] == "nosniff"
    assert headers["Referrer-Policy"] == "no-referrer"
    assert headers["Cache-Control"] == "no-store"
    status, headers, body = visitor.get("/", Cookie=visitor.cookie, Accept_Encoding="gzip, br")
    assert gzip.decompress(body) == b"<!doctype html><title>trundle</title>"


def test_the_cookie_is_for_this_site_and_no_script(served: Served) -> None:
    visitor = served.visit()
    _, headers, body = visitor.get(f"/?token={visitor.token}")
    assert headers["Set-Cookie"].endswith("; Path=/; HttpOnly; SameSite=Strict")
    assert visitor.token.encode() not in body


@pytest.mark.parametrize("path", ["/", "/ws", "/runs/1/report.html", "/nothing"])
def test_without_the_cookie_there_is_nothing(served: Served, path: str) -> None:
    visitor = served.visit()
    assert visitor.get(path, Origin=f"http://{visitor.host}")[0] == 401
    assert visitor.get(path, Origin=f"http://{visitor.host}", Cookie="trundle=x; other=y")[0] == 401


@pytest.mark.parametrize("query", ["?token=", "?token=wrong", "?token=a&token=b", "?token=%00%ff"])
def test_a_wrong_token_is_refused(served: Served, query: str) -> None:
    assert served.visit().get(f"/{query}")[0] in (401, 403)


def test_a_name_that_resolves_here_is_refused(served: Served) -> None:
    visitor = served.visit()
    for host in ("evil.example", f"evil.example:{visitor.port}", "10.0.0.1"):
        assert visitor.get("/", Host=host, Cookie=visitor.cookie)[0] == 403


def test_a_forwarded_port_is_accepted(served: Served) -> None:
    visitor = served.visit()
    assert visitor.get("/", Host="localhost:9000", Cookie=visitor.cookie)[0] == 200


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1", "https://localhost"])
def test_sockets_of_other_sites_are_refused(served: Served, origin: str) -> None:
    visitor = served.visit()
    with pytest.raises(InvalidStatus, match="403"):
        visitor.open(origin=origin)
    assert visitor.get("/", Cookie=visitor.cookie, Origin=origin)[0] == 403


def test_a_socket_needs_origin_and_cookie(served: Served) -> None:
    visitor = served.visit()
    with pytest.raises(InvalidStatus, match="403"):
        visitor.open(origin=None)
    with pytest.raises(InvalidStatus, match="401"):
        visitor.open(cookie=None)
    assert len(served.hub) == 0


def test_only_files_of_given_runs_are_sent(served: Served, tmp_path: Path) -> None:
    run = tmp_path / "run"
    run.mkdir()
    (run / "report.html").write_text("report")
    (tmp_path / "secret").write_text("secret")
    (run / "link").symlink_to(tmp_path / "secret")
    served.hub.folders[4] = run
    visitor = served.visit()
    status, headers, body = visitor.see("/runs/4/report.html")
    assert (status, body) == (200, b"report")
    assert headers["Content-Security-Policy"].startswith("sandbox allow-scripts")
    assert visitor.see("/runs/4/")[0] == 200
    for path in (
        "/runs/4/link",
        "/runs/4/../secret",
        "/runs/4/..%2fsecret",
        "/runs/4/%2e%2e/secret",
        "/runs/4//etc/passwd",
        "/runs/4/report.html/../../secret",
        "/runs/5/report.html",
        "/runs/4",
        "/etc/passwd",
        "//evil.example/",
        "/runs/4/report.html%00",
    ):
        assert visitor.see(path)[0] == 404, path


def test_a_page_gets_hello_and_the_drivers(served: Served) -> None:
    with served.visit().open() as page:
        hello = page.wait("hello")
        assert hello["you_drive"]
        assert (hello["state"], hello["source"], hello["clients"]) == ("running", "warehouse", 1)
        assert "nova_carter" in hello["choices"]["robots"]
        assert hello["lacks"] == []
        assert page.wait("drivers") == {"type": "drivers", "driver": hello["client"], "request": None, "clients": 1}


def test_only_the_driver_is_obeyed_and_a_takeover_is_seen_by_all(served: Served) -> None:
    visitor = served.visit()
    with visitor.open() as first, visitor.open() as second:
        one, two = first.wait("hello")["client"], second.wait("hello")["client"]
        second.send("goal", pose=[1, 2, None])
        assert "another page drives" in second.wait("error")["text"]
        first.send("goal", pose=[1, 2, None])
        first.ping()
        assert [type(message) for message, _ in served.controls.asked] == [Order]
        second.send("drive")
        assert first.wait("drivers", lambda message: message["request"] == two)["driver"] == one
        first.send("drive", answer="grant")
        for page in (first, second):
            assert page.wait("drivers", lambda message: message["driver"] == two)["request"] is None
        assert served.controls.left == [one]
        first.send("goal", pose=[1, 2, None])
        assert "another page drives" in first.wait("error")["text"]


def test_a_driver_that_is_cut_off_lets_go(served: Served) -> None:
    visitor = served.visit()
    with visitor.open() as second_driver, visitor.open() as other:
        gone = second_driver.wait("hello")["client"]
        mine = other.wait("hello")["client"]
        second_driver.socket.socket.shutdown(socket.SHUT_RDWR)
        other.wait("drivers", lambda message: message["driver"] is None)
        assert served.controls.left == [gone]
        other.send("drive")
        other.wait("drivers", lambda message: message["driver"] == mine)


def test_messages_that_cannot_be_read_are_answered_and_then_end_the_connection(served: Served) -> None:
    with served.visit().open() as page:
        page.socket.send("{")
        assert "message refused" in page.wait("error")["text"]
        for _ in range(30):
            page.socket.send("[]")
        with pytest.raises(ConnectionClosed, match="cannot be read"):
            page.wait("nothing")
    assert served.controls.asked == []


def test_too_many_messages_end_the_connection(served: Served) -> None:
    with served.visit().open() as page:
        with contextlib.suppress(ConnectionClosed):
            for _ in range(400):
                page.send("ping", echo=1)
        with pytest.raises(ConnectionClosed, match="too many messages"):
            page.wait("nothing")


def test_a_message_that_is_too_large_ends_the_connection(served: Served) -> None:
    with served.visit().open() as page:
        page.socket.send("x" * 20_000)
        with pytest.raises(ConnectionClosed):
            page.wait("nothing")


def test_bytes_are_refused(served: Served) -> None:
    with served.visit().open() as page:
        page.socket.send(b"\x00\xff")
        assert "send text" in page.wait("error")["text"]


def test_fifty_pages_are_served_and_more_than_the_limit_refused(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("trundle.serve.hub.MAX_CLIENTS", 50)
    visitor = served.visit()
    pages = [visitor.open() for _ in range(50)]
    try:
        assert [page.wait("hello")["client"] for page in pages] == list(range(1, 51))
        with visitor.open() as refused, pytest.raises(ConnectionClosed, match="too many pages"):
            refused.wait("hello")
    finally:
        for page in pages:
            page.close()


def _patiently(ask: Callable[[], Answer]) -> Answer:
    """Ask a server until it answers: it drops connections, also those of who is slow to speak."""
    end = time.monotonic() + WAIT_S
    while True:
        try:
            return ask()
        except OSError:
            assert time.monotonic() < end, "the server did not recover"


def test_connections_that_say_nothing_are_closed(impatient: Served) -> None:
    visitor = _patiently(impatient.visit)
    with socket.create_connection(("127.0.0.1", visitor.port)) as silent:
        silent.settimeout(WAIT_S)
        silent.sendall(b"GET / HTTP/1.1\r\nHost: ")
        while silent.recv(4096):
            pass  # the server answers or not, and closes
    assert _patiently(lambda: visitor.see("/"))[0] == 200


def test_more_connections_than_the_limit_are_closed_at_once(impatient: Served, monkeypatch: pytest.MonkeyPatch) -> None:
    visitor = _patiently(impatient.visit)
    monkeypatch.setattr(server_module, "MAX_STRANGERS", 8)
    silent = [socket.create_connection(("127.0.0.1", visitor.port)) for _ in range(12)]
    try:
        assert any(_is_closed(one) for one in silent)
    finally:
        for one in silent:
            one.close()
    # The server notices closed connections in its own time.
    assert _patiently(lambda: visitor.see("/"))[0] == 200


def test_half_open_connections_do_not_keep_out_who_has_the_cookie(served: Served) -> None:
    visitor = served.visit()
    with contextlib.ExitStack() as stack:
        for number in range(300):
            silent = stack.enter_context(socket.create_connection(("127.0.0.1", visitor.port)))
            if number % 2:
                silent.sendall(b"GET / HTTP/1.1\r\nHost: ")
        assert visitor.see("/")[0] == 200
        assert visitor.get(f"/?token={visitor.token}")[0] == 200
        with visitor.open() as page:
            page.wait("hello")


def test_pages_of_the_owner_are_counted_apart_and_refused_with_a_reason(
    served: Served, monkeypatch: pytest.MonkeyPatch
) -> None:
    visitor = served.visit()
    monkeypatch.setattr(server_module, "MAX_OWNERS", 1)
    with visitor.open():
        status, _, body = visitor.see("/")
        assert (status, body) == (503, b"too many connections are open: close other pages of this server")
        assert visitor.get("/")[0] == 401


@pytest.mark.parametrize("method", ["HEAD", "TRACE", "OPTIONS", "PUT", "DELETE", "PATCH", "PROPFIND", "get", "GETX"])
@pytest.mark.parametrize("path", ["/", "/ws", "/nothing"])
def test_nothing_but_get_is_answered(served: Served, method: str, path: str) -> None:
    visitor = served.visit()
    head = f"{method} {path} HTTP/1.1\r\nHost: {visitor.host}\r\nCookie: {visitor.cookie}\r\n\r\n"
    with socket.create_connection(("127.0.0.1", visitor.port)) as raw:
        raw.settimeout(WAIT_S)
        raw.sendall(head.encode())
        answer = b""
        while data := raw.recv(4096):
            answer += data
    assert answer.startswith(b"HTTP/1.1 405 Method Not Allowed\r\n")
    assert b"\r\nAllow: GET\r\n" in answer
    assert visitor.cookie.encode() not in answer


def _is_closed(connection: socket.socket) -> bool:
    connection.settimeout(1.0)
    try:
        return connection.recv(1) == b""
    except TimeoutError:
        return False
    except OSError:
        return True


@pytest.mark.parametrize(
    "request_line",
    [
        b"POST / HTTP/1.1",
        b"GET http://evil.example/ HTTP/1.1",
        b"OPTIONS * HTTP/1.1",
        b"\x16\x03\x01\x02\x00",
        b"GET / HTTP/1.1\r\nHost: a\r\nHost: b",
        b"GET /" + b"a" * 20_000 + b" HTTP/1.1",
        b"GET /ws HTTP/1.1\r\nUpgrade: websocket",
    ],
)
def test_what_is_no_request_of_a_page_gets_nothing(served: Served, request_line: bytes) -> None:
    visitor = served.visit()
    with socket.create_connection(("127.0.0.1", visitor.port)) as raw:
        raw.settimeout(WAIT_S)
        raw.sendall(request_line + b"\r\n\r\n")
        answer = b""
        try:
            while data := raw.recv(4096):
                answer += data
        except ConnectionResetError:
            pass
    assert b" 200 " not in answer.split(b"\r\n")[0]
    assert b" 101 " not in answer.split(b"\r\n")[0]
    assert visitor.see("/")[0] == 200


def test_a_port_that_is_taken_is_named(served: Served) -> None:
    with pytest.raises(
        InputError, match=rf"127\.0\.0\.1:{served.server.port}: the port is in use; give another --port"
    ):
        PageServer(served.hub, Page("", ""), port=served.server.port)


def test_a_host_that_is_not_here_is_named(served: Served) -> None:
    with pytest.raises(InputError, match=r"cannot be served on 192\.0\.2\.1:0"):
        PageServer(served.hub, Page("", ""), host="192.0.2.1", port=0)


def test_a_server_that_is_closed_closes_its_pages(served: Served) -> None:
    with served.visit().open() as page:
        page.wait("hello")
        served.server.close()
        with pytest.raises(ConnectionClosed):
            page.wait("nothing")
    served.server.close()


def test_what_is_announced_reaches_one_or_all(served: Served) -> None:
    visitor = served.visit()
    with visitor.open() as first, visitor.open() as second:
        one = first.wait("hello")["client"]
        second.wait("hello")
        served.hub.announce("to one", to=one)
        served.hub.announce("to all")
        assert first.wait("error")["text"] == "to one"
        assert second.wait("error")["text"] == "to all"


def test_json_is_ascii(served: Served) -> None:
    served.hub.announce("größer")
    with served.visit().open() as page:
        page.wait("hello")
        served.hub.announce("größer")
        raw = page.wait("error")
        assert json.dumps(raw, ensure_ascii=True).isascii()
