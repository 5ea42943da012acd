"""The page of a loop of one's own in Chromium: `trundle.show`, with a loop in this process."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

import pytest

import trundle
from browser.conftest import WAIT_MS, until
from trundle.serve import View
from trundle.worlds import World

pytestmark = pytest.mark.browser


class Loop:
    """A loop at 20 Hz: it says what it gets, and what it shows can be changed."""

    def __init__(self, view: View) -> None:
        self.view = view
        self.shown: dict[str, Any] = {"pose": (-3.0, 0.0, 0.0)}
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()

    def _run(self) -> None:
        while not self._over.wait(0.05):
            goal = "" if self.view.goal is None else f" to {self.view.goal.x:.1f}, {self.view.goal.y:.1f}"
            self.view.update(**self.shown, text=f"keys {' '.join(sorted(self.view.keys))};{goal}")

    def end(self) -> None:
        self._over.set()
        self._thread.join()


@pytest.fixture
def loop(hall: World) -> Iterator[Loop]:
    with trundle.show(hall, "jackal", open_browser=False) as view:
        running = Loop(view)
        yield running
        running.end()


def headline(tab: Any, text: str) -> None:
    tab.wait_for_function("text => document.querySelector('.doing').textContent === text", arg=text)


def click(tab: Any, x: float, y: float) -> None:
    """Click the map of the hall, 10.2 m wide, at a point [m]."""
    box = tab.locator("#map").bounding_box()
    scale = 0.97 * min(box["width"] / 10.2, box["height"] / 8.2)
    tab.mouse.click(box["x"] + box["width"] / 2 + scale * x, box["y"] + box["height"] / 2 - scale * y)


def test_a_clicked_goal_comes_to_the_loop(loop: Loop, open_page: Callable[..., Any]) -> None:
    tab, seen = open_page(loop.view.address)
    headline(tab, "keys ;")
    tab.wait_for_selector("#goal:not([disabled])")
    tab.keyboard.press("g")
    assert tab.locator("#goal").get_attribute("aria-pressed") == "true"
    click(tab, 2.0, -1.0)
    headline(tab, "keys ; to 2.0, -1.0")
    assert loop.view.take_goal() == pytest.approx((2.0, -1.0), abs=0.05)
    assert tab.locator("#goal").get_attribute("aria-pressed") == "false"
    assert seen.problems == []


def test_held_keys_come_to_the_loop_and_none_once_the_page_is_gone(loop: Loop, open_page: Callable[..., Any]) -> None:
    tab, _ = open_page(loop.view.address)
    tab.wait_for_selector("#goal:not([disabled])")
    tab.keyboard.down("W")
    tab.keyboard.down("ArrowUp")
    headline(tab, "keys ArrowUp w;")
    tab.wait_for_timeout(700)  # longer than they count without being told again
    headline(tab, "keys ArrowUp w;")
    assert tab.locator("#keys").inner_text() == "w ArrowUp"
    tab.keyboard.up("W")
    headline(tab, "keys ArrowUp;")
    tab.evaluate("window.dispatchEvent(new Event('blur'))")
    headline(tab, "keys ;")
    tab.keyboard.up("ArrowUp")
    tab.keyboard.down("ArrowUp")
    headline(tab, "keys ArrowUp;")
    tab.context.close()
    end = time.monotonic() + WAIT_MS / 1000.0
    while loop.view.keys:
        assert time.monotonic() < end
        time.sleep(0.02)


def test_keys_while_a_goal_is_chosen_are_not_for_the_loop(loop: Loop, open_page: Callable[..., Any]) -> None:
    tab, _ = open_page(loop.view.address)
    tab.wait_for_selector("#goal:not([disabled])")
    tab.keyboard.press("g")
    tab.keyboard.down("ArrowRight")
    tab.wait_for_timeout(200)
    tab.keyboard.up("ArrowRight")
    headline(tab, "keys ;")
    tab.keyboard.press("Enter")
    tab.wait_for_function("() => document.querySelector('.doing').textContent.includes(' to ')")
    tab.keyboard.down("ArrowRight")  # the map has lost the focus
    tab.wait_for_function("() => document.querySelector('.doing').textContent.startsWith('keys ArrowRight;')")


def test_several_robots_are_drawn_in_3d_and_go_when_they_are_not_given(
    loop: Loop, open_page: Callable[..., Any]
) -> None:
    loop.shown = {
        "pose": {"a": (-3.0, 0.0), "b": (3.0, 0.0), "c": (0.0, -2.0)},
        "path": {"b": [(3.0, 0.0), (0.0, 0.0)]},
    }
    tab, seen = open_page(loop.view.address, webgl=True)
    tab.wait_for_function("() => document.querySelectorAll('.poses dt').length === 4")
    assert tab.locator(".poses dt").all_inner_texts()[1:] == ["a", "b", "c"]
    loop.shown = {"pose": {"b": (3.0, 0.5)}}
    tab.wait_for_function("() => document.querySelectorAll('.poses dt').length === 2")
    # The page drives it there between two updates.
    tab.wait_for_function("() => document.querySelectorAll('.poses dd')[1].textContent === '3.00, 0.50, 0°'")
    assert seen.problems == []


def test_the_page_says_that_the_loop_has_ended_and_does_not_try_again(
    hall: World, open_page: Callable[..., Any]
) -> None:
    with trundle.show(hall, "jackal", open_browser=False) as view:
        view.update((0.0, 0.0), text="the last words")
        tab, _ = open_page(view.address)
        headline(tab, "the last words")
    tab.wait_for_selector(".state[data-state=ended]")
    assert tab.locator(".state").inner_text() == "ended"
    assert tab.locator("#goal").is_disabled()
    tab.wait_for_timeout(1000)
    assert tab.get_by_text("Connection lost").is_hidden()
    headline(tab, "the last words")


@pytest.fixture
def notebook(loop: Loop) -> Iterator[str]:
    """The address of another site of this machine, whose page shows the view as a notebook does."""
    html = f'<!doctype html><html data-drawn="yes"><title>notebook</title>{loop.view._repr_html_()}</html>'.encode()

    class Handler(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(html)

        def log_message(self, *_: object) -> None:  # type: ignore[override]
            pass

    with ThreadingHTTPServer(("127.0.0.1", 0), Handler) as server:
        threading.Thread(target=server.serve_forever).start()
        yield f"http://localhost:{server.server_address[1]}/"
        server.shutdown()


def test_a_notebook_shows_it_in_a_frame_without_cookies(notebook: str, open_page: Callable[..., Any]) -> None:
    tab, _ = open_page(notebook)
    frame = tab.frame_locator("iframe")
    frame.locator(".doing", has_text="keys ;").wait_for()
    frame.locator("#goal:not([disabled])").click()
    frame.locator("#map").click()
    frame.locator(".doing", has_text="to ").wait_for()
    assert tab.context.cookies() == []


def test_a_pose_is_set_on_the_page_of_a_loop_that_tells_what_it_believes(
    loop: Loop, open_page: Callable[..., Any]
) -> None:
    tab, seen = open_page(loop.view.address)
    headline(tab, "keys ;")
    assert not tab.locator("#set-pose").is_visible()
    particles = [(-3.0 + 0.01 * n, 0.0, 0.01 * n) for n in range(50)]
    loop.shown |= {"particles": particles, "covariance": [[0.1, 0, 0], [0, 0.2, 0], [0, 0, 0.1]]}
    tab.wait_for_selector("#set-pose:not([disabled])")
    tab.locator("#status .located", has_text="localized").wait_for()
    tab.click("#set-pose")
    click(tab, 2.0, -1.0)
    told = until(tab, loop.view.take_pose)
    assert (told.x, told.y) == pytest.approx((2.0, -1.0), abs=0.1)
    assert loop.view.goal is None
    assert seen.problems == []
