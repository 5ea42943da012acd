"""The verbs that open the page, with a browser's part played by the test."""

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from support.command_line import Trundle
from support.page_visitor import OpenPage, Visitor
from trundle.cli.shared import browser


def test_a_run_is_shown_and_steered_in_the_browser(trundle: Trundle, room_map: Path, play: Callable[..., list]) -> None:
    seen: dict[str, dict] = {}

    def part(page: OpenPage) -> None:
        page.wait("run")
        page.send("speed", factor="max")
        seen["end"] = page.wait("end")
        seen["rows"] = {"n": sum(len(message["rows"]) for message in page.got if message["type"] == "log")}

    errors = play(part)
    ends = ("--start", "0.5,0.5", "--goal", "6.5,3.5")
    done = trundle("run", room_map, *ends, "--backend", "kinematic", "--no-video", "--browser", "--json")
    assert (done.code, errors) == (0, []), done.err
    assert "The page: http://127.0.0.1:" in done.err
    assert seen["end"]["outcome"] == done.json["outcome"] == "arrived"
    assert Path(seen["end"]["folder"]).name == Path(done.json["run_dir"]).name
    assert seen["rows"]["n"] > 20


def test_a_run_can_be_restarted_from_the_page(trundle: Trundle, room_map: Path, play: Callable[..., list]) -> None:
    def part(page: OpenPage) -> None:
        page.wait("run", lambda message: message["n"] == 1)
        page.send("restart", seed="next")
        run = page.wait("run", lambda message: message["n"] == 2)
        assert run["info"]["seed"] == 4
        page.send("speed", factor="max")
        page.wait("end")

    errors = play(part)
    done = trundle("run", room_map, "--seed", 3, "--backend", "kinematic", "--no-video", "--browser", "--json")
    assert (done.code, errors) == (0, []), done.err
    assert done.json["seed"] == 4
    assert len(list(Path("runs").iterdir())) == 2


def test_a_robot_is_driven_by_hand_in_the_page(trundle: Trundle, play: Callable[..., list]) -> None:
    def part(page: OpenPage) -> None:
        page.wait("run")
        start = page.wait("frame")["row"]
        for _ in range(100):
            page.send("manual", v=0.4, w=0.0)
            if page.wait("frame")["row"][1] > start[1] + 0.05:
                break
        page.send("end")

    errors = play(part)
    done = trundle("drive", "nova_carter", "--backend", "kinematic", "--browser", "--json")
    assert (done.code, errors) == (0, []), done.err
    assert done.json[0]["x"] > 0.05


def test_commands_are_watched_in_the_page(trundle: Trundle, play: Callable[..., list]) -> None:
    seen: list[dict] = []
    errors = play(lambda page: seen.append(page.wait("end")))
    done = trundle(
        "drive", "nova_carter", "--backend", "kinematic", "--command", "0.4,0,0.5", "--browser", "--speed", 1, "--json"
    )
    assert (done.code, errors) == (0, []), done.err
    assert (len(done.json), done.json[0]["v"]) == (1, 0.4)
    assert seen[0]["outcome"] == "finished"


def test_serve_sets_up_runs_until_it_is_ended(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "trundle", "serve", "office", "--backend", "kinematic", "--port", "0", "--no-open"]
    environment = {name: text for name, text in os.environ.items() if not name.startswith("SSH_")}
    with subprocess.Popen(
        [*command, "--robot", "turtlebot3_burger"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=tmp_path,
        env=environment,
    ) as process:
        try:
            address = process.stdout.readline().strip()
            assert re.fullmatch(r"http://127\.0\.0\.1:\d+/\?token=[\w-]{32}", address)
            visitor = Visitor.of_address(address)
            status, headers, body = visitor.see("/")
            assert status == 200
            assert "script-src 'sha256-" in headers["Content-Security-Policy"]
            assert "unsafe-inline" not in headers["Content-Security-Policy"]
            assert b'id="boot"' in body
            with visitor.open() as page:
                assert page.wait("hello")["state"] == "idle"
                assert page.wait("scene")["scene"]["robot"]["name"] == "turtlebot3_burger"
                page.send("setup", world="no_such_world")
                assert "not among the choices" in page.wait("error")["text"]
                page.send("setup", seed=2)
                page.wait("run")
                page.send("setup", seed=2)
                assert "end it first" in page.wait("error")["text"]
                page.send("speed", factor="max")
                page.wait("frame", lambda message: message["waiting"])  # at the goal, for the next one
                page.send("end")
                end = page.wait("end")
                assert end["outcome"] == "arrived"
                assert visitor.see(end["files"] + "episode.json")[0] == 200
            process.send_signal(signal.SIGINT)
            assert process.wait(timeout=120) == 130
        finally:
            process.kill()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("serve", "nowhere"), "nowhere"),
        (("serve", "missing.yaml"), "missing.yaml"),
        (("serve", "--port", "70000"), "--port 70000"),
        (("serve", "--host", "192.0.2.1"), "cannot be served on 192.0.2.1"),
        (("serve", "--speed", "0"), "--speed '0': give simulated seconds per second, from 0.1 to 50, or max"),
        (("run", "office", "--speed", "fast"), "--speed 'fast'"),
        (("run", "office", "--speed", "inf"), "--speed 'inf'"),
        (("drive", "jackal", "--teleop", "--speed", "2"), "--speed is for --command"),
        (("drive", "jackal", "--browser", "--view"), "--view or --browser, not both"),
    ],
)
def test_what_cannot_be_served_is_named(trundle: Trundle, arguments: tuple[str, ...], message: str) -> None:
    done = trundle(*arguments)
    assert done.code == 2
    assert message in done.err


def test_without_a_browser_the_address_is_to_be_opened(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY", "SSH_CONNECTION", "SSH_TTY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    with browser.serving(None) as page:
        browser.announce(page)
        assert "There is no display here, so no browser was opened" in capsys.readouterr().err
        monkeypatch.setenv("SSH_CONNECTION", "1.2.3.4 1 5.6.7.8 22")
        browser.announce(page)
        port = page.server.port
        assert f"ssh -L {port}:localhost:{port}" in capsys.readouterr().err


def test_two_pages_at_once_have_two_ports() -> None:
    with browser.serving(None) as first, browser.serving(None) as second:
        assert first.server.port != second.server.port
