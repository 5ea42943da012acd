import sys
import threading
from collections.abc import Callable
from pathlib import Path

import pytest

from ros2.fake_transport import FakeNetwork, FakeTransport
from support.command_line import Done, Trundle, room
from support.fake_isaac.fixtures import assets, fake, make_fake
from support.page_visitor import OpenPage, Visitor
from trundle.cli.entry import run_command
from trundle.cli.shared import browser
from trundle.serve.server import PageServer

__all__ = ["assets", "fake", "make_fake", "play", "room_map", "trundle"]


@pytest.fixture
def trundle(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Trundle:
    """Run `trundle …` in this process, in an empty folder."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: object) -> Done:
        capsys.readouterr()
        code = run_command([str(argument) for argument in arguments])
        sys.stdout.flush()
        out, err = capsys.readouterr()
        return Done(code, out, err)

    return run


@pytest.fixture
def room_map(tmp_path: Path) -> Path:
    """The YAML of an 8 x 5 m room."""
    folder = tmp_path / "maps"
    folder.mkdir()
    room().save(folder / "room.yaml")
    return folder / "room.yaml"


@pytest.fixture
def play(monkeypatch: pytest.MonkeyPatch) -> Callable[[Callable[[OpenPage], None]], list[Exception]]:
    """Play a page in a thread as soon as a server's address is announced; returns the errors it met."""
    monkeypatch.setattr(browser, "open_browser", lambda address: True)
    monkeypatch.setattr(browser, "CLOSED_S", 0.0)
    monkeypatch.setattr(browser, "NEVER_OPENED_S", 0.0)
    monkeypatch.delenv("SSH_CONNECTION", raising=False)
    monkeypatch.delenv("SSH_TTY", raising=False)

    def prepare(part: Callable[[OpenPage], None]) -> list[Exception]:
        errors: list[Exception] = []

        def run(server: PageServer) -> None:
            try:
                with Visitor(server).open() as page:
                    part(page)
            except Exception as error:  # noqa: BLE001 - reported by the test
                errors.append(error)

        before = browser.advise

        def advise(page: browser.ServedPage, **options: bool) -> None:
            before(page, **options)
            threading.Thread(target=run, args=(page.server,)).start()

        monkeypatch.setattr(browser, "advise", advise)
        return errors

    return prepare


@pytest.fixture
def network(monkeypatch: pytest.MonkeyPatch) -> FakeNetwork:
    """The network that `trundle ros2` joins."""
    network = FakeNetwork()

    def join(_kind: str, *, node: str, namespace: str, **_: object) -> FakeTransport:
        full = node if namespace in ("", "/") else f"{namespace.strip('/')}/{node}"
        return network.transport(full)

    monkeypatch.setattr("trundle.ros2.transport.opening.open_transport", join)
    monkeypatch.setattr("trundle.ros2.check.why_not", lambda *_, **__: "")
    for name in ("ROS_DOMAIN_ID", "ROS_DISTRO", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY"):
        monkeypatch.delenv(name, raising=False)
    return network
