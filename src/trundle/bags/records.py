"""`BagRecords`: the records of an MCAP file in order, up to its end or to where it is damaged."""

from __future__ import annotations

import io
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import BinaryIO

import zstandard
from mcap.exceptions import EndOfFile, McapError, RecordLengthLimitExceeded
from mcap.records import Chunk, Footer, McapRecord
from mcap.stream_reader import MAGIC_SIZE, StreamReader, breakup_chunk

from trundle.errors import InputError
from trundle.files.opening import describe_unreadable, open_file

_MOST_CHUNK_BYTES = 2**30
_MAGIC = b"\x89MCAP0\r\n"

_DAMAGE = (
    McapError,
    zstandard.ZstdError,
    ValueError,
    RuntimeError,
    EOFError,
    OverflowError,
)
"""What mcap and its decompressors raise at a record that is cut off or damaged."""


class BagRecords:
    """Iterates over the records of an MCAP file, without its index.

    Args:
        path: The file.

    Attributes:
        path: The file.
        damage: Why reading stopped before the end of the file; None where the file is complete. Valid after iterating.

    Raises:
        InputError: If the file cannot be opened, or is not an MCAP file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.damage: str | None = None
        self._stream = open_bag_file(path)

    def __iter__(self) -> Iterator[McapRecord]:
        with self._stream as stream:
            ended = False
            try:
                for record in self._records(stream):
                    ended = isinstance(record, Footer)
                    yield record
            except (EndOfFile, RecordLengthLimitExceeded, struct.error):
                self.damage = "it ends within a record"
            except _DAMAGE as error:
                self.damage = f"a record is damaged: {error}"
            if not ended and self.damage is None:
                self.damage = "it has no end"

    def _records(self, stream: BinaryIO) -> Iterator[McapRecord]:
        size = stream.seek(0, 2)
        stream.seek(0)
        for record in StreamReader(stream, emit_chunks=True, record_size_limit=size).records:
            if isinstance(record, Chunk):
                yield from _open_chunk(record)
            else:
                yield record


class _BagFile(io.BufferedReader):
    """A file of which no more is read at once than it has: a damaged length takes no memory."""

    def __init__(self, raw: io.RawIOBase) -> None:
        super().__init__(raw)
        self._size = self.seek(0, 2)
        self.seek(0)

    def read(self, size: int | None = -1, /) -> bytes:
        """Read so many bytes, or all; nothing where there are fewer."""
        return b"" if size is not None and size > self._size - self.tell() else super().read(size)


def open_bag_file(path: Path) -> BinaryIO:
    """Open an MCAP file.

    Raises:
        InputError: If it cannot be opened, or is not an MCAP file.
    """
    try:
        stream = _BagFile(open_file(path).detach())
    except OSError as error:
        raise InputError(describe_unreadable(path, error, "the .mcap file of a recording")) from error
    if stream.read(MAGIC_SIZE) != _MAGIC:
        stream.close()
        raise InputError(f"{path}: not an MCAP file: it does not begin like one; give the .mcap file of a recording")
    stream.seek(0)
    return stream


def has_end(path: Path) -> bool:
    """Return whether an MCAP file ends as a complete one does.

    Raises:
        InputError: If it cannot be opened, or is not an MCAP file.
    """
    with open_bag_file(path) as stream:
        size = stream.seek(0, 2)
        stream.seek(max(0, size - MAGIC_SIZE))
        return size > 2 * MAGIC_SIZE and stream.read() == _MAGIC


def _open_chunk(chunk: Chunk) -> list[McapRecord]:
    """Return the records in a chunk, which are checked against its checksum."""
    size = chunk.uncompressed_size
    if chunk.compression == "zstd":
        size = max(size, zstandard.frame_content_size(chunk.data))
    if size > _MOST_CHUNK_BYTES:
        raise ValueError(f"a chunk of {size} bytes")
    return breakup_chunk(chunk, validate_crc=True)
