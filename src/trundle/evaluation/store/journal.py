"""The journal of an evaluation: one line of JSON for each row, written when the row arrives."""

from __future__ import annotations

import errno
import os
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from trundle.evaluation.store.folder import DAMAGED_LINES, JOURNAL
from trundle.evaluation.store.row_encoding import LONGEST_LINE, decode_row
from trundle.files.writing import atomic_path, cannot_write, write_bytes


class Journal:
    """Appends lines to the journal in a folder. A line survives the process as soon as `append` returns.

    Raises:
        OutputError: If it cannot be written.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / JOURNAL
        self._open()

    def append(self, line: bytes) -> None:
        """Write a line whole, or leave the journal as it was.

        Raises:
            OutputError: If it cannot be written.
        """
        for _ in range(2):  # a write comes back short where the disk has just become full; the next one says so
            try:
                written = os.write(self._descriptor, line)
            except OSError as error:
                raise cannot_write(self.path, error) from error
            if written == len(line):
                return
            os.ftruncate(self._descriptor, os.fstat(self._descriptor).st_size - written)
        raise cannot_write(self.path, OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)))

    def sync(self) -> None:
        """Put it on the disk, so that a power cut does not undo it."""
        os.fsync(self._descriptor)

    def renew(self) -> None:
        """Replace the journal by an empty one."""
        write_bytes(self.path, b"", durable=True)
        os.close(self._descriptor)
        self._open()

    def close(self) -> None:
        """Close it."""
        os.close(self._descriptor)

    def _open(self) -> None:
        try:
            self._descriptor = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o666)
        except OSError as error:
            raise cannot_write(self.path, error) from error


@dataclass(frozen=True, slots=True)
class Entry:
    """A line of the journal that holds a row."""

    line: bytes
    values: dict[str, Any]
    offset: int


def read_journal(path: Path, damage: list[str], aside: BinaryIO | None = None) -> Iterator[Entry]:
    """Read the rows of a journal.

    Args:
        path: The journal; a missing one is empty.
        damage: Gets a message for each line that holds no row.
        aside: Gets these lines.
    """
    try:
        stream = path.open("rb")
    except FileNotFoundError:
        return
    number = offset = 0
    with stream:
        while line := stream.readline(LONGEST_LINE):
            number += 1
            try:
                entry = Entry(line, _decode(line), offset)
            except ValueError as error:
                damage.append(f"{path}:{number}: this line holds no row ({error})")
                _skip_line(stream, line, aside)
            else:
                yield entry
            offset = stream.tell()


def _decode(line: bytes) -> dict[str, Any]:
    if not line.endswith(b"\n"):
        raise ValueError("it is cut off" if len(line) < LONGEST_LINE else "it is too long")
    return decode_row(line)


def _skip_line(stream: BinaryIO, line: bytes, aside: BinaryIO | None) -> None:
    """Go to the next line, and keep this one, of which the first piece has been read."""
    while line:
        if aside is not None:
            aside.write(line)
        line = b"" if line.endswith(b"\n") else stream.readline(LONGEST_LINE)


def put_damage_aside(path: Path) -> Path:
    """Append the lines of a journal that hold no row to `journal.jsonl.damaged`, and return its path."""
    aside = path.with_name(DAMAGED_LINES)
    with aside.open("ab") as kept:
        deque(read_journal(path, [], kept), maxlen=0)
        kept.flush()
        os.fsync(kept.fileno())
    return aside


def rewrite_journal(path: Path, entries: Iterable[Entry]) -> None:
    """Replace a journal by these lines."""
    with atomic_path(path, durable=True) as temporary, temporary.open("wb") as stream:
        stream.writelines(entry.line for entry in entries)
