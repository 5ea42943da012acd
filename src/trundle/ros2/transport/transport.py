"""`Transport`: the seam between the bridge and the network; and `Graph`: who is on the network.

Names are fully resolved ("/robot/scan"), types are "package/msg/Name", "package/srv/Name" and "package/action/Name",
and messages are CDR bytes with their header of four bytes. The requests, responses, goals, results and feedback of
services and actions are bytes of "package/srv/Name_Request", "…_Response", "package/action/Name_Goal", "…_Result" and
"…_Feedback".

Writing is safe from any thread. One thread waits, takes and dispatches: no handler is ever called in another one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

from trundle.messages import Distro, Qos
from trundle.ros2.transport.domain import Settings


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A publisher or a subscription of a topic.

    Attributes:
        kind: Which of the two.
        topic: The topic, resolved ("/scan").
        type_name: Its type ("sensor_msgs/msg/LaserScan").
        type_hash: The hash of the type, `RIHS01_…`; "" where the other side states none, as on Humble.
        qos: The quality of service that is offered or asked for; depths are not always known, and then 0.
        node: The node that it belongs to ("/rviz"); "" where the other side does not say.
        source: What `Sample.source` is for this publisher.
        ours: Whether this transport made it.
    """

    kind: Literal["publisher", "subscription"]
    topic: str
    type_name: str
    type_hash: str
    qos: Qos
    node: str
    source: str
    ours: bool


@dataclass(frozen=True, slots=True)
class Offer:
    """A service or an action that a node serves or asks for.

    Attributes:
        kind: What it is, and on which side.
        name: Its name, resolved ("/navigate_to_pose").
        type_name: Its type ("nav2_msgs/action/NavigateToPose").
        node: The node that it belongs to; "" where the other side does not say.
        ours: Whether this transport made it.
    """

    kind: Literal["service server", "service client", "action server", "action client"]
    name: str
    type_name: str
    node: str
    ours: bool


@dataclass(frozen=True, slots=True)
class Graph:
    """The network as it is now.

    Attributes:
        nodes: The names of all nodes, with their namespaces ("/amcl"), sorted; trundle's own among them.
        endpoints: All publishers and subscriptions.
        offers: Services and actions, as far as the transport knows them.
    """

    nodes: tuple[str, ...] = ()
    endpoints: tuple[Endpoint, ...] = ()
    offers: tuple[Offer, ...] = ()

    def topics(self) -> Mapping[str, tuple[str, ...]]:
        """Return the types of every topic, as `ros2 topic list -t` has them; one with two is a mistake."""
        types: dict[str, set[str]] = {}
        for one in self.endpoints:
            types.setdefault(one.topic, set()).add(one.type_name)
        return {topic: tuple(sorted(types[topic])) for topic in sorted(types)}

    def publishers(self, topic: str) -> tuple[Endpoint, ...]:
        """Return the publishers of a topic."""
        return tuple(one for one in self.endpoints if one.kind == "publisher" and one.topic == topic)

    def subscriptions(self, topic: str) -> tuple[Endpoint, ...]:
        """Return the subscriptions of a topic."""
        return tuple(one for one in self.endpoints if one.kind == "subscription" and one.topic == topic)


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
        """How many subscriptions of other nodes get what is written."""
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
        """Return the messages that arrived, oldest first, no more than the queue holds; it never waits."""
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
        """Return whether to accept a goal."""
        ...

    def accepted(self, goal: GoalHandle) -> None:
        """Handle a goal that was accepted; it is ended later, from any thread."""
        ...

    def cancel(self, goal: GoalHandle) -> bool:
        """Return whether to let the client cancel a goal; `goal.cancel_requested` is set if so."""
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

    def subscription(self, topic: str, type_name: str, qos: Qos, *, wakes: bool = True) -> Subscription:
        """Subscribe to a topic; whether a message `wakes` says whether it ends `wait`.

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
        """Return the text of a type and of all in it, as the other side has it; "" if only trundle's own is known."""
        ...

    def graph(self) -> Graph:
        """Return who is on the network now."""
        ...

    def endpoints(self, topic: str) -> tuple[Endpoint, ...]:
        """Return the publishers and subscriptions that a topic has now; the whole graph takes far longer."""
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
