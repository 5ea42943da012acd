"""Reading the messages of a recording with rosbags."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rosbags.highlevel import AnyReader


def all_messages(path: Path, *topics: str) -> Iterator[tuple[str, Any]]:
    """The messages of some topics, each with its topic, in their order."""
    with AnyReader([path]) as reader:
        chosen = [one for one in reader.connections if one.topic in topics]
        for connection, _, data in reader.messages(chosen):
            yield connection.topic, reader.deserialize(data, connection.msgtype)
