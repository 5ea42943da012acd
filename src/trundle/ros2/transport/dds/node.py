"""`DdsTransport`: a node on the network of ROS 2 by Cyclone DDS; topics alone. Its domain is shared in the process.

Configuration: https://cyclonedds.io/docs/cyclonedds/latest/config/config_file_reference.html.
"""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from trundle.errors import InputError
from trundle.messages import Codec, Distro, Qos
from trundle.messages.makers import learn_particle_cloud
from trundle.ros2.transport.dds.discovery import Discovery
from trundle.ros2.transport.dds.endpoints import DdsPublisher, DdsSubscription
from trundle.ros2.transport.dds.library import Writing, delete, every_sample, require, version
from trundle.ros2.transport.dds.mapping import IdlTypes, dds_topic, kept_by_reader, reader_qos, writer_qos
from trundle.ros2.transport.domain import Settings
from trundle.ros2.transport.transport import ActionHandler, Endpoint, Graph, Handler

if TYPE_CHECKING:
    from cyclonedds.core import Qos as DdsQos
    from cyclonedds.domain import Domain
    from cyclonedds.topic import Topic


# Cyclone DDS has no wheel for some Pythons and machines.
# pyright: reportMissingImports=false


LOOPBACK = "127.0.0.1"

_GENERAL = """
<General>
  <Interfaces><NetworkInterface {interface}/></Interfaces>
  <AllowMulticast>{multicast}</AllowMulticast>
  <MaxMessageSize>65500B</MaxMessageSize>
</General>
"""
"""Multicast finds others and carries no data, as in rmw_cyclonedds; large datagrams make large messages cheap."""

_DISCOVERY = """
<Discovery>
  <ParticipantIndex>auto</ParticipantIndex>
  <MaxAutoParticipantIndex>119</MaxAutoParticipantIndex>
  <LeaseDuration>5 s</LeaseDuration>
  <Peers addLocalhost="{localhost}">{peers}</Peers>
</Discovery>
"""
"""120 participants of a machine have ports in a domain. Others forget us five seconds after we were killed."""

_COMPATIBILITY = "<Compatibility><IgnoreTypeInformation>1.15</IgnoreTypeInformation></Compatibility>"
"""1.15 is eProsima's vendor id. Without this, Kilted's Fast DDS matches no type that has sequences."""

_WRITING = "<Internal><Watermarks><WhcAdaptive>false</WhcAdaptive><WhcHigh>1 GB</WhcHigh></Watermarks></Internal>"
"""A writer does not wait for slow readers: its history, of limited depth, replaces what they have not fetched."""

_joined: dict[int, tuple[Domain, str, int]] = {}
"""The domain of each number, its configuration, and how many use it."""

_lock = threading.Lock()


def domain_xml(settings: Settings) -> str:
    """Return the configuration for a domain, and after it what the user's CYCLONEDDS_URI adds."""
    local = settings.range == "localhost"
    peers = ("localhost",) if local else settings.static_peers
    parts = (
        _GENERAL.format(
            interface=f'address="{LOOPBACK}" multicast="true"' if local else 'autodetermine="true"', multicast="spdp"
        ),
        _DISCOVERY.format(
            localhost="false" if local else "true",
            peers="".join(f"<Peer address={quoteattr(peer)}/>" for peer in peers),
        ),
        _COMPATIBILITY,
        _WRITING,
    )
    ours = f'<CycloneDDS><Domain Id="any">{"".join(parts)}</Domain></CycloneDDS>'
    return f"{ours},{settings.cyclonedds_uri}" if settings.cyclonedds_uri else ours


def join(settings: Settings) -> None:
    """Open a domain, or use the one that is open.

    Raises:
        InputError: If it is open with another range, or its configuration cannot be used.
    """
    from cyclonedds.core import DDSException
    from cyclonedds.domain import Domain

    xml = domain_xml(settings)
    with _lock:
        if settings.domain in _joined:
            domain, other, users = _joined[settings.domain]
            if other != xml:
                raise InputError(
                    f"domain {settings.domain} is open in this process with another range or configuration"
                )
        else:
            try:
                domain, users = Domain(settings.domain, xml), 0
            except DDSException as error:
                more = ", or CYCLONEDDS_URI has a fault" if settings.cyclonedds_uri else ""
                raise InputError(
                    f"Cyclone DDS cannot open domain {settings.domain} with range {settings.range}{more}: {error}"
                ) from error
        _joined[settings.domain] = domain, xml, users + 1


def leave(number: int) -> None:
    """Leave a domain; the last one that leaves ends its threads."""
    with _lock:
        domain, xml, users = _joined[number]
        if users > 1:
            _joined[number] = domain, xml, users - 1
            return
        del _joined[number]
    delete(domain)


# Cyclone DDS has no wheel for some Pythons and machines.
# pyright: reportMissingImports=false


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
        join(settings)
        try:
            self._participant = DomainParticipant(settings.domain, _participant_qos())
        except BaseException:
            leave(settings.domain)
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
            leave(self.settings.domain)

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
