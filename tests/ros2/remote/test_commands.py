"""Commands to a robot that is somewhere else, and those of others."""

from __future__ import annotations

import threading
from dataclasses import replace

import pytest

from ros2.fake_transport import FakeNetwork
from ros2.remote.conftest import jazzy
from trundle.geometry import Twist2D
from trundle.messages import MessageMaker, Qos
from trundle.ros2.names import Names
from trundle.ros2.remote.commands import CommandOutput, Sources
from trundle.ros2.transport.transport import Endpoint, Graph
from trundle.ros2.types import Types
from trundle.ros2.wire import Wire


def make_commands(network: FakeNetwork) -> CommandOutput:
    transport = network.transport("trundle")
    types = Types(jazzy(), transport)
    wire = Wire(transport, types, Names())
    return CommandOutput(wire, types, "cmd_vel", "base_link", lambda: 0.0, Sources(wire))


class Compared(Twist2D):
    """A command that is sent again by another thread while it is compared."""

    __slots__ = ()
    commands: CommandOutput

    def __eq__(self, other: object) -> bool:
        sender = threading.Thread(target=lambda: self.commands.send(Twist2D(0.2, 0.0)), daemon=True)
        sender.start()
        sender.join(0.2)  # it waits for the comparison, or has come in between
        return False

    __hash__ = Twist2D.__hash__


def test_a_command_that_is_sent_while_another_is_heard_hides_no_other_driver() -> None:
    network = FakeNetwork()
    commands = Compared.commands = make_commands(network)
    commands.send(Compared(0.1, 0.0))
    commands._hear(MessageMaker(jazzy()).twist(Twist2D(0.3, 0.0)), "")
    assert "two sources" in commands.others(0.0)


def test_our_own_commands_that_come_back_are_nobodys() -> None:
    commands = make_commands(FakeNetwork())
    commands.send(Twist2D(0.1, 0.0))
    commands._hear(MessageMaker(jazzy()).twist(Twist2D(0.1, 0.0)), "")
    assert not commands.others(0.0)


def test_a_publisher_whose_node_is_not_known_yet_is_looked_up_again(monkeypatch: pytest.MonkeyPatch) -> None:
    transport = FakeNetwork().transport("trundle")
    found = Endpoint("publisher", "/cmd_vel", "geometry_msgs/msg/Twist", "", Qos(), "", "a1", ours=False)
    seen = [found, replace(found, node="/trundle_2", ours=True)]
    monkeypatch.setattr(transport, "graph", lambda: Graph((), (seen.pop(0),), ()))
    sources = Sources(Wire(transport, Types(jazzy(), transport), Names()))
    assert [sources.is_ours("a1") for _ in range(3)] == [None, True, True]
