"""`Transport`: the seam between the bridge and the network.

Names are fully resolved ("/robot/scan"), types are "package/msg/Name", "package/srv/Name" and "package/action/Name",
and messages are CDR bytes with their header of four bytes. The requests, responses, goals, results and feedback of
services and actions are bytes of "package/srv/Name_Request", "…_Response", "package/action/Name_Goal", "…_Result" and
"…_Feedback".

Writing is safe from any thread. One thread waits, takes and dispatches: no handler is ever called in another one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol, TypeAlias

from trundle.messages import Distro, Qos
from trundle.ros2.transport.domain import Settings
from trundle.ros2.transport.graph import Graph


@dataclass(frozen=True, slots=True)
class Sample:
    """A message that arrived.

    Attributes:
        data: Its CDR bytes with their header.
        source: An id of its publisher, as `Endpoint.source` has it; "" where the transport does not know.
    """

    data: bytes
    source: str = ""


class Publisher(Protocol):
    """Writes the messages of a topic."""

    @property
    def matched(self) -> int:
        """How many subscriptions get what is written."""
        ...

    def write(self, data: bytes) -> None:
        """Send a message. It never waits long: a reader that does not keep up costs it messages, not time."""
        ...


class Subscription(Protocol):
    """Receives the messages of a topic, into a queue of limited length."""

    @property
    def matched(self) -> int:
        """How many publishers it gets messages from."""
        ...

    @property
    def dropped(self) -> int:
        """How many messages found the queue full, since the start."""
        ...

    def take(self) -> list[Sample]:
        """The messages that arrived, oldest first, no more than the queue holds; it never waits."""
        ...


Handler: TypeAlias = Callable[[bytes], bytes]
"""Answers a request of a service: request → response."""


class GoalHandle(Protocol):
    """A goal of an action that was accepted. Exactly one of `succeed`, `abort` and `canceled` ends it."""

    @property
    def id(self) -> bytes:
        """The goal's UUID, 16 bytes."""
        ...

    @property
    def data(self) -> bytes:
        """The goal."""
        ...

    @property
    def cancel_requested(self) -> bool:
        """Whether the client asked to cancel it and the handler agreed."""
        ...

    def publish_feedback(self, data: bytes) -> None:
        """Send feedback to the client."""
        ...

    def succeed(self, result: bytes) -> None:
        """End the goal with a result: it was reached."""
        ...

    def abort(self, result: bytes) -> None:
        """End the goal with a result: it was not reached."""
        ...

    def canceled(self, result: bytes) -> None:
        """End the goal with a result: the client canceled it."""
        ...


class ActionHandler(Protocol):
    """Serves an action. Called in the thread that calls `Transport.dispatch`; none of these may wait."""

    def accepts(self, data: bytes) -> bool:
        """Whether to accept a goal."""
        ...

    def accepted(self, goal: GoalHandle) -> None:
        """Take a goal that was accepted; it is ended later, from any thread."""
        ...

    def cancel(self, goal: GoalHandle) -> bool:
        """Whether to let the client cancel a goal; `goal.cancel_requested` is set if so."""
        ...


class Transport(Protocol):
    """A node on the network of ROS 2."""

    @property
    def name(self) -> str:
        """Which one: "dds" or "rclpy"."""
        ...

    @property
    def distro(self) -> Distro:
        """The distribution whose types are spoken."""
        ...

    @property
    def settings(self) -> Settings:
        """Domain, range and what else of the environment was honoured."""
        ...

    @property
    def node(self) -> str:
        """Our node, with its namespace ("/trundle")."""
        ...

    @property
    def rmw(self) -> str:
        """The middleware in use ("rmw_fastrtps_cpp"; of "dds" it is "cyclonedds 11.0.1")."""
        ...

    @property
    def has_services(self) -> bool:
        """Whether services and actions can be served."""
        ...

    @property
    def notes(self) -> tuple[str, ...]:
        """What the user should know of this transport: what is off and why, what is bound where."""
        ...

    @property
    def lost(self) -> str:
        """Why nothing is sent or received any more; "" while all is well."""
        ...

    def publisher(self, topic: str, type_name: str, qos: Qos) -> Publisher:
        """Offer a topic.

        Raises:
            UnknownNameError: If the type is not known.
            InputError: If the name is not one of a topic.
        """
        ...

    def subscription(self, topic: str, type_name: str, qos: Qos) -> Subscription:
        """Subscribe to a topic.

        Raises:
            UnknownNameError: If the type is not known.
            InputError: If the name is not one of a topic.
        """
        ...

    def service(self, name: str, type_name: str, handler: Handler) -> None:
        """Serve a service.

        Raises:
            InputError: If `has_services` is false.
            UnknownNameError: If the type is not known.
        """
        ...

    def action(self, name: str, type_name: str, handler: ActionHandler) -> None:
        """Serve an action.

        Raises:
            InputError: If `has_services` is false.
            UnknownNameError: If the type is not known.
        """
        ...

    def definition(self, type_name: str) -> str:
        """The text of a type and of all in it, as the other side has it; "" where only trundle's own is known."""
        ...

    def graph(self) -> Graph:
        """Who is on the network now."""
        ...

    def wait(self, timeout_s: float) -> bool:
        """Wait until something arrived or `wake` was called; False if neither happened in time."""
        ...

    def wake(self) -> None:
        """End the `wait` of another thread."""
        ...

    def dispatch(self) -> None:
        """Run the handlers of the requests and goals that arrived, in this thread."""
        ...

    def close(self) -> None:
        """Leave the network, in two seconds at most; a second call does nothing."""
        ...
