from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

import pytest

import trundle
from support.page_visitor import Visitor
from trundle.mission import LiveStatus, Scenario
from trundle.serve import View, server
from trundle.serve.choosing import Choices
from trundle.serve.hub import Hub
from trundle.serve.server import Page, PageServer


class RecordedControls:
    """Notes what the driver asks for."""

    status = LiveStatus("running")

    def __init__(self) -> None:
        self.asked = []
        self.left = []

    def handle(self, message, client, refuse):
        self.asked.append((message, client))

    def let_go(self, client):
        self.left.append(client)


@dataclass
class Served:
    hub: Hub
    controls: RecordedControls
    server: PageServer

    def visit(self) -> Visitor:
        return Visitor(self.server)


@contextmanager
def serving() -> Iterator[Served]:
    """A server with nothing but a hub, on a free port."""
    hub = Hub(choices=Choices(Scenario.make(world="warehouse")), source="warehouse")
    hub.controls = controls = RecordedControls()
    page = Page("<!doctype html><title>trundle</title>", "default-src 'none'")
    with PageServer(hub, page, port=0) as opened:
        yield Served(hub, controls, opened)


@pytest.fixture
def served() -> Iterator[Served]:
    """A server with nothing but a hub, on a free port."""
    with serving() as one:
        yield one


@pytest.fixture
def impatient(monkeypatch: pytest.MonkeyPatch) -> Iterator[Served]:
    """A server that does not wait long for a connection to say what it wants."""
    monkeypatch.setattr(server, "HANDSHAKE_S", 0.3)
    with serving() as one:
        yield one


@pytest.fixture
def view() -> Iterator[View]:
    with trundle.show(None, "jackal", open_browser=False) as opened:
        yield opened
