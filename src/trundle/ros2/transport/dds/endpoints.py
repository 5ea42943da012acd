"""Publishers and subscriptions over Cyclone DDS."""

# Cyclone DDS has no wheel for some Pythons and machines.
# pyright: reportMissingImports=false

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from trundle.errors import InputError
from trundle.messages import Qos
from trundle.ros2.transport.dds.library import RETCODE_TIMEOUT, Writing, every_sample
from trundle.ros2.transport.dds.mapping import kept_by_reader
from trundle.ros2.transport.transport import Sample

if TYPE_CHECKING:
    from cyclonedds.pub import DataWriter
    from cyclonedds.sub import DataReader

_LOG = logging.getLogger(__name__)

_SOURCES_KEPT = 1000


class DdsPublisher:
    """Writes a topic.

    Attributes:
        topic: The topic.
        type_name: Its type.
        dropped: How many messages were not sent, because readers did not keep up.
    """

    def __init__(self, writer: DataWriter, topic: str, type_name: str, write: Writing) -> None:
        self._writer, self._ref, self._write = writer, writer._ref, write
        self.topic, self.type_name = topic, type_name
        self.dropped = 0
        self._closed = False

    @property
    def matched(self) -> int:
        """How many subscriptions of other nodes get what is written."""
        return 0 if self._closed else self._writer.get_publication_matched_status().current_count

    def write(self, data: bytes) -> None:
        """Send a message, in 10 ms at most; after `close` it does nothing.

        Raises:
            InputError: If it is not a message of the topic's type.
        """
        result = self._write(self._ref, data)
        if result >= 0 or self._closed:
            return
        if result != RETCODE_TIMEOUT:
            raise InputError(
                f"what is written to {self.topic} is not a {self.type_name} (error {result} of Cyclone DDS)"
            )
        self.dropped += 1
        if self.dropped == 1:
            _LOG.warning("%s: a subscription does not keep up; messages are dropped", self.topic)

    def close(self) -> None:
        """Send nothing any more."""
        self._closed = True


class DdsSubscription:
    """Receives a topic.

    Attributes:
        topic: The topic.
        type_name: Its type.
        dropped: How many messages found the queue full, at least; a flood may overwrite more than can be counted.
    """

    def __init__(self, reader: DataReader, topic: str, type_name: str, qos: Qos) -> None:
        from cyclonedds._clayer import ddspy_take

        self._reader, self._ref, self._take = reader, reader._ref, ddspy_take
        self._mask = every_sample()
        self._kept, self._depth = kept_by_reader(qos), qos.depth
        self.topic, self.type_name = topic, type_name
        self.dropped = 0
        self._sources: dict[int, str] = {}
        self._closed = False

    @property
    def matched(self) -> int:
        """How many publishers it gets messages from."""
        return 0 if self._closed else self._reader.get_subscription_matched_status().current_count

    def take(self) -> list[Sample]:
        """Return the last messages that arrived, as many as the quality of service has depth; it never waits."""
        if self._closed:
            return []
        taken = self._take(self._ref, self._mask, self._kept)
        if not isinstance(taken, list):
            return []
        samples = [(data, info.publication_handle) for data, info in taken if info.valid_data]
        extra = len(samples) - self._depth
        if extra > 0:
            self.dropped += extra
            del samples[:extra]
        return [Sample(data, self._source(handle)) for data, handle in samples]

    def close(self) -> None:
        """Receive nothing any more."""
        self._closed = True

    def _source(self, handle: int) -> str:
        """Return the GUID of a publisher, in hex, by its handle."""
        known = self._sources.get(handle)
        if known is not None:
            return known
        if len(self._sources) >= _SOURCES_KEPT:
            self._sources.clear()
        found = self._reader.get_matched_publication_data(handle)
        if found is None:  # it left before its last message was taken
            return ""
        self._sources[handle] = found.key.bytes.hex()
        return self._sources[handle]
