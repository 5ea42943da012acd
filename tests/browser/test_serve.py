"""The page with the server that it is made for: `trundle serve` in a process of its own."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from browser.conftest import draw
from trundle.mission import Scenario

pytestmark = pytest.mark.browser
WALL_X = -15.0  # The inner face of the warehouse's western wall [m].


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory, chromium: Any) -> Iterator[str]:
    """The address that `trundle serve` prints; a robot stands before the western wall and looks at it."""
    folder = tmp_path_factory.mktemp("serve")
    scenario = Scenario.make(
        name="west",
        world="warehouse",
        seed=4,
        backend="kinematic",
        lidar=True,
        start=(-13.0, 0.0, 3.14159),
        goal=(13.0, 0.0, 1.57),
    )
    scenario.save(folder / "west.yaml")
    command = [sys.executable, "-m", "trundle", "serve", "west.yaml", "--no-open", "--port", "0"]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        yield next(line for line in server.stdout if line.startswith("http")).strip()
        server.terminate()
        server.wait(timeout=120)


@pytest.fixture
def idle(open_page: Callable[..., Any], address: str) -> Any:
    tab, seen = open_page(address)
    tab.wait_for_selector("#world option", state="attached")
    tab.seen = seen
    yield tab
    if tab.locator("#end").is_enabled():
        tab.click("#end")
        tab.wait_for_selector("#go:not([disabled])")


@pytest.fixture
def driving(idle: Any) -> Any:
    idle.click("#go")
    idle.wait_for_selector("#pause:not([disabled])")
    wait_for_time(idle, 0.1)
    return idle


def time_of(tab: Any) -> float:
    minutes, seconds = tab.locator("#status dd").first.inner_text().split(":")
    return 60.0 * float(minutes) + float(seconds)


def settled_time(tab: Any) -> float:
    """The time once the page has caught up, which it does with the pictures that it draws."""
    before = -1.0
    while (now := time_of(tab)) != before:
        before = now
        tab.wait_for_timeout(400)
        draw(tab)
    return now


def wait_for_time(tab: Any, time: float) -> None:
    tab.wait_for_function(
        """least => {
          const [minutes, seconds] = (document.querySelector("#status dd").textContent || "0:0").split(":").map(Number);
          return 60 * minutes + seconds >= least;
        }""",
        arg=time,
    )


def events(tab: Any) -> str:
    return tab.locator(".events").inner_text()


def test_pause_holds_the_time_and_a_step_is_one_control_period(driving: Any) -> None:
    driving.click("#pause")
    driving.wait_for_selector("#step:not([disabled])")
    held = settled_time(driving)
    driving.wait_for_timeout(500)
    assert time_of(driving) == held
    for steps in (1, 2):
        driving.click("#step")
        wait_for_time(driving, held + 0.05 * steps - 0.001)
        assert settled_time(driving) == pytest.approx(held + 0.05 * steps)
    driving.click("#pause")
    wait_for_time(driving, held + 0.3)


def test_ten_times_faster_shows_the_wanted_and_the_real_factor(driving: Any) -> None:
    driving.locator("#speed").focus()
    for _ in range(4):
        driving.keyboard.press("ArrowRight")
    driving.wait_for_function("() => /^× 10 · real × [0-9.]+$/.test(document.querySelector('.speed-text').value)")
    driving.locator("#speed").evaluate("s => { s.value = 3; s.dispatchEvent(new Event('input')); }")


def test_a_goal_from_the_map_is_driven_to(driving: Any) -> None:
    driving.click("#goal")
    box = driving.locator("#map").bounding_box()
    driving.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    driving.wait_for_function("() => document.querySelectorAll('.events .kind-steer, .events .kind-replan').length > 0")
    assert driving.locator(".error").is_hidden()


def test_a_robot_that_has_arrived_waits_for_the_next_goal_until_the_run_is_ended(driving: Any) -> None:
    driving.locator("#speed").evaluate("s => { s.value = 10; s.dispatchEvent(new Event('input')); }")
    for x in (0.07, 0.1):
        driving.click("#goal")
        box = driving.locator("#map").bounding_box()
        driving.mouse.click(box["x"] + x * box["width"], box["y"] + box["height"] / 2)
        driving.wait_for_selector(".state[data-state=running]")
        driving.wait_for_selector(".state[data-state=waiting]")
        held = settled_time(driving)
    driving.wait_for_timeout(500)
    assert time_of(driving) == held
    driving.locator("#speed").evaluate("s => { s.value = 3; s.dispatchEvent(new Event('input')); }")
    driving.click("#end")
    driving.wait_for_selector(".outcome")
    driving.locator("#status .doing", has_text=re.compile(r"^arrived after .*; ended by page \d+$")).wait_for()


def test_a_robot_driven_by_hand_into_a_wall_stops_before_it(driving: Any) -> None:
    driving.keyboard.down("w")
    driving.get_by_text(re.compile("^Held back: ")).wait_for()
    driving.wait_for_timeout(600)
    driving.keyboard.up("w")
    assert "touches" not in events(driving)
    assert driving.locator(".state").get_attribute("data-state") == "running"
    assert float(driving.locator("#status dl div", has_text="Clearance").locator("dd").inner_text().split()[0]) > 0.0


def test_taking_over_is_asked_for_and_granted(driving: Any, open_page: Callable[..., Any], address: str) -> None:
    other, _ = open_page(address)
    other.wait_for_selector("#drive:visible")
    assert other.locator("#pause").is_disabled()
    other.click("#drive")
    driving.click("#grant")
    other.wait_for_selector("#pause:not([disabled])")
    driving.wait_for_selector("#pause[disabled]")
    other.click("#end")
    other.wait_for_selector(".outcome")


def test_a_page_that_reconnects_has_the_whole_trail(open_page: Callable[..., Any], address: str) -> None:
    sockets: list[Any] = []

    def prepare(tab: Any) -> None:
        def pass_on(socket: Any) -> None:
            socket.connect_to_server()
            sockets.append(socket)

        tab.route_web_socket(re.compile("/ws$"), pass_on)

    tab, _ = open_page(address, prepare=prepare)
    tab.wait_for_selector("#go:not([disabled])")
    tab.click("#go")
    tab.wait_for_selector("#pause:not([disabled])")
    wait_for_time(tab, 1.0)
    first = tab.locator(".events li").first.inner_text()
    sockets[-1].close()
    tab.get_by_text("Connection lost").wait_for()
    tab.wait_for_selector("#pause:not([disabled])")
    wait_for_time(tab, 1.5)
    assert len(sockets) == 2
    assert tab.locator(".events li").first.inner_text() == first
    tab.click("#end")
    tab.wait_for_selector(".outcome")


def test_the_end_links_to_a_replay_and_nothing_else_was_asked_for(driving: Any, address: str) -> None:
    host = address.split("?")[0]
    driving.click("#end")
    driving.wait_for_selector(".outcome a")
    with driving.expect_popup() as opened:
        driving.click(".outcome a")
    replay = opened.value
    replay.wait_for_selector("html[data-drawn=yes]")
    replay.wait_for_selector(".report")
    assert replay.locator("#time").is_enabled()
    assert all(url.startswith((host, "data:")) for url in driving.seen.requests)
    assert driving.seen.problems == []
