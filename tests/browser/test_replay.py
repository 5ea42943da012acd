"""A report in a browser: the replay on top, and what is below it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from browser.conftest import still, until

pytestmark = pytest.mark.browser


def seek(tab: Any, time: float) -> None:
    tab.evaluate(
        "t => { const s = document.querySelector('#time'); s.value = t; s.dispatchEvent(new Event('input')); }", time
    )


def wait_for_figure(tab: Any, name: str, text: str) -> None:
    """The page draws with the next picture, which may take a while."""
    tab.locator("#status dl div", has_text=name).locator("dd", has_text=re.compile(f"^{re.escape(text)}$")).wait_for()


def test_a_report_opens_from_a_file_without_a_request_or_an_error(open_page: Any, report: Path) -> None:
    tab, seen = open_page(report.as_uri(), webgl=True)
    for name in ("scene", "map", "status"):
        assert tab.locator(f"#{name}").count() == 1
    tab.wait_for_selector(".report")
    assert [url for url in seen.requests if not url.startswith("data:")] == [report.as_uri()]
    assert seen.problems == []
    assert tab.locator(".verdict").inner_text() == "arrived"
    assert "</script><b>crate" in tab.locator(".report").inner_text()
    assert tab.locator(".report b").count() == 0
    for text in ("trundle run hall.yaml", "navigation.controller", "0.1.0"):
        assert tab.get_by_text(text, exact=True).count() == 1


def test_the_slider_shows_the_run_at_any_time(open_page: Any, report: Path, recorded: Any) -> None:
    tab, _ = open_page(report.as_uri())
    tab.wait_for_selector(".report")
    before = still(tab, "#map")
    seek(tab, 4.0)
    wait_for_figure(tab, "Time", "0:04.00")
    row = next(row for row in recorded.run["rows"] if abs(row[0] - 4.0) < 1e-6)
    wait_for_figure(tab, "Speed", f"{row[4]:.2f} m/s")
    until(tab, lambda: tab.locator("#map").screenshot() != before)
    seek(tab, 1e9)
    wait_for_figure(tab, "Time", f"0:{recorded.duration:05.2f}")


def test_it_plays_to_the_end_and_stops(open_page: Any, report: Path, recorded: Any) -> None:
    tab, _ = open_page(report.as_uri())
    tab.wait_for_selector(".report")
    tab.select_option("#pace", "20")
    tab.keyboard.press("Tab")
    tab.locator("#play").press("Enter")
    end = f"0:{recorded.duration:04.1f}"
    tab.wait_for_function("end => document.querySelector('.time-text').value.startsWith(end)", arg=end)
    assert tab.locator("#play").get_attribute("aria-label") == "Play"


def test_an_event_brings_the_replay_to_its_time(open_page: Any, report: Path, recorded: Any) -> None:
    tab, _ = open_page(report.as_uri())
    tab.wait_for_selector(".report")
    tab.locator(".events button").last.click()
    wait_for_figure(tab, "Time", f"0:{recorded.duration:05.2f}")


def test_it_fits_a_phone_and_speaks_korean(open_page: Any, report: Path) -> None:
    tab, seen = open_page(
        report.as_uri(), viewport={"width": 390, "height": 844}, locale="ko-KR", color_scheme="dark", has_touch=True
    )
    tab.wait_for_selector(".report")
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
    assert tab.evaluate("document.documentElement.lang") == "ko"
    assert tab.evaluate("document.documentElement.dataset.theme") == "dark"
    assert tab.get_by_role("heading", name="설정").count() == 1
    assert seen.problems == []
