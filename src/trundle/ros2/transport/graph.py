"""`Graph`: who is on the network, as `ros2 node list` and `ros2 topic info --verbose` would show it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from trundle.messages import Qos


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
        """The types of every topic, as `ros2 topic list -t` has them; one with two is a mistake."""
        types: dict[str, set[str]] = {}
        for one in self.endpoints:
            types.setdefault(one.topic, set()).add(one.type_name)
        return {topic: tuple(sorted(types[topic])) for topic in sorted(types)}

    def publishers(self, topic: str) -> tuple[Endpoint, ...]:
        """The publishers of a topic."""
        return tuple(one for one in self.endpoints if one.kind == "publisher" and one.topic == topic)

    def subscriptions(self, topic: str) -> tuple[Endpoint, ...]:
        """The subscriptions of a topic."""
        return tuple(one for one in self.endpoints if one.kind == "subscription" and one.topic == topic)
