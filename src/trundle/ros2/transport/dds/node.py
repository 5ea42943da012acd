"""`DdsTransport`: a node on the network of ROS 2 by Cyclone DDS; topics alone."""

# Cyclone DDS has no wheel for some Pythons and machines.
# pyright: reportMissingImports=false

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from trundle.errors import InputError
from trundle.messages import Codec, Distro, Qos
from trundle.messages.makers import learn_particle_cloud
from trundle.ros2.transport.dds import domains
from trundle.ros2.transport.dds.discovery import Discovery
from trundle.ros2.transport.dds.endpoints import DdsPublisher, DdsSubscription
from trundle.ros2.transport.dds.library import Writing, delete, every_sample, require, version
from trundle.ros2.transport.dds.mapping import IdlTypes, dds_topic, kept_by_reader, reader_qos, writer_qos
from trundle.ros2.transport.domain import Settings
from trundle.ros2.transport.transport import ActionHandler, Endpoint, Graph, Handler

if TYPE_CHECKING:
    from cyclonedds.core import Qos as DdsQos
    from cyclonedds.topic import Topic

NO_SERVICES = (
    "services and actions are off: over Cyclone DDS a client of another middleware would wait for ever. "
    "Start in a shell that has sourced ROS 2, with --transport rclpy, to serve them"
)


class DdsTransport:
    """Topics over Cyclone DDS, as ROS programs of any DDS middleware understand them.

    Args:
        settings: Domain, range and distribution.
        node: The name of our node.
        namespace: Its namespace ("/robot").

    Raises:
        MissingExtraError: If Cyclone DDS or rosbags is not installed.
        TransportError: If Cyclone DDS cannot be used here.
        InputError: If the domain cannot be opened with these settings.
    """

    name = "dds"
    has_services = False
    lost = ""

    def __init__(self, settings: Settings, *, node: str = "trundle", namespace: str = "") -> None:
        require()
        from cyclonedds.core import GuardCondition, WaitSet
        from cyclonedds.domain import DomainParticipant

        self.settings = settings
        self.distro: Distro = settings.distro
        self.rmw = f"cyclonedds {version()}"
        self.notes = (*settings.notes, NO_SERVICES, _ports(settings))
        self._codec = Codec(settings.distro)
        learn_particle_cloud(self._codec)  # what a localizer publishes; Nav2's types do not come along
        self._idl = IdlTypes(self._codec)
        domains.join(settings)
        try:
            self._participant = DomainParticipant(settings.domain, _participant_qos())
        except BaseException:
            domains.leave(settings.domain)
            raise
        self._discovery = Discovery(self._participant, self._idl, self._codec, namespace=namespace or "/", node=node)
        self._guard = GuardCondition(self._participant)
        self._waiting = WaitSet(self._participant)
        self._waiting.attach(self._guard)
        self._write = Writing()
        self._lock = threading.RLock()
        self._topics: dict[tuple[str, str], Topic] = {}
        self._publishers: list[DdsPublisher] = []
        self._subscriptions: list[DdsSubscription] = []
        self._closed = False

    @property
    def node(self) -> str:
        """Our node, with its namespace ("/trundle")."""
        return self._discovery.node

    def publisher(self, topic: str, type_name: str, qos: Qos) -> DdsPublisher:
        """Offer a topic; see `Transport`."""
        from cyclonedds.pub import DataWriter

        with self._lock:
            made = self._topic(topic, type_name)
            writer = DataWriter(self._participant, made, writer_qos(qos, self._codec.type_hash(type_name)))
            publisher = DdsPublisher(writer, topic, type_name, self._write)
            self._publishers.append(publisher)
        self._discovery.add("publisher", writer.guid.bytes)
        return publisher

    def subscription(self, topic: str, type_name: str, qos: Qos, *, wakes: bool = True) -> DdsSubscription:
        """Subscribe to a topic; see `Transport`."""
        from cyclonedds.core import ReadCondition
        from cyclonedds.sub import DataReader

        with self._lock:
            made = self._topic(topic, type_name)
            policies = reader_qos(qos, self._codec.type_hash(type_name), kept=kept_by_reader(qos))
            reader = DataReader(self._participant, made, policies)
            subscription = DdsSubscription(reader, topic, type_name, qos)
            self._subscriptions.append(subscription)
            if wakes:
                self._waiting.attach(ReadCondition(reader, every_sample()))
        self._discovery.add("subscription", reader.guid.bytes)
        return subscription

    def service(self, name: str, type_name: str, handler: Handler) -> None:
        """Raise InputError: services cannot be served here."""
        raise InputError(f"{name} cannot be served: {NO_SERVICES}")

    def action(self, name: str, type_name: str, handler: ActionHandler) -> None:
        """Raise InputError: actions cannot be served here."""
        raise InputError(f"{name} cannot be served: {NO_SERVICES}")

    def definition(self, type_name: str) -> str:
        """Return "": DDS does not tell the text of a type."""
        return ""

    def graph(self) -> Graph:
        """Return who is on the network now."""
        return Graph() if self._closed else self._discovery.graph()

    def endpoints(self, topic: str) -> tuple[Endpoint, ...]:
        """Return the publishers and subscriptions that a topic has now."""
        return () if self._closed else self._discovery.endpoints(topic)

    def wait(self, timeout_s: float) -> bool:
        """Wait until something arrived or `wake` was called; False if neither happened in time."""
        from cyclonedds.core import DDSException

        if self._closed:
            return False
        try:
            triggered = self._waiting.wait(int(timeout_s * 1e9))
        except DDSException:
            if self._closed:  # by another thread meanwhile
                return False
            raise
        if self._closed:
            return False
        self._guard.set(False)
        self._discovery.drain()
        return triggered > 0

    def wake(self) -> None:
        """End the `wait` of another thread."""
        if not self._closed:
            self._guard.set(True)

    def dispatch(self) -> None:
        """Do nothing: there are no services."""

    def close(self) -> None:
        """Leave the network; a second call does nothing."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
            self._guard.set(True)
            for one in (*self._publishers, *self._subscriptions):
                one.close()
            delete(self._participant)
            domains.leave(self.settings.domain)

    def _topic(self, topic: str, type_name: str) -> Topic:
        from cyclonedds.topic import Topic

        name = dds_topic(topic)
        key = name, type_name
        if key not in self._topics:
            self._topics[key] = Topic(self._participant, name, self._idl.struct(type_name))
        return self._topics[key]


def _participant_qos() -> DdsQos:
    from cyclonedds.core import Policy
    from cyclonedds.core import Qos as DdsQos

    return DdsQos(Policy.Userdata(b"enclave=/;"))


def _ports(settings: Settings) -> str:
    first = 7400 + 250 * settings.domain
    where = "on this machine only" if settings.range == "localhost" else "in the networks of this machine"
    return (
        f"others are looked for {where}; all the same Cyclone DDS binds its UDP ports ({first} to {first + 249}) "
        "on all addresses, and only a firewall closes them"
    )
