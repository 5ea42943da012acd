"""`BagWriter`: an MCAP file as rosbag2 writes it."""

from __future__ import annotations

import io
import logging
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, cast

import yaml
from mcap.records import Attachment
from mcap.writer import CompressionType, Writer

from trundle.errors import OutputError
from trundle.files.writing import atomic_path, cannot_write
from trundle.messages.codec import OLD_BAGS
from trundle.messages.qos import Qos
from trundle.version import __version__

_LOGGER = logging.getLogger(__name__)

CHUNK_BYTES = 4 * 1024 * 1024
"""A chunk ends when it is this large, besides every time it is flushed: readers load and decompress whole chunks."""

METADATA = "rosbag2"
"""Name of the record in which rosbag2 keeps a bag's metadata.yaml."""


@dataclass(slots=True, eq=False)
class Topic:
    """A topic of a bag that is written.

    Attributes:
        name: Name of the topic.
        type_name: Type of its messages.
        encoding: Encoding of its messages: "cdr".
        metadata: Metadata of its channel: `offered_qos_profiles` as YAML, and `topic_type_hash`.
        channel: Number of its channel.
        count: Messages written.
    """

    name: str
    type_name: str
    encoding: str
    metadata: Mapping[str, str]
    channel: int
    count: int = 0


class _LateFile:
    """A file that is written in memory until it appears, so that a kill before that leaves none.

    Args:
        path: The file; one that exists is replaced.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._stream: IO[bytes] = io.BytesIO()
        self._is_there = False

    @property
    def closed(self) -> bool:
        """Whether it was closed."""
        return self._stream.closed

    def write(self, data: bytes | memoryview) -> int:
        """Write; see `io`."""
        with self._problems():
            written = self._stream.write(data)
        if not self._is_there and self._stream.tell() > CHUNK_BYTES:
            self.appear()
        return written

    def tell(self) -> int:
        """Return the position at which the next write goes."""
        return self._stream.tell()

    def flush(self) -> None:
        """Hand everything to the operating system."""
        with self._problems():
            self._stream.flush()

    def appear(self) -> None:
        """Write what there is to the disk, whole, and from then on everything else."""
        if self._is_there:
            self.flush()
            return
        content = cast("io.BytesIO", self._stream).getvalue()
        with atomic_path(self._path) as temporary:
            stream = temporary.open("r+b")
            try:
                stream.write(content)
                stream.flush()
            except OSError:
                stream.close()
                raise
        self._stream, self._is_there = stream, True

    def close(self, *, durable: bool = False) -> None:
        """Close it; see `io`."""
        with self._problems():
            if durable:
                self._stream.flush()
                os.fsync(self._stream.fileno())
            self._stream.close()

    @contextmanager
    def _problems(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise cannot_write(self._path, error) from error


@dataclass(slots=True, eq=False)
class BagWriter:
    """Writes messages to an MCAP file with rosbag2's schemas, QoS, type hashes and metadata.

    Its chunks are compressed with zstd. The file appears with its first messages, when they are flushed. What was
    flushed stays readable if the process is killed.

    Args:
        path: The file; one that exists is overwritten.
        distro: Distribution of ROS 2; empty if it is not known.
        file_name: Name of the file in its metadata. By default, it is that of `path`.

    Attributes:
        topics: What was added.

    Raises:
        OutputError: If the file cannot be written, from any method that writes.
    """

    path: Path
    distro: str
    file_name: str | None = None
    topics: list[Topic] = field(default_factory=list[Topic])
    _first: int | None = None
    _last: int = 0
    _schemas: dict[tuple[str, str, bytes], int] = field(default_factory=dict[tuple[str, str, bytes], int])
    _stream: _LateFile = field(init=False)
    _writer: Writer = field(init=False)

    def __post_init__(self) -> None:
        self._stream = _LateFile(self.path)
        self._writer = Writer(cast("IO[bytes]", self._stream), chunk_size=CHUNK_BYTES, compression=CompressionType.ZSTD)
        self._writer.start(profile="ros2", library=f"trundle {__version__}")

    def add_topic(self, name: str, type_name: str, definition: str, type_hash: str, qos: Qos) -> Topic:
        """Add a topic.

        Args:
            name: Name of the topic.
            type_name: Type of its messages.
            definition: Text of the type and of all types in it.
            type_hash: `RIHS01_…`.
            qos: What it is offered with.
        """
        profiles = yaml.safe_dump([dict(qos.profile(numbers=self.distro in OLD_BAGS))], sort_keys=False)
        metadata = {"offered_qos_profiles": profiles, "topic_type_hash": type_hash}
        return self.add_channel(name, type_name, "ros2msg", definition.encode(), metadata)

    def add_channel(
        self,
        name: str,
        type_name: str,
        schema_encoding: str,
        definition: bytes,
        metadata: Mapping[str, str],
        encoding: str = "cdr",
    ) -> Topic:
        """Add a topic whose schema and metadata are given as a bag has them."""
        key = (type_name, schema_encoding, definition)
        if key not in self._schemas:
            self._schemas[key] = self._writer.register_schema(type_name, schema_encoding, definition)
        channel = self._writer.register_channel(name, encoding, self._schemas[key], dict(metadata))
        topic = Topic(name, type_name, encoding, metadata, channel)
        self.topics.append(topic)
        return topic

    def write(self, topic: Topic, stamp: int, data: bytes, *, published: int | None = None) -> None:
        """Write a message.

        Args:
            topic: One that was added.
            stamp: Time [ns] at which it was received.
            data: Its CDR bytes.
            published: Time [ns] at which it was published. By default, it is the same.
        """
        self._first = stamp if self._first is None else min(self._first, stamp)
        self._last = max(self._last, stamp)
        self._writer.add_message(topic.channel, stamp, data, stamp if published is None else published, topic.count)
        topic.count += 1

    def add_metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Write a metadata record."""
        self._writer.flush()
        self._writer.add_metadata(name, dict(values))

    def add_attachment(self, record: Attachment) -> None:
        """Write an attachment of another bag."""
        self._writer.add_attachment(record.create_time, record.log_time, record.name, record.media_type, record.data)

    @property
    def span(self) -> tuple[int, int]:
        """Times [ns] of the first and the last message."""
        return self._first or 0, self._last

    def flush(self) -> None:
        """End the chunk, and hand everything to the operating system."""
        self._writer.flush()
        if self._first is not None:
            self._stream.appear()

    def close(self, custom: Mapping[str, str] | None = None) -> None:
        """Write rosbag2's metadata and the index, and close the file durably.

        Args:
            custom: The custom data of rosbag2's metadata.
        """
        self._writer.flush()
        self._writer.add_metadata(METADATA, {"serialized_metadata": self._metadata(custom or {})})
        self._writer.finish()
        self._stream.appear()
        self._stream.close(durable=True)

    def abandon(self) -> None:
        """Flush and close the file without an index; `recover` makes one. There is none where it has no message."""
        if not self._stream.closed:
            try:
                self.flush()
                self._stream.close()
            except OutputError as error:
                _LOGGER.warning("%s; its last chunk is lost", error)

    def _metadata(self, custom: Mapping[str, str]) -> str:
        """Return the bag's metadata.yaml, as rosbag2 of the distribution has it."""
        old = self.distro in OLD_BAGS
        name = self.file_name or self.path.name
        start = {"nanoseconds_since_epoch": self._first or 0}
        duration = {"nanoseconds": self._last - (self._first or 0)}
        count = sum(topic.count for topic in self.topics)
        content: dict[str, object] = {
            "version": 5 if old else 9,
            "storage_identifier": "mcap",
            "relative_file_paths": [name],
            "duration": duration,
            "starting_time": start,
            "message_count": count,
            "topics_with_message_count": [
                {"topic_metadata": _describe(topic, old=old), "message_count": topic.count} for topic in self.topics
            ],
            "compression_format": "",
            "compression_mode": "",
            "files": [
                {
                    "path": name,
                    "starting_time": dict(start),
                    "duration": dict(duration),
                    "message_count": count,
                }
            ],
        }
        if not old:
            content |= {"custom_data": dict(custom) or None, "ros_distro": self.distro}
        return yaml.safe_dump(content, sort_keys=False)


def _describe(topic: Topic, *, old: bool) -> dict[str, object]:
    """Return a topic in the bag's metadata; up to Iron its QoS profiles are text there."""
    profiles = topic.metadata.get("offered_qos_profiles", "")
    facts: dict[str, object] = {
        "name": topic.name,
        "type": topic.type_name,
        "serialization_format": topic.encoding,
        "offered_qos_profiles": profiles if old else yaml.safe_load(profiles or "[]"),
    }
    return facts if old else {**facts, "type_description_hash": topic.metadata.get("topic_type_hash", "")}
