"""`read_info`: what a bag holds."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from mcap.records import Channel, Message, Metadata, Schema

from trundle.bags.bag_reader import BagReader, BagTopic
from trundle.bags.records import BagRecords, has_end
from trundle.bags.run_record import RunRecord, parse_records, read_record
from trundle.errors import InputError
from trundle.extras import check_extra
from trundle.messages.codec import DEFAULT, Distro
from trundle.values import as_path


@dataclass(frozen=True, slots=True, eq=False)
class BagInfo:
    """What a bag holds.

    Attributes:
        path: The file or the folder.
        size_bytes: Size of all its files together.
        begin_s, end_s: Times of the first and the last message [s].
        topics: Its topics, sorted by name.
        damage: Why it cannot be read to its end; None if it is complete.
        record: The settings and the end of its run, in trundle's recordings; else None.
    """

    path: Path
    size_bytes: int
    begin_s: float
    end_s: float
    topics: tuple[BagTopic, ...]
    damage: str | None
    record: RunRecord | None

    @property
    def messages(self) -> int:
        """Number of messages."""
        return sum(topic.count for topic in self.topics)

    def as_dict(self) -> Mapping[str, object]:
        """Return everything as plain values, for JSON."""
        record = self.record
        ended = None if record is None else record.episode
        return {
            "path": self.path,
            "size_bytes": self.size_bytes,
            "complete": self.damage is None,
            "damage": self.damage,
            "begin_s": self.begin_s,
            "end_s": self.end_s,
            "duration_s": self.end_s - self.begin_s,
            "messages": self.messages,
            "run": None if record is None else record.run.name,
            "distro": None if record is None else record.distro,
            "outcome": None if ended is None else ended["outcome"],
            "topics": [{"name": topic.name, "type": topic.type_name, "messages": topic.count} for topic in self.topics],
        }


def read_info(path: str | os.PathLike[str], *, distro: Distro = DEFAULT) -> BagInfo:
    """Look into a bag, also into an MCAP file whose writer was killed.

    Raises:
        InputError: If it is not a bag, or nothing of it can be read.
        MissingExtraError: If rosbags or mcap is not installed.
    """
    check_extra("record", "reading a bag")
    source = Path(as_path(path, "a bag"))
    if source.suffix == ".mcap" and not source.is_dir() and not has_end(source):
        return _scan(source)
    with BagReader(source, distro=distro) as bag:
        begin, end = bag.span
        return BagInfo(source, _size(source), begin, end, bag.topics, None, read_record(source))


def _scan(source: Path) -> BagInfo:
    """Look into an MCAP file without its index."""
    records = BagRecords(source)
    schemas: dict[int, str] = {}
    channels: dict[int, tuple[str, str]] = {}
    counts: dict[tuple[str, str], int] = {}
    metadata: dict[str, Mapping[str, str]] = {}
    times: list[int] = []
    for record in records:
        if isinstance(record, Schema):
            schemas[record.id] = record.name
        elif isinstance(record, Channel):
            key = channels[record.id] = record.topic, schemas.get(record.schema_id, "")
            counts.setdefault(key, 0)
        elif isinstance(record, Message) and record.channel_id in channels:
            counts[channels[record.channel_id]] += 1
            times = [min([record.log_time, *times[:1]]), max([record.log_time, *times[1:]])]
        elif isinstance(record, Metadata):
            metadata[record.name] = record.metadata
    if not times:
        raise InputError(
            f"{source}: no message of it can be read ({records.damage or 'it is empty'}); give another recording"
        )
    topics = tuple(BagTopic(name, kind, count) for (name, kind), count in sorted(counts.items()))
    begin, end = times[0] / 1e9, times[1] / 1e9
    return BagInfo(source, _size(source), begin, end, topics, records.damage, parse_records(source, metadata))


def _size(path: Path) -> int:
    files = [one for one in path.iterdir() if one.is_file()] if path.is_dir() else [path]
    return sum(one.stat().st_size for one in files)
