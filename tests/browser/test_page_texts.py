"""The texts of the live page: languages, names of buttons, keyboard and small screens."""

from __future__ import annotations

import re
from typing import Any

import pytest

from browser.conftest import ADDRESS, draw, still
from browser.gestures import drag, middle

pytestmark = pytest.mark.browser


def test_it_fits_a_phone(open_page: Any, played: Any) -> None:
    tab, seen = open_page(
        ADDRESS, prepare=played.attach, viewport={"width": 390, "height": 844}, locale="ko-KR", reduced_motion="reduce"
    )
    tab.wait_for_selector("#world option", state="attached")
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
    played.run()
    tab.wait_for_selector(".state:text-is('주행 중')")
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
    assert seen.problems == []


def test_the_keyboard_reaches_everything_in_order(driving: Any) -> None:
    reached = []
    driving.evaluate("document.activeElement.blur()")
    for _ in range(40):
        driving.keyboard.press("Tab")
        reached.append(driving.evaluate("document.activeElement.id"))
    order = [name for name in ("language", "pause", "goal", "speed", "map") if name in reached]
    assert order == ["language", "pause", "goal", "speed", "map"]
    assert [reached.index(name) for name in order] == sorted(reached.index(name) for name in order)


def test_a_robot_that_waits_takes_another_goal_and_the_end_is_the_headline(driving: Any, played: Any) -> None:
    played.frame(doing="arrived", waiting=True)
    driving.wait_for_selector(".state[data-state=waiting]")
    driving.wait_for_selector("#status .doing:text-is('arrived · waiting for the next goal')")
    assert driving.locator("#pause").is_disabled()
    driving.click("#goal")
    drag(driving, 0, 0)
    played.wait_for("goal")
    played.frame()
    driving.wait_for_selector(".state[data-state=running]")
    played.send("end", outcome="collided", message="base_link touches crate at (0.00, 1.00) after 4.0 s")
    driving.wait_for_selector(".state:text-is('collided')")
    how = "collided: base_link touches crate at (0.00, 1.00) after 4.0 s"
    driving.wait_for_selector(f"#status .doing:text-is('{how}')")


def test_another_language_changes_all_texts_and_neither_the_camera_nor_the_run(open_page: Any, played: Any) -> None:
    tab, seen = open_page(ADDRESS, prepare=played.attach, webgl=True, viewport={"width": 800, "height": 560})
    tab.wait_for_selector("#world option", state="attached")
    played.run()
    tab.wait_for_selector("#pause:not([disabled])")
    tab.click("[data-camera=top]")
    x, y = middle(tab, "#scene")
    tab.mouse.move(x, y)
    tab.mouse.wheel(0, -600)
    before = still(tab, "#scene canvas")
    sockets, time = len(played.sockets), tab.locator("#status dd").first.inner_text()
    tab.click("#language")
    assert tab.locator("#goal").inner_text() == "목표 지정"
    assert tab.locator("#map").get_attribute("aria-label").startswith("지도")
    tab.wait_for_selector("#status .doing:text-is('목표로 주행 중')")
    assert tab.locator(".state").inner_text() == "주행 중"
    assert tab.evaluate("document.documentElement.lang") == "ko"
    draw(tab)
    assert (len(played.sockets), tab.locator("#status dd").first.inner_text()) == (sockets, time)
    assert tab.locator("[data-camera=top]").get_attribute("aria-pressed") == "true"
    tab.click("#language")
    assert tab.locator("#goal").inner_text() == "Set goal"
    assert still(tab, "#scene canvas") == before
    assert seen.problems == []


def test_what_the_run_says_is_said_in_korean(driving: Any, played: Any) -> None:
    driving.click("#language")
    said = [
        "ambiguous: 3 places",
        "the robot is at one of 2 places: looking around",
        "the robot does not know where it is: looking around",
        "goal 1 of 2 reached",
        "path of 6.00 m",
        "another path of 5.20 m",
        "blocked: obstacle ahead at (2.00, 3.50)",
        "back_up: no progress along the path",
        "back_up failed: blocked at (1.00, 2.00): it would touch something",
        "goal set: (1.00, 2.00)",
        "driven by the navigator again",
        "held back: the collision monitor: stop",
        "the collision monitor slows the robot",
        "base_link touches crate at (0.00, 1.00)",
        "stuck: stuck at (1.00, 2.00, 0.30) after 40.0 s: no progress along the path",
        "arrived: arrived after 9.6 s; ended by page 1",
        "timed out: goal not reached within 60.0 s",
        "no path: no path from (0.00, 0.00) to (4.00, 4.00): they are separated by occupied or unknown space",
        "collided: touched crate while driving; arrived after 9.0 s",
    ]
    events = [{"t": 1.0 + index, "kind": "steer", "text": text} for index, text in enumerate(said)]
    played.send("log", rows=[], paths=[], events=events)
    driving.wait_for_function("() => document.querySelectorAll('.events li').length >= 18")
    shown = driving.locator(".events li span").all_inner_texts()[-len(said) :]
    names = re.compile(r"back_up|base_link|crate|\bm\b")
    assert [text for text in shown if re.search("[A-Za-z]", names.sub("", text))] == []
    driving.click("#language")
    assert driving.locator(".events li span").all_inner_texts()[-len(said) :] == said


def test_every_button_has_a_name_and_only_one_sets_a_goal(idle: Any, played: Any) -> None:
    named = "e => e.filter(b => b.checkVisibility()).map(b => b.getAttribute('aria-label') || b.innerText.trim())"

    def check() -> None:
        names = idle.eval_on_selector_all("button", named)
        assert all(names)
        assert names.count("Set goal") == 1

    check()
    played.run()
    idle.wait_for_selector("#pause:not([disabled])")
    check()
    for name, text in (("box", "Drop box"), ("restart", "Restart"), ("next", "Next seed"), ("end", "End run")):
        assert idle.locator(f"#{name}").inner_text() == text
        assert idle.locator(f"#{name}").get_attribute("title")


@pytest.mark.parametrize("size", [(390, 844), (768, 1024), (1280, 720)])
def test_nothing_is_cut_off_or_over_the_map(open_page: Any, played: Any, size: tuple[int, int]) -> None:
    viewport = {"width": size[0], "height": size[1]}
    tab, _ = open_page(ADDRESS, prepare=played.attach, viewport=viewport)
    tab.wait_for_selector("#world option", state="attached")
    assert tab.locator("#map").bounding_box()["y"] + tab.locator("#map").bounding_box()["height"] <= size[1]
    assert tab.locator(".map-buttons").bounding_box()["x"] >= (
        tab.locator("#map").bounding_box()["x"] + tab.locator("#map").bounding_box()["width"]
    )
    room = """() => {
      const select = document.querySelector("#controller"), style = getComputedStyle(select);
      const pen = document.createElement("canvas").getContext("2d");
      pen.font = `${style.fontSize} ${style.fontFamily}`;
      return select.clientWidth - pen.measureText("regulated_pure_pursuit").width;
    }"""
    assert tab.evaluate(room) > 24  # for the arrow
