"""`BagReader`: the topics and messages of any rosbag2, by rosbags."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from trundle.errors import InputError
from trundle.extras import check_extra
from trundle.messages.codec import DEFAULT, Distro
from trundle.values import as_path

ADVICE = "trundle record recover {path} makes a complete file of what can be read"


@dataclass(frozen=True, slots=True)
class BagTopic:
    """A topic of a bag.

    Attributes:
        name: Name of the topic.
        type_name: Type of its messages.
        count: Number of its messages.
    """

    name: str
    type_name: str
    count: int


class BagReader:
    """Reads a bag: a .mcap or .db3 file, or the folder of a rosbag2. Use it in a `with` block.

    Args:
        path: The file or the folder.
        distro: The distribution of which message types are where the bag has no definitions of them: .db3 files.

    Attributes:
        path: The file or the folder.
        topics: Its topics, sorted by name. Valid in the block.

    Raises:
        InputError: If it is not a bag, or is damaged.
        MissingExtraError: If rosbags is not installed.
    """

    def __init__(self, path: str | os.PathLike[str], *, distro: Distro = DEFAULT) -> None:
        check_extra("record", "reading a bag")
        self.path = Path(as_path(path, "a bag"))
        self._distro = distro
        self.topics: tuple[BagTopic, ...] = ()

    def __enter__(self) -> Self:
        from rosbags.highlevel import AnyReader
        from rosbags.typesys import Stores, get_typestore

        _check_place(self.path)
        try:
            store = get_typestore(Stores[f"ROS2_{self._distro.upper()}"])
            self._reader = AnyReader([self.path], default_typestore=store)
            self._reader.open()
        except Exception as error:  # rosbags raises errors of many kinds at damaged files
            raise InputError(_describe_damage(self.path, error)) from error
        counts: dict[tuple[str, str], int] = {}
        for connection in self._reader.connections:
            key = connection.topic, connection.msgtype
            counts[key] = counts.get(key, 0) + connection.msgcount
        self.topics = tuple(BagTopic(name, kind, count) for (name, kind), count in sorted(counts.items()))
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._reader.close()

    @property
    def span(self) -> tuple[float, float]:
        """Times [s] at which its first and its last message were received; (0, 0) where it has none."""
        if not self._reader.message_count:
            return 0.0, 0.0
        return self._reader.start_time / 1e9, (self._reader.end_time - 1) / 1e9

    def messages(self, topics: Sequence[BagTopic]) -> Iterator[tuple[BagTopic, float, Any]]:
        """Read the messages of topics, each with the time [s] at which it was received, in the order of these times.

        Raises:
            InputError: If the bag is damaged there.
        """
        wanted = {(topic.name, topic.type_name): topic for topic in topics}
        connections = [one for one in self._reader.connections if (one.topic, one.msgtype) in wanted]
        if not connections:
            return
        found = self._reader.messages(connections)
        while True:
            try:
                connection, stamp, data = next(found)
                message = self._reader.deserialize(data, connection.msgtype)
            except StopIteration:
                return
            except Exception as error:  # as above
                raise InputError(_describe_damage(self.path, error)) from error
            yield wanted[connection.topic, connection.msgtype], stamp / 1e9, message


def _check_place(path: Path) -> None:
    try:
        is_folder, exists = path.is_dir(), path.exists()
    except (OSError, ValueError) as error:
        raise InputError(f"cannot read {path}: {error}") from error
    if not exists:
        raise InputError(f"{path}: no such file or folder; give a .mcap or .db3 file, or the folder of a bag")
    if is_folder and not (path / "metadata.yaml").exists():
        held = sorted(one.name for one in path.iterdir() if one.suffix in (".mcap", ".db3"))
        hint = f"give {path / held[0]}" if held else "give a .mcap or .db3 file, or the folder of a bag"
        raise InputError(f"{path}: no bag: it has no metadata.yaml; {hint}")
    if not is_folder and path.suffix not in (".mcap", ".db3", ".bag"):
        raise InputError(f"{path}: not a bag: give a .mcap or .db3 file, or the folder of a bag")


def _describe_damage(path: Path, error: Exception) -> str:
    text = str(error) or type(error).__name__
    advice = f"; {ADVICE.format(path=path)}" if path.suffix == ".mcap" else ""
    return f"{path}: the bag is damaged, or was not closed: {text.rstrip('.')}{advice}"
