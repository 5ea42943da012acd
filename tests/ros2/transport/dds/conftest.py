"""Nodes on a domain of their own; skipped where Cyclone DDS or rosbags is not installed."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import pytest

from ros2.domains import claim_domain, release_domain
from trundle.messages import Distro
from trundle.ros2.transport.dds.node import DdsTransport
from trundle.ros2.transport.domain import Settings

PATIENCE_S = 120.0
"""Until a test gives up waiting: far longer than it takes, on any machine."""

Open = Callable[..., DdsTransport]


@pytest.fixture(autouse=True, scope="session")
def libraries() -> None:
    """What all of these tests need."""
    pytest.importorskip("rosbags", reason="rosbags is not installed")
    pytest.importorskip("cyclonedds", reason="cyclonedds is not installed, or has no wheel here")


@pytest.fixture
def domain() -> Iterator[int]:
    """A domain that no other test uses at the same time."""
    claimed = claim_domain()
    yield claimed
    release_domain(claimed)


@pytest.fixture
def open_node(domain: int) -> Iterator[Open]:
    """Opens nodes, and closes them after the test."""
    opened = []

    def open_one(node: str = "trundle", *, distro: Distro = "jazzy", namespace: str = "") -> DdsTransport:
        made = DdsTransport(Settings(domain=domain, distro=distro), node=node, namespace=namespace)
        opened.append(made)
        return made

    yield open_one
    for one in opened:
        one.close()


def until(condition: Callable[[], bool], what: str) -> None:
    """Wait until something holds."""
    end = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < end, f"gave up waiting: {what}"
        time.sleep(0.005)


def received(transport, subscription, count: int) -> list:
    """The next messages of a subscription, `count` or more."""
    samples = []
    end = time.monotonic() + PATIENCE_S
    while len(samples) < count:
        assert time.monotonic() < end, f"gave up waiting: {len(samples)} of {count} messages"
        transport.wait(0.2)
        samples += subscription.take()
    return samples
