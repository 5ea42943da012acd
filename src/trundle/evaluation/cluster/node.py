"""`Node`: runs shards of an evaluation in the pool of one machine, and writes their rows as its own parts."""

from __future__ import annotations

import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from trundle.errors import OutputError
from trundle.evaluation.row import Row
from trundle.evaluation.store.folder import PARTS, code_versions
from trundle.evaluation.store.parts import PartWriter, connect
from trundle.evaluation.store.remote import RemoteFolder, is_remote
from trundle.evaluation.store.row_encoding import encode_row


class RowSource(Protocol):
    """Runs episodes on one machine."""

    def rows(self, indices: Iterable[int], *, until: float | None = None) -> Iterator[Row]:
        """Run these episodes of the suite, until a time of `time.monotonic`, and give their rows as they end."""
        ...

    def in_flight_s(self) -> tuple[float, ...]:
        """Return for how long the episodes have been driven that have begun and not ended [s]."""
        ...

    def close(self) -> None:
        """End its processes."""
        ...


MakeSource = Callable[[int], RowSource]
"""Makes a source with so many workers. It travels to the nodes by cloudpickle."""


@dataclass(frozen=True, slots=True)
class ShardDone:
    """A shard whose rows are in a part: what the driver learns of it.

    Attributes:
        episodes: How many it has.
        outcomes: How many of them ended how.
        errors: Numbers of the episodes that ended in `error`.
        in_flight_s: For how long those had been driven that had begun when the time was over [s].
    """

    episodes: int
    outcomes: Mapping[str, int]
    errors: tuple[int, ...] = ()
    in_flight_s: tuple[float, ...] = ()


class Node:
    """Runs shards on one machine.

    Args:
        make_source: Makes what runs the episodes.
        out: The folder of the evaluation, which all nodes share, or the URI of an object store.
        tag: Part of the names of the parts that it writes; no other node has it.
        workers: Processes of its pool.
    """

    def __init__(self, make_source: MakeSource, out: str, tag: str, workers: int) -> None:
        self._make_source = make_source
        self._out = out
        self._tag = tag
        self._workers = workers
        self._source: RowSource | None = None
        self._shards = 0

    def start(self, token: str | None, packages: Sequence[str]) -> dict[str, str]:
        """Check that it can write, and say with which code it runs.

        Args:
            token: A file that the driver wrote into the folder; None in an object store.
            packages: Further packages whose versions are told.

        Raises:
            OutputError: If the folder is not the driver's.
            MissingExtraError: If a library is not installed here.
        """
        connect("writing Parquet files").close()
        if is_remote(self._out):
            RemoteFolder(self._out)
        elif token is not None and not (Path(self._out) / token).exists():
            raise OutputError(
                f"{self._out} is not the same folder here; give one that all machines of the cluster share, or an "
                "object store (s3://bucket/folder)"
            )
        return code_versions(packages)

    def run(self, indices: Sequence[int], left_s: float | None = None) -> ShardDone:
        """Run the episodes of a shard, and write their rows as one part.

        Args:
            indices: Their numbers in the suite.
            left_s: Time [s] after which those that have not ended are left; by default there is no limit.

        Raises:
            OutputError: If the part cannot be written.
        """
        if self._source is None:
            self._source = self._make_source(self._workers)
        outcomes: Counter[str] = Counter()
        errors: list[int] = []
        limit = {} if left_s is None else {"until": time.monotonic() + left_s}
        with tempfile.TemporaryDirectory(prefix="trundle-") as name:
            lines = Path(name) / "rows.jsonl"
            with lines.open("wb") as stream:
                for row in self._source.rows(indices, **limit):
                    stream.write(encode_row(row))
                    outcomes[row.outcome] += 1
                    errors += [row.index] if row.outcome == "error" else []
            if outcomes:
                self._write_part(lines, outcomes.total())
        left = self._source.in_flight_s() if limit else ()
        return ShardDone(outcomes.total(), dict(outcomes), tuple(errors), left)

    def _write_part(self, lines: Path, count: int) -> None:
        """Write rows as a part into the folder, or beside their lines and from there into the object store."""
        self._shards += 1
        remote = RemoteFolder(self._out) if is_remote(self._out) else None
        folder = Path(self._out)
        if remote is not None:
            folder = lines.parent
            (folder / PARTS).mkdir()
        with closing(PartWriter(folder, f"-{self._tag}s{self._shards}")) as parts:
            part = parts.write(lines, count)
        if remote is not None:
            remote.put(part, f"{PARTS}/{part.name}")
