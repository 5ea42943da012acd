"""The live page against a server that the test plays: what it sends, and what it shows."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from browser.conftest import ADDRESS, still, until
from browser.gestures import drag, middle
from trundle.page.encoding import pack_array

pytestmark = pytest.mark.browser


def test_a_run_is_set_up_with_a_start_and_a_goal_from_the_map(idle: Any, played: Any) -> None:
    idle.select_option("#robot", "jackal")
    assert played.wait_for("preview")[0] == {"type": "preview", "world": "hall", "robot": "jackal"}
    idle.click("#set-start")
    drag(idle, 0, -40)
    drag(idle, 60, 0)
    idle.fill("#seed", "7")
    idle.click("#go")
    setup = played.wait_for("setup")[0]
    assert (setup["world"], setup["robot"], setup["seed"]) == ("hall", "jackal", 7)
    assert setup["start"][:2] == pytest.approx([0.0, 0.0], abs=0.2)
    assert setup["start"][2] == pytest.approx(math.pi / 2, abs=0.05)
    assert setup["goal"][2] == pytest.approx(0.0, abs=0.05)


def test_a_click_sets_a_goal_and_a_drag_its_heading(driving: Any, played: Any) -> None:
    driving.click("#goal")
    drag(driving, 0, 0)
    driving.click("#goal")
    drag(driving, -50, 0)
    clicked, dragged = played.wait_for("goal", 2)
    assert clicked["pose"][:2] == pytest.approx([0.0, 0.0], abs=0.2)
    assert (clicked["pose"][2], clicked["append"]) == (None, False)
    assert abs(dragged["pose"][2]) == pytest.approx(math.pi, abs=0.05)


def test_a_goal_is_set_with_keys_alone(driving: Any, played: Any) -> None:
    driving.keyboard.press("g")
    for key in ("ArrowRight", "ArrowRight", "ArrowUp", "q", "Enter"):
        driving.keyboard.press(key)
    x, y, yaw = played.wait_for("goal")[0]["pose"]
    assert (x, y) == (pytest.approx(2 * y), pytest.approx(x / 2))
    assert y > 0.0
    assert yaw == pytest.approx(math.pi / 12)
    assert [message for message in played.got if message["type"] == "manual"] == []


BELIEF = {
    "pose": [-2.0, 0.5, 0.0],
    "state": "ambiguous",
    "ellipse": [0.5, 0.3, 0.4],
    "places": [[-2.0, 0.5, 0.0, 0.5], [2.0, -2.0, 1.0, 0.3], [3.0, 2.0, -1.0, 0.2]],
    "particles": pack_array(np.random.default_rng(1).normal(0.0, 30.0, (200, 3)), "i2"),
}


def locate(played: Any) -> None:
    """The run that is shown has a localizer that is in doubt."""
    run = played.recorded.run
    played.send("run", info={**run["info"], "localizer": "amcl"}, n=2)
    rows = [[*row[:-4], row[1] + 0.3, row[2] + 0.4, row[3], "ambiguous"] for row in run["rows"][:40]]
    played.send("log", **{"from": 0, "rows": rows, "paths": run["paths"], "events": run["events"][:2]})
    played.frame(belief=BELIEF)


def test_a_pose_is_set_and_searched_only_where_there_is_a_localizer(driving: Any, played: Any) -> None:
    assert not driving.locator("#set-pose").is_visible()
    assert not driving.locator("#find-pose").is_visible()
    assert not driving.locator("#status .located").is_visible()
    locate(played)
    driving.wait_for_selector("#set-pose:not([disabled])")
    driving.click("#set-pose")
    drag(driving, 40, 0)
    (told,) = played.wait_for("pose")
    assert told["pose"][:2] == pytest.approx([0.0, 0.0], abs=0.2)
    assert told["pose"][2] == pytest.approx(0.0, abs=0.05)
    assert told["covariance"] == [[0.25, 0, 0], [0, 0.25, 0], [0, 0, 0.0685]]
    assert driving.locator("#set-pose").get_attribute("aria-pressed") == "false"
    driving.keyboard.press("p")
    drag(driving, 0, 0)  # without a drag the robot keeps the heading that it believes to have
    assert played.wait_for("pose", 2)[1]["pose"][2] == pytest.approx(played.recorded.run["rows"][39][3], abs=1e-6)
    driving.click("#find-pose")
    assert played.wait_for("reinitialize")
    assert not any(message["type"] == "goal" for message in played.got)


def test_what_a_server_cannot_do_is_not_offered(driving: Any, played: Any) -> None:
    locate(played)
    names = ("#restart", "#next", "#box", "#speed", "#find-pose")
    driving.wait_for_selector("#pause:not([disabled])")
    assert all(driving.locator(name).is_visible() for name in names)
    played.begin(state="running", lacks=["restart", "box", "speed", "find"])
    locate(played)
    driving.wait_for_selector("#box", state="hidden")
    assert not any(driving.locator(name).is_visible() for name in names)
    assert all(driving.locator(name).is_visible() for name in ("#pause", "#goal", "#end"))
    driving.keyboard.press("b")
    assert driving.locator("#box").get_attribute("aria-pressed") == "false"


def test_what_the_localizer_says_is_shown_with_the_error_of_its_estimate(driving: Any, played: Any) -> None:
    locate(played)
    said = driving.locator("#status .located", has_text="ambiguous: 3 places")
    said.wait_for()
    driving.locator("#status dl div", has_text="Estimate off by").locator("dd", has_text="0.500 m").wait_for()
    driving.click("#language")
    driving.locator("#status .located", has_text="불확실: 후보 3곳").wait_for()
    driving.click("#language")
    with_all = still(driving, "#map")
    driving.click(".layers summary")
    driving.uncheck("#layer-particles")
    driving.uncheck("#layer-estimate")
    until(driving, lambda: driving.locator("#map").screenshot() != with_all)


def test_goals_are_queued_with_shift_or_the_switch(driving: Any, played: Any) -> None:
    driving.click("#goal")
    driving.keyboard.down("Shift")
    drag(driving, 0, 0)
    driving.keyboard.up("Shift")
    driving.keyboard.press("Escape")
    driving.check("#queue")
    driving.click("#goal")
    drag(driving, 0, 0)
    assert [goal["append"] for goal in played.wait_for("goal", 2)] == [True, True]


def test_pause_step_speed_box_and_restart_are_sent(driving: Any, played: Any) -> None:
    driving.click("#pause")
    assert played.wait_for("pause")[0]["paused"] is True
    played.frame(paused=True)
    driving.wait_for_selector("#step:not([disabled])")
    driving.wait_for_selector("#status .doing:text-is('paused · driving to the goal')")
    driving.click("#step")
    driving.locator("#speed").focus()
    for _ in range(4):
        driving.keyboard.press("ArrowRight")
    assert [message["factor"] for message in played.wait_for("speed", 4)] == [2, 3, 5, 10]
    driving.locator("#speed").press("End")
    assert played.wait_for("speed", 5)[-1]["factor"] == "max"
    driving.click("#box")
    drag(driving, 0, 0)
    assert played.wait_for("box")[0]["size"] == [0.4, 0.4, 0.6]
    driving.click("#restart")
    driving.click("#next")
    assert [message["seed"] for message in played.wait_for("restart", 2)] == [None, "next"]
    driving.click("#end")
    assert played.wait_for("end")
    assert played.wait_for("step")


@pytest.mark.parametrize(("key", "sign"), [("w", (1, 0)), ("ArrowLeft", (0, 1)), ("d", (0, -1))])
def test_a_held_key_drives_until_it_is_let_go(driving: Any, played: Any, key: str, sign: tuple[int, int]) -> None:
    driving.keyboard.down(key)
    sent = played.wait_for("manual", 3)[0]
    driving.keyboard.up(key)
    played.wait_for("release")
    assert (math.copysign(1, sent["v"]) * bool(sent["v"]), math.copysign(1, sent["w"]) * bool(sent["w"])) == sign


def test_the_stick_drives_and_a_page_that_loses_focus_lets_go(driving: Any, played: Any) -> None:
    x, y = middle(driving, ".stick")
    driving.mouse.move(x, y)
    driving.mouse.down()
    driving.mouse.move(x, y - 60)
    sent = played.wait_for("manual", v=0.0)
    assert sent[-1]["v"] == pytest.approx(played.recorded.scene["robot"]["limits"]["v"])
    driving.mouse.up()
    played.wait_for("release")
    driving.keyboard.down("w")
    played.wait_for("manual", 4)
    driving.evaluate("window.dispatchEvent(new Event('blur'))")
    played.wait_for("release", 2)


def test_it_says_when_a_command_by_hand_was_held_back(driving: Any, played: Any) -> None:
    played.frame(manual=1, held_back="obstacle ahead at (2.00, 3.50)")
    driving.get_by_text("Held back: obstacle ahead at (2.00, 3.50)").wait_for()


def test_one_drives_and_the_others_ask(open_page: Any, played: Any) -> None:
    played.opening = lambda: played.begin(driver=7, state="running")
    tab, _ = open_page(ADDRESS, prepare=played.attach)
    tab.wait_for_selector("#drive")
    played.run()
    tab.wait_for_selector("#status .doing:text('driving')")
    assert tab.locator("#pause").is_disabled()
    assert tab.locator("#goal").is_disabled()
    tab.keyboard.press("w")
    tab.click("#drive")
    assert played.wait_for("drive")[0]["answer"] is None
    assert [message["type"] for message in played.got] == ["drive"]
    played.send("drivers", driver=1, request=2, clients=3)
    tab.click("#grant")
    assert played.wait_for("drive", 2)[-1]["answer"] == "grant"
    assert tab.locator("#pause").is_enabled()


def test_a_page_that_reconnects_has_the_whole_trail(driving: Any, played: Any) -> None:
    rows = played.recorded.run["rows"]

    def again() -> None:
        played.begin(state="running")
        played.run(rows=len(rows))

    played.opening = again
    played.sockets[-1].close()
    driving.get_by_text("Connection lost").wait_for()
    assert driving.locator("#pause").is_disabled()
    end = f"0:{rows[-1][0]:05.2f}"
    driving.wait_for_function("end => document.querySelector('#status dd').textContent === end", arg=end)
    assert len(played.sockets) == 2
    assert driving.locator("#pause").is_enabled()


def test_the_outcome_links_to_the_replay(driving: Any, played: Any) -> None:
    played.send("end", outcome="arrived", message="arrived after 9.0 s", folder="runs/1", replay="/runs/1/report.html")
    driving.wait_for_selector(".outcome a")
    assert driving.locator(".outcome a").get_attribute("href") == "/runs/1/report.html"
    assert driving.locator(".outcome .verdict").inner_text() == "arrived"
    assert driving.locator("#go").is_visible()


def test_refusals_are_shown_and_layers_switch(driving: Any, played: Any) -> None:
    played.send("error", text="the goal (9.00, 9.00) is outside the map")
    driving.get_by_text("the goal (9.00, 9.00) is outside the map").wait_for()
    driving.click(".layers summary")
    before = driving.evaluate("document.querySelector('#map').toDataURL()")
    driving.uncheck("#layer-map")
    driving.uncheck("#layer-trail")
    driving.wait_for_function("before => document.querySelector('#map').toDataURL() !== before", arg=before)


def test_without_webgl_the_map_alone_is_left(driving: Any) -> None:
    assert "no WebGL" in driving.locator("#scene").inner_text()
    assert driving.locator("#map").is_visible()


def test_a_click_on_the_floor_of_the_3d_view_sets_a_goal(open_page: Any, played: Any) -> None:
    tab, seen = open_page(ADDRESS, prepare=played.attach, webgl=True, viewport={"width": 800, "height": 560})
    tab.wait_for_selector("#world option", state="attached")
    played.run()
    tab.wait_for_selector("#pause:not([disabled])")
    tab.click("[data-camera=top]")
    still(tab, "#scene canvas")
    tab.click("#goal")
    drag(tab, 40, 0, "#scene")
    pose = played.wait_for("goal")[0]["pose"]
    assert pose[:2] == pytest.approx([0.0, 0.0], abs=0.3)
    assert pose[2] == pytest.approx(0.0, abs=0.1)
    assert seen.problems == []
    assert {url for url in seen.requests if not url.startswith("data:")} == {ADDRESS}
