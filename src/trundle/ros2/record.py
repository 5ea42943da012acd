"""`WireRecord`: what goes over the wire as a rosbag2 MCAP file."""

from __future__ import annotations

import logging
import os
import threading
import time as clock
from collections.abc import Mapping
from typing import Protocol, Self

from trundle.bags.bag_writer import BagWriter, Topic
from trundle.bags.recorder import FLUSH_S, check_free, partial_name
from trundle.errors import InputError, OutputError
from trundle.extras import check_extra
from trundle.files.writing import cannot_write, output_path
from trundle.messages.codec import Distro
from trundle.messages.qos import Qos

_LOGGER = logging.getLogger(__name__)

WIRE_RECORD = "trundle_wire"
"""Name of the metadata record that says where the messages come from."""

_RESET_S = 0.5
"""Simulated time that falls by more than this was reset; less is the order in which two threads got here."""


class Descriptions(Protocol):
    """What describes message types, as `Codec` does."""

    def definition(self, type_name: str) -> str:
        """Return the text of a type and of all types in it."""
        ...

    def type_hash(self, type_name: str) -> str:
        """Return the hash of a type, `RIHS01_…`."""
        ...


class WireRecord:
    """Records the messages of topics, written and received, with their bytes as they are, their QoS and type hashes.

    While it goes on, the file is called `wire.partial.mcap` for `wire.mcap` and is flushed each second: where the
    process is killed, `trundle record recover` makes it complete up to there. `close` gives it its name. Messages are
    stamped with simulated time; where that is reset to 0, the recording goes on after what it has.

    A recording that fails, as the disk is full, does not disturb what is recorded: it ends with one warning, and
    `error` says why.

    Args:
        path: The file, which ends in .mcap.
        distro: The distribution of ROS 2 whose types it has.
        types: Describes the types.
        facts: What else is known of the wire (transport, domain, node …), for its metadata.
        overwrite: Replace a recording of this name, or what a killed run left of one.

    Attributes:
        path: The file.
        error: Why it stopped; empty while it works.

    Raises:
        InputError: If the path does not end in .mcap.
        OutputError: If there is such a recording, or it cannot be written.
        MissingExtraError: If rosbags or mcap is not installed.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        distro: Distro,
        types: Descriptions,
        *,
        facts: Mapping[str, str] | None = None,
        overwrite: bool = False,
    ) -> None:
        check_extra("record", "--record")
        self.path = output_path(path)
        if self.path.suffix != ".mcap":
            raise InputError(f"a recording's file ends in .mcap, got {self.path}")
        if not overwrite:
            check_free(self.path)
        self.error = ""
        self._types = types
        self._partial = partial_name(self.path)
        self._topics: dict[tuple[str, str], Topic] = {}
        self._lock = threading.Lock()
        self._is_open = True
        self._base = self._last = self._flushed_at = 0.0
        self._flushed_clock = clock.monotonic()
        self._bag = BagWriter(self._partial, distro, file_name=self.path.name)
        self._bag.add_metadata(WIRE_RECORD, {"distro": distro, **(facts or {})})

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def messages(self) -> int:
        """How many were recorded."""
        return sum(topic.count for topic in self._bag.topics)

    def add(self, topic: str, type_name: str, qos: Qos, data: bytes, time: float) -> None:
        """Record a message; any thread may call this.

        Args:
            topic: Its full name.
            type_name: Type of the message.
            qos: What it was offered with, or what it was asked for with.
            data: Its CDR bytes with their header.
            time: Simulated time [s].
        """
        with self._lock:
            if self._is_open:
                try:
                    self._write(topic, type_name, qos, data, self._since_start(time))
                except (OSError, ValueError, InputError, OutputError) as error:
                    self._fail(error)

    def close(self) -> None:
        """Write the index and give the file its name; closing twice does nothing.

        Raises:
            OutputError: If it cannot be renamed.
        """
        with self._lock:
            if not self._is_open:
                return
            self._is_open = False
            try:
                self._bag.close()
            except OutputError as error:
                self._fail(error)
                return
        try:
            self._partial.replace(self.path)
        except OSError as error:
            raise cannot_write(self.path, error) from error

    def _since_start(self, time: float) -> float:
        """Return the time in the recording, in which what came before a reset lies before what comes after it."""
        if time < self._last - _RESET_S:
            self._base += self._last
            self._flushed_at -= self._last
            self._last = 0.0
        self._last = max(self._last, time)
        return self._base + time

    def _write(self, name: str, type_name: str, qos: Qos, data: bytes, time: float) -> None:
        topic = self._topics.get((name, type_name))
        if topic is None:
            definition, type_hash = self._types.definition(type_name), self._types.type_hash(type_name)
            topic = self._bag.add_topic(name, type_name, definition, type_hash, qos)
            self._topics[name, type_name] = topic
        self._bag.write(topic, round(time * 1e9), data)
        now = clock.monotonic()
        if self._last - self._flushed_at >= FLUSH_S or now - self._flushed_clock >= FLUSH_S:
            self._bag.flush()
            self._flushed_at, self._flushed_clock = self._last, now

    def _fail(self, error: Exception) -> None:
        reason = cannot_write(self._partial, error) if isinstance(error, OSError) else error
        self.error = f"{self._partial}: the recording stopped: {reason}"
        self._is_open = False
        _LOGGER.warning("%s; trundle record recover %s keeps what it has", self.error, self._partial)
        self._bag.abandon()
