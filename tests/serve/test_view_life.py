"""A view from its address to its end: opening, several at once, notebooks, closing."""

import subprocess
import sys
import time
from pathlib import Path as FilePath

import numpy as np
import pytest

import trundle
from support.page_visitor import OpenPage, Visitor
from trundle.errors import InputError
from trundle.geometry import Goal
from trundle.serve import View, opening


def visit(view: View) -> OpenPage:
    return Visitor.of_address(view.address).open()


# Opening and closing -------------------------------------------------------------------------------------------------


def test_the_address_is_printed_and_the_page_is_not_opened(capsys: pytest.CaptureFixture[str]) -> None:
    with trundle.show(None, "jackal", open_browser=False) as view:
        assert view.address in capsys.readouterr().out
        assert view.address.startswith("http://127.0.0.1:")


def test_the_page_is_opened_where_there_is_a_browser(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    opened: list[str] = []
    monkeypatch.setattr(opening, "is_remote", lambda: False)
    monkeypatch.setattr(opening, "open_browser", lambda address: opened.append(address) or len(opened) == 1)
    with trundle.show(None, "jackal") as view:
        assert opened == [view.address]
    assert "No browser" not in capsys.readouterr().out
    with trundle.show(None, "jackal"):
        assert "No browser was found here" in capsys.readouterr().out


def test_over_ssh_it_says_how_to_reach_the_page(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SSH_CONNECTION", "here")
    with trundle.show(None, "jackal") as view:
        assert f"ssh -L {view.port}:localhost:{view.port}" in capsys.readouterr().out


def test_two_views_at_once_are_apart(view: View) -> None:
    with trundle.show(None, "nova_carter", open_browser=False) as other:
        view.update((1.0, 0.0))
        other.update((2.0, 0.0))
        with visit(view) as one, visit(other) as two:
            assert one.wait("scene")["scene"]["robot"]["name"] == "jackal"
            assert two.wait("scene")["scene"]["robot"]["name"] == "nova_carter"
            assert one.wait("frame")["robots"][0][1] == 1.0
            assert two.wait("frame")["robots"][0][1] == 2.0
            one.send("goal", pose=[1.0, 1.0, None])
            one.ping()
            assert (view.goal, other.goal) == (Goal(1.0, 1.0), None)


def test_closing_tells_the_pages_and_an_update_after_it_is_refused() -> None:
    with trundle.show(None, "jackal", open_browser=False) as view, visit(view) as page:
        view.update((0.0, 0.0))
        page.wait("frame")
        page.send("keys", held=["w"])
        page.ping()
        view.close()
        page.wait("end")
        assert view.keys == frozenset()
        with pytest.raises(InputError, match=r"this view is closed: .* trundle\.show"):
            view.update((0.0, 0.0))
        view.close()
    assert "closed" in repr(view)
    assert "The view is closed" in view._repr_html_()


def test_a_loop_that_raises_closes_its_view() -> None:
    with pytest.raises(ZeroDivisionError), trundle.show(None, "jackal", open_browser=False) as view:
        1 / 0  # noqa: B018
    with pytest.raises(ConnectionRefusedError):
        Visitor.of_address(view.address)


def test_an_update_never_waits_for_a_page_that_does_not_read(view: View) -> None:
    with visit(view):
        path = np.zeros((20_000, 2))
        began = time.process_time()
        for i in range(200):
            view.update((0.01 * i, 0.0), path=path, text="x" * 1000)
        assert time.process_time() - began < 5.0


def test_nothing_stays_behind_a_program_that_forgets_to_close(tmp_path: FilePath) -> None:
    program = "import trundle; trundle.show(None, 'jackal', open_browser=False).update((0, 0))"
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")


# Safety --------------------------------------------------------------------------------------------------------------


def test_a_notebook_shows_the_page_in_a_frame_of_the_loopback_address(view: View) -> None:
    html = view._repr_html_()
    assert f'<iframe src="http://127.0.0.1:{view.port}/frame?token=' in html
    visitor = Visitor.of_address(view.address)
    status, headers, body = visitor.get(f"/frame?token={visitor.token}")
    assert status == 200
    assert b"trundle" in body
    assert "frame-ancestors http://localhost:* http://127.0.0.1:*" in headers["Content-Security-Policy"]
    assert "X-Frame-Options" not in headers
    assert headers["Referrer-Policy"] == "no-referrer"


def test_a_frame_needs_the_token_and_its_socket_the_origin(view: View) -> None:
    visitor = Visitor.of_address(view.address)
    assert visitor.get("/frame")[0] == 401
    assert visitor.get("/frame?token=wrong")[0] == 401
    assert visitor.get(f"/frame?token={visitor.token}&token={visitor.token}")[0] == 401
    assert visitor.get(f"/frame?token={visitor.token}", Host="evil.example")[0] == 403
    assert visitor.get(f"/frame?token={visitor.token}", Origin="http://evil.example")[0] == 403
    for path, status in (("/ws?token=wrong", 401), (f"/ws?token={visitor.token}", 403)):
        assert (
            visitor.get(path, Origin="http://evil.example" if status == 403 else f"http://{visitor.host}")[0] == status
        )


def test_the_page_itself_must_not_be_framed_and_needs_the_token(view: View) -> None:
    visitor = Visitor.of_address(view.address)
    assert visitor.get("/")[0] == 401
    status, headers, _ = visitor.see("/")
    assert status == 200
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
    assert headers["X-Frame-Options"] == "DENY"
