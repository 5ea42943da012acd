"""The messages in which ROS tells others its nodes."""

import hypothesis.strategies as st
import numpy as np
import pytest
from hypothesis import given

from ros2.random_messages import random_message
from trundle.errors import InputError
from trundle.messages import Codec, Distro
from trundle.ros2.transport.dds import discovery
from trundle.ros2.transport.dds.discovery import NodeEndpoints, Participants, decode_info, encode_info, gid_size

GUID = bytes(range(16))
NODES = (
    NodeEndpoints("/", "trundle", readers=(GUID[::-1],), writers=(GUID, GUID[::-1])),
    NodeEndpoints("/robot_1", "länger"),
)


@pytest.mark.parametrize(("distro", "size"), [("humble", 24), ("jazzy", 16), ("kilted", 16), ("lyrical", 16)])
def test_they_are_those_of_the_distribution(distro: Distro, size: int) -> None:
    codec = Codec(distro)
    assert gid_size(distro) == size
    data = encode_info(GUID, NODES, size)
    message = codec.decode(discovery.INFO_TYPE, data)
    assert codec.encode(message) == data
    assert bytes(message.gid.data[:16]) == GUID
    assert [node.node_name for node in message.node_entities_info_seq] == ["trundle", "länger"]
    assert decode_info(data, size) == (GUID, NODES)


def test_random_ones_are_read_as_the_codec_reads_them() -> None:
    codec, rng = Codec("jazzy"), np.random.default_rng(2)
    message = random_message(codec, discovery.INFO_TYPE, rng)
    participant, nodes = decode_info(codec.encode(message), 16)
    assert participant == bytes(message.gid.data)
    for node, expected in zip(nodes, message.node_entities_info_seq, strict=True):
        assert (node.namespace, node.name) == (expected.node_namespace, expected.node_name)
        assert node.readers == tuple(bytes(gid.data) for gid in expected.reader_gid_seq)
        assert node.writers == tuple(bytes(gid.data) for gid in expected.writer_gid_seq)


@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    known = Participants(16)
    known.update(data)
    assert known.ill_formed <= 1


@given(st.integers(0, 250))
def test_half_a_message_is_refused(cut: int) -> None:
    data = encode_info(GUID, NODES, 16)
    with pytest.raises(InputError, match="ParticipantEntitiesInfo"):
        decode_info(data[: min(cut, len(data) - 1)], 16)


def test_what_left_is_forgotten_and_memory_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(discovery, "MOST", 3)
    known = Participants(16)
    guids = [bytes([number]) * 16 for number in range(5)]
    for number, guid in enumerate(guids):
        known.update(encode_info(guid, [NodeEndpoints("/", f"n{number}")], 16))
    assert [node.full_name for node in known.nodes(guids)] == ["/n2", "/n3", "/n4"]
    assert [node.full_name for node in known.nodes(guids[3:4])] == ["/n3"]
    assert [node.full_name for node in known.nodes(guids)] == ["/n3"]
