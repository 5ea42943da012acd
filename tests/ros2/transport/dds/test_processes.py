"""Nodes in other processes, and in other network namespaces."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from ros2.transport.dds.conftest import PATIENCE_S, Open, received, until
from trundle.messages import Codec, Qos

PEERS = Path(__file__).parent / "peers"
TEXT = "std_msgs/msg/String"
NO_NAMESPACES = 77


@pytest.fixture
def started() -> Iterator[list[subprocess.Popen[str]]]:
    """Processes that are killed after the test."""
    processes: list[subprocess.Popen[str]] = []
    yield processes
    for process in processes:
        process.kill()
        process.communicate()


def start(started: list[subprocess.Popen[str]], *arguments: object) -> subprocess.Popen[str]:
    command = [sys.executable, str(PEERS / "node.py"), *map(str, arguments)]
    started.append(subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True))
    return started[-1]


@pytest.mark.parametrize("end", [signal.SIGTERM, signal.SIGKILL])
def test_a_process_that_is_ended_leaves_the_network_and_comes_back(
    open_node: Open, domain: int, started: list[subprocess.Popen[str]], end: signal.Signals
) -> None:
    node = open_node("ours")
    subscription = node.subscription("/peer", TEXT, Qos())
    first = start(started, "peer", "localhost", domain, "ours")
    (sample, *_) = received(node, subscription, 1)
    assert Codec().decode(TEXT, sample.data).data == "peer"
    first.send_signal(end)
    first.wait(PATIENCE_S)
    until(lambda: subscription.matched == 0 and node.graph().nodes == ("/ours",), "the peer to leave")
    subscription.take()
    start(started, "peer", "localhost", domain, "ours")
    (again, *_) = received(node, subscription, 1)
    assert again.source != sample.source


def test_a_process_that_ends_without_closing_does_not_hang(domain: int) -> None:
    code = (
        "from trundle.ros2.transport.dds.node import DdsTransport\n"
        "from trundle.ros2.transport.domain import Settings\n"
        "from trundle.messages import Qos\n"
        f"node = DdsTransport(Settings(domain={domain}))\n"
        f"one = node.publisher('/t', {TEXT!r}, Qos()), node.subscription('/t', {TEXT!r}, Qos())\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=PATIENCE_S, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def in_namespaces(range_: str, domain: int, *names: str) -> dict:
    command = [sys.executable, str(PEERS / "namespaces.py"), range_, str(domain), *names]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=2 * PATIENCE_S)
    if done.returncode == NO_NAMESPACES:
        pytest.skip(done.stdout.strip())
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.mark.skipif(sys.platform != "linux", reason="network namespaces are Linux's")
def test_on_localhost_nothing_leaves_the_machine(domain: int) -> None:
    found = in_namespaces("localhost", domain, "one", "two")
    assert found["one"] == {"heard": ["two"], "nodes": ["/one", "/two"]}
    assert found["two"] == {"heard": ["one"], "nodes": ["/one", "/two"]}
    assert found["far"] == {"heard": [], "nodes": ["/far"]}
    assert found["packets"] == 0


@pytest.mark.skipif(sys.platform != "linux", reason="network namespaces are Linux's")
def test_in_the_subnet_other_machines_are_found(domain: int) -> None:
    found = in_namespaces("subnet", domain, "one", "two", "far")
    for name, others in (("one", ["two", "far"]), ("two", ["one", "far"]), ("far", ["one", "two"])):
        assert found[name]["heard"] == others
    assert found["packets"] > 0
