"""Finds who is on the network: Cyclone's built-in topics, and ros_discovery_info, by which nodes have endpoints."""

# Cyclone DDS has no wheel for some Pythons and machines.
# pyright: reportMissingImports=false

from __future__ import annotations

import re
import struct
import threading
from collections import OrderedDict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from trundle.errors import InputError
from trundle.messages import Distro, Qos
from trundle.ros2.transport.dds.library import Writing, every_sample
from trundle.ros2.transport.dds.mapping import (
    DISCOVERY_TOPIC,
    read_qos,
    reader_qos,
    ros_topic,
    ros_type,
    user_data,
    writer_qos,
)
from trundle.ros2.transport.transport import Endpoint, Graph, Offer

if TYPE_CHECKING:
    from cyclonedds.domain import DomainParticipant

    from trundle.messages import Codec
    from trundle.ros2.transport.dds.mapping import IdlTypes


INFO_TYPE = "rmw_dds_common/msg/ParticipantEntitiesInfo"

GUID = 16
"""Bytes of a GUID in DDS."""

MOST = 1000
"""Participants that are remembered."""

_MOST_ENTRIES = 100_000
"""Nodes and endpoints of one message."""


@dataclass(frozen=True, slots=True)
class NodeEndpoints:
    """A node, and the GUIDs of its endpoints."""

    namespace: str
    name: str
    readers: tuple[bytes, ...] = ()
    writers: tuple[bytes, ...] = ()

    @property
    def full_name(self) -> str:
        """Its name with the namespace ("/robot/amcl")."""
        return f"{self.namespace.rstrip('/')}/{self.name}"


def gid_size(distro: Distro) -> int:
    """Return the bytes of a Gid: Humble's has room for other middleware."""
    return 24 if distro == "humble" else GUID


def encode_info(participant: bytes, nodes: Iterable[NodeEndpoints], size: int) -> bytes:
    """Return the CDR bytes of a ParticipantEntitiesInfo, with Gids of `size` bytes."""
    out = bytearray(participant.ljust(size, b"\0"))

    def number(value: int) -> None:
        out.extend(b"\0" * (-len(out) % 4) + struct.pack("<I", value))

    def text(value: str) -> None:
        data = value.encode() + b"\0"
        number(len(data))
        out.extend(data)

    listed = tuple(nodes)
    number(len(listed))
    for node in listed:
        text(node.namespace)
        text(node.name)
        for gids in (node.readers, node.writers):
            number(len(gids))
            for gid in gids:
                out.extend(gid.ljust(size, b"\0"))
    return b"\0\1\0\0" + bytes(out)


def decode_info(data: bytes, size: int) -> tuple[bytes, tuple[NodeEndpoints, ...]]:
    """Return the participant and its nodes in the CDR bytes of a ParticipantEntitiesInfo.

    Raises:
        InputError: If they are not such bytes.
    """
    try:
        reading = _Reading(data)
        participant = reading.raw(size)[:GUID]
        nodes = tuple(_node(reading, size) for _ in range(reading.count()))
    except (struct.error, IndexError, UnicodeDecodeError) as error:
        raise InputError(f"not the bytes of a {INFO_TYPE}: {error}") from error
    return participant, nodes


class Participants:
    """What every participant said last of its nodes.

    Args:
        size: Bytes of a Gid.
    """

    def __init__(self, size: int) -> None:
        self._size = size
        self._known: OrderedDict[bytes, tuple[NodeEndpoints, ...]] = OrderedDict()
        self.ill_formed = 0

    def update(self, data: bytes) -> None:
        """Update the graph by a message; one that cannot be read is counted and left out."""
        try:
            participant, nodes = decode_info(data, self._size)
        except InputError:
            self.ill_formed += 1
            return
        self._known[participant] = nodes
        self._known.move_to_end(participant)
        while len(self._known) > MOST:
            self._known.popitem(last=False)

    def nodes(self, alive: Iterable[bytes]) -> Iterator[NodeEndpoints]:
        """Yield the nodes of the participants that are alive; the others are forgotten."""
        living = set(alive)
        for participant in list(self._known):
            if participant in living:
                yield from self._known[participant]
            else:
                del self._known[participant]


def _node(reading: _Reading, size: int) -> NodeEndpoints:
    namespace, name = reading.text(), reading.text()
    readers = tuple(reading.raw(size)[:GUID] for _ in range(reading.count()))
    writers = tuple(reading.raw(size)[:GUID] for _ in range(reading.count()))
    return NodeEndpoints(namespace, name, readers, writers)


class _Reading:
    """Reads CDR from its start, in the byte order that the header states."""

    def __init__(self, data: bytes) -> None:
        self._order = "<" if data[1] & 1 else ">"
        self._data, self._at = memoryview(data)[4:], 0

    def count(self) -> int:
        number = self._number()
        if number > _MOST_ENTRIES:
            raise IndexError(f"{number} entries")
        return number

    def text(self) -> str:
        return self.raw(self._number()).rstrip(b"\0").decode()

    def raw(self, size: int) -> bytes:
        piece = bytes(self._data[self._at : self._at + size])
        if len(piece) != size:
            raise IndexError(f"{size} bytes at {self._at}, where {len(piece)} are left")
        self._at += size
        return piece

    def _number(self) -> int:
        self._at += -self._at % 4
        (number,) = struct.unpack_from(f"{self._order}I", self._data, self._at)
        self._at += 4
        return number


INFO_QOS = Qos(1, durability="transient_local")

INFOS_KEPT = 500
"""What other nodes say of themselves waits in a reader of this length until it is read."""

MOST_ENDPOINTS = 10_000

_Kind: TypeAlias = Literal["publisher", "subscription"]
_KINDS: tuple[_Kind, ...] = ("publisher", "subscription")
_Found: TypeAlias = tuple[_Kind, Any]
"""An endpoint as Cyclone's built-in topics have it."""

_SERVICE = re.compile(r"r([qr])(/.+)(Request|Reply)")
_SERVICE_TYPE = re.compile(r"(.+)_(Request|Response)")
_SEND_GOAL = "/_action/send_goal"


class Discovery:
    """Tells others our node and its endpoints, and reads theirs. Safe in any thread.

    Args:
        participant: Our participant.
        idl: Makes types.
        codec: The codec of our distribution.
        namespace: Namespace of our node ("/").
        node: Its name.
    """

    def __init__(
        self, participant: DomainParticipant, idl: IdlTypes, codec: Codec, *, namespace: str, node: str
    ) -> None:
        from cyclonedds.builtin import (
            BuiltinDataReader,
            BuiltinTopicDcpsParticipant,
            BuiltinTopicDcpsPublication,
            BuiltinTopicDcpsSubscription,
        )
        from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState
        from cyclonedds.pub import DataWriter
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic

        type_hash = codec.type_hash(INFO_TYPE)
        topic = Topic(participant, DISCOVERY_TOPIC, idl.struct(INFO_TYPE))
        self._writer = DataWriter(participant, topic, writer_qos(INFO_QOS, type_hash))
        self._reader = DataReader(participant, topic, reader_qos(INFO_QOS, type_hash, kept=INFOS_KEPT))
        self._alive = SampleState.Any | ViewState.Any | InstanceState.Alive
        builtin = {
            "participant": BuiltinTopicDcpsParticipant,
            "publisher": BuiltinTopicDcpsPublication,
            "subscription": BuiltinTopicDcpsSubscription,
        }
        self._builtin = {kind: BuiltinDataReader(participant, one) for kind, one in builtin.items()}
        self._living = {kind: ReadCondition(reader, self._alive) for kind, reader in self._builtin.items()}
        unread = SampleState.NotRead | ViewState.Any | InstanceState.Any
        self._unread = {kind: ReadCondition(reader, unread) for kind, reader in self._builtin.items()}
        self._found: dict[str, list[Any]] = {}
        self._write = Writing()
        self._lock = threading.Lock()
        self._gid_size = gid_size(codec.distro)
        self._participants = Participants(self._gid_size)
        self._guid = participant.guid.bytes
        self._node = NodeEndpoints(namespace, node)
        self._announce()

    @property
    def node(self) -> str:
        """Our node, with its namespace."""
        return self._node.full_name

    def add(self, kind: _Kind, guid: bytes) -> None:
        """Tell others that an endpoint is our node's."""
        with self._lock:
            ours = self._node
            readers = (*ours.readers, guid) if kind == "subscription" else ours.readers
            writers = (*ours.writers, guid) if kind == "publisher" else ours.writers
            self._node = NodeEndpoints(ours.namespace, ours.name, readers, writers)
            self._announce()

    def drain(self) -> None:
        """Read what others said of their nodes."""
        from cyclonedds._clayer import ddspy_take

        with self._lock:
            taken = ddspy_take(self._reader._ref, every_sample(), INFOS_KEPT)
            for data, info in taken if isinstance(taken, list) else ():
                if info.valid_data:
                    self._participants.update(data)

    def graph(self) -> Graph:
        """Return who is on the network now."""
        self.drain()
        with self._lock:
            alive = [one.key.bytes for one in self._read("participant")]
            nodes = [*self._participants.nodes(alive)]
            found: list[_Found] = [(kind, one) for kind in _KINDS for one in self._read(kind)]
            ours = self._node
        if ours.full_name not in {node.full_name for node in nodes}:
            nodes.append(ours)
        owners = _owners(nodes)
        return Graph(
            tuple(sorted({node.full_name for node in nodes})),
            tuple(self._endpoint(kind, one, owners) for kind, one in found if ros_topic(one.topic_name)),
            tuple(sorted(self._offers(found, owners), key=lambda offer: (offer.name, offer.kind, offer.node))),
        )

    def endpoints(self, topic: str) -> tuple[Endpoint, ...]:
        """Return the publishers and subscriptions that a topic has now."""
        self.drain()
        with self._lock:
            nodes = [*self._participants.nodes([one.key.bytes for one in self._read("participant")]), self._node]
            every: list[_Found] = [(kind, one) for kind in _KINDS for one in self._read(kind)]
        owners = _owners(nodes)
        return tuple(self._endpoint(kind, one, owners) for kind, one in every if ros_topic(one.topic_name) == topic)

    def _announce(self) -> None:
        self._write(self._writer._ref, encode_info(self._guid, [self._node], self._gid_size))

    def _read(self, kind: str) -> list[Any]:
        """Return the entities that live; they are read only where that has changed: Cyclone's reading leaks memory."""
        if kind not in self._found or self._unread[kind].triggered:
            reader = self._builtin[kind]
            reader.read(MOST_ENDPOINTS, condition=self._unread[kind])  # also those that have left are read then
            self._found[kind] = reader.read(MOST_ENDPOINTS, condition=self._living[kind])
        return self._found[kind]

    def _endpoint(self, kind: _Kind, one: Any, owners: dict[bytes, str]) -> Endpoint:
        guid = one.key.bytes
        return Endpoint(
            kind=kind,
            topic=ros_topic(one.topic_name),
            type_name=ros_type(one.type_name),
            type_hash=user_data(one.qos).get("typehash", ""),
            qos=read_qos(one.qos),
            node=owners.get(guid, ""),
            source=guid.hex(),
            ours=one.participant_key.bytes == self._guid,
        )

    def _offers(self, found: list[_Found], owners: dict[bytes, str]) -> Iterator[Offer]:
        """Yield services and actions by their topics of requests, which servers read and clients write.

        An action has several services; the one that asks for goals stands for it.
        """
        for kind, one in found:
            parts = _SERVICE.fullmatch(one.topic_name)
            typed = _SERVICE_TYPE.fullmatch(ros_type(one.type_name))
            if not parts or not typed or parts[1] != "q":
                continue
            name, type_name, side = parts[2], typed[1], "server" if kind == "subscription" else "client"
            what: Any = f"service {side}"
            if name.endswith(_SEND_GOAL):
                name, type_name = name.removesuffix(_SEND_GOAL), type_name.removesuffix("_SendGoal")
                what = f"action {side}"
            elif "/_action/" in name:
                continue
            yield Offer(what, name, type_name, owners.get(one.key.bytes, ""), one.participant_key.bytes == self._guid)


def _owners(nodes: Iterable[NodeEndpoints]) -> dict[bytes, str]:
    """Return the full name of the node of each endpoint, by its GUID."""
    return {guid: node.full_name for node in nodes for guid in (*node.readers, *node.writers)}
