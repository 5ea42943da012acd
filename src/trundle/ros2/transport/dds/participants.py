"""Which node has which endpoints: the messages of ros_discovery_info, with which ROS tells others its nodes."""

from __future__ import annotations

import struct
from collections import OrderedDict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from trundle.errors import InputError
from trundle.messages import Distro

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
        """Take a message; one that cannot be read is counted and left out."""
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
