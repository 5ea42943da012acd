"""`recover`: a complete recording from one whose writer was killed."""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import yaml
from mcap.records import Attachment, Channel, Message, Metadata, Schema

from trundle.bags.bag_writer import METADATA, BagWriter, Topic
from trundle.bags.records import BagRecords
from trundle.errors import InputError, OutputError
from trundle.files.writing import atomic_path
from trundle.values import as_path

PARTIAL = ".partial"


@dataclass(frozen=True, slots=True)
class Recovered:
    """What was recovered from a recording.

    Attributes:
        path: The complete file.
        messages: Number of its messages.
        end_s: Time of the last message [s].
        duration_s: From the first to the last message [s].
        damage: What is wrong with the source; None if it was complete.
    """

    path: Path
    messages: int
    end_s: float
    duration_s: float
    damage: str | None


def recovered_name(path: Path) -> Path:
    """Return the name of the recovered file: `run.mcap` of `run.partial.mcap`, else `name.recovered.mcap`."""
    stem = path.stem
    if stem.endswith(PARTIAL):
        return path.with_name(f"{stem.removesuffix(PARTIAL)}{path.suffix}")
    return path.with_name(f"{stem}.recovered{path.suffix}")


def recover(
    path: str | os.PathLike[str], out: str | os.PathLike[str] | None = None, *, overwrite: bool = False
) -> Recovered:
    """Copy the messages of a recording up to where it is cut off or damaged, with a new index.

    The source is kept.

    Args:
        path: The recording: an MCAP file of any writer.
        out: The new file. By default, it is `run.mcap` for `run.partial.mcap`, and `name.recovered.mcap` for others.
        overwrite: Replace the new file if it exists.

    Raises:
        InputError: If the source is not an MCAP file, or no message of it can be read.
        OutputError: If the new file exists, or cannot be written.
    """
    source = Path(as_path(path, "a recording"))
    target = recovered_name(source) if out is None else Path(as_path(out, "the recovered recording"))
    if target.exists():
        if target.samefile(source):
            raise OutputError(f"{target} is the recording itself; give another file with -o")
        if not overwrite:
            raise OutputError(f"{target} already exists; give another file with -o, or replace it with --overwrite")
    records = BagRecords(source)
    with atomic_path(target, durable=True) as temporary:
        copy = _Copy(temporary, target.name)
        try:
            for record in records:
                copy.add(record)
            if not copy.messages:
                raise InputError(
                    f"{source}: no message of it can be read ({records.damage or 'it is empty'}); give another"
                )
            copy.close()
        finally:
            copy.bag.abandon()
    first, last = copy.span
    return Recovered(target, copy.messages, last / 1e9, (last - first) / 1e9, records.damage)


class _Copy:
    """Records on their way to a new bag."""

    def __init__(self, path: Path, name: str) -> None:
        self.bag = BagWriter(path, "", file_name=name)
        self._schemas: dict[int, Schema] = {}
        self._topics: dict[int, Topic] = {}
        self._custom: dict[str, str] = {}

    @property
    def messages(self) -> int:
        """Number of messages that were copied."""
        return sum(topic.count for topic in self.bag.topics)

    @property
    def span(self) -> tuple[int, int]:
        """Times [ns] of the first and the last message."""
        return self.bag.span

    def add(self, record: object) -> None:
        """Copy a record if it is content; the new bag makes its own index."""
        if isinstance(record, Schema):
            self._schemas[record.id] = record
        elif isinstance(record, Channel):
            self._add_channel(record)
        elif isinstance(record, Message):
            topic = self._topics.get(record.channel_id)
            if topic is None:
                raise ValueError(f"a message of channel {record.channel_id}, which is not defined")
            self.bag.write(topic, record.log_time, record.data, published=record.publish_time)
        elif isinstance(record, Metadata) and record.name == METADATA:
            self._read_metadata(record)
        elif isinstance(record, Metadata):
            if "distro" in record.metadata:
                self.bag.distro = record.metadata["distro"]
            self.bag.add_metadata(record.name, record.metadata)
        elif isinstance(record, Attachment):
            self.bag.add_attachment(record)

    def close(self) -> None:
        """Write the index."""
        self.bag.close(self._custom)

    def _add_channel(self, channel: Channel) -> None:
        if channel.id in self._topics:
            return
        schema = self._schemas.get(channel.schema_id, Schema(id=0, data=b"", encoding="", name=""))
        self._topics[channel.id] = self.bag.add_channel(
            channel.topic, schema.name, schema.encoding, schema.data, channel.metadata, channel.message_encoding
        )

    def _read_metadata(self, record: Metadata) -> None:
        """Take over what the bag's metadata says about its writer; the rest is made again."""
        with suppress(yaml.YAMLError):
            facts = yaml.safe_load(record.metadata.get("serialized_metadata", ""))
            if isinstance(facts, dict):
                self.bag.distro = str(facts.get("ros_distro") or self.bag.distro)
                custom = facts.get("custom_data")
                if isinstance(custom, dict):
                    self._custom = {str(key): str(value) for key, value in custom.items()}
