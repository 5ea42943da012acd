"""`Store`: writes the rows of an evaluation into its folder, and mends it, so that a kill at any moment loses none."""

from __future__ import annotations

import os
from array import array
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from datetime import datetime
from io import BytesIO
from pathlib import Path
from typing import Self

import numpy as np
from numpy.typing import NDArray

from trundle.errors import InputError, OutputError
from trundle.evaluation.row import Row
from trundle.evaluation.store.folder import (
    DAMAGED_LINES,
    JOURNAL,
    MANIFEST,
    PARTS,
    SELECTION,
    SUITE,
    WRITTEN_AFTERWARDS,
    Manifest,
    Stopped,
    check_continues,
    check_free_for_evaluation,
)
from trundle.evaluation.store.journal import Entry, Journal, put_damage_aside, read_journal, rewrite_journal
from trundle.evaluation.store.parts import PartWriter, connect, find_fault, has_duckdb, list_parts, read_keys
from trundle.evaluation.store.row_encoding import IdSet, Keys, encode_row, to_key
from trundle.files.opening import exists
from trundle.files.writing import FolderLock, make_folder, new_folder, sync_folder, write_bytes, write_text

PART_ROWS = 5000
"""Rows in the journal that become a Parquet file: about 0.1 s of work, during which no row is taken."""


class Store:
    """Writes the rows of an evaluation into its folder; made by `open`, and used in a `with` block.

    A row goes to the journal when it arrives. Every `PART_ROWS` rows, and at the end, the journal becomes a Parquet
    file; without DuckDB it stays. A kill between any two steps leaves a row in both at most, and the next `open`
    removes it from one.

    Attributes:
        folder: The folder.
        damage: What was found damaged: a message for each part and line, whose episodes run again.
        done: Ids of the rows that are there, also of rows that are not of the suite (now).
    """

    def __init__(self, folder: Path, lock: FolderLock, found: Found, part_rows: int) -> None:
        self.folder = folder
        self.damage: Sequence[str] = tuple(found.damage)
        self.done = IdSet(found.keys)
        self._found_keys, self._found_indices = found.keys, found.indices
        self._lock = lock
        self._part_rows = part_rows
        self._journal = Journal(folder)
        self._waiting = found.waiting
        self._parts = PartWriter(folder)
        self._makes_parts = has_duckdb()
        self._failed: str | None = None
        self._is_open = True

    @classmethod
    def open(
        cls,
        folder: str | os.PathLike[str] | None,
        *,
        name: str,
        suite_text: str,
        total: int,
        versions: Mapping[str, str],
        mixed: bool = False,
        overwrite: bool = False,
        part_rows: int = PART_ROWS,
    ) -> Self:
        """Start an evaluation in a folder, or continue the one that it holds.

        Args:
            folder: The folder; by default a new `runs/<time>-<name>`.
            name: Name of the suite; an evaluation can be continued with a changed suite of the same name.
            suite_text: The suite, as YAML.
            total: Number of its episodes.
            versions: Versions of the code that makes the rows; see `code_versions`.
            mixed: Continue although earlier rows were made by other code.
            overwrite: Delete the evaluation that the folder holds.
            part_rows: Rows in the journal that become a part.

        Raises:
            OutputError: If the folder holds something else, or an evaluation of another suite or other code, another
                evaluation is writing there, or it cannot be written to.
            MissingExtraError: If it has Parquet files, and DuckDB is not installed.
        """
        is_new = folder is None or not Path(folder).exists()
        try:
            path = new_folder("runs", name) if folder is None else make_folder(folder)
            lock = FolderLock(path, "evaluation")
        except OutputError as error:
            raise OutputError(f"{error}; give another folder with -o") from error
        except OSError as error:
            raise OutputError(f"cannot write to the folder {folder}: {error}; give another with -o") from error
        try:
            if overwrite:
                _clear(path)
            manifest = Manifest(
                name=name,
                total=total,
                started=datetime.now().astimezone().isoformat(timespec="seconds"),
                versions=dict(versions),
            )
            if exists(path / MANIFEST):
                manifest = check_continues(path, manifest, suite_text, mixed=mixed)
            else:
                check_free_for_evaluation(path)
            manifest.save(path)
            write_text(path / SUITE, suite_text, durable=True)  # last, as it may be there from before
            found = mend(path)
            return cls(path, lock, found, part_rows)
        except BaseException:
            lock.release()
            if is_new:
                with suppress(OSError):  # it is not empty: it stays
                    path.rmdir()
            raise

    def pending(self, ids: Iterable[str]) -> Sequence[int]:
        """Return the indices of the suite's episodes that have no row yet.

        Rows in the folder that are not of the suite stay there, and `Results` leaves them out.

        Args:
            ids: Ids of all episodes of the suite, by index. They are read only where the folder has rows.
        """
        if not len(self.done):
            return range(Manifest.load(self.folder).total)
        keys = np.fromiter((int(identity, 16) for identity in ids), np.uint64)
        self._select(keys)
        _, first = np.unique(keys, return_index=True)
        first.sort()
        return array("q", first[~self.done.contains(keys[first])].astype(np.int64).tobytes())

    def append(self, row: Row) -> None:
        """Write a row; it survives this process as soon as this returns. A row of an id that is there is left out.

        Raises:
            InputError: If its seed has more than 64 bits.
            OutputError: If it cannot be written, for example on a full disk. Nothing more can be written then.
        """
        if self._failed is not None:
            raise OutputError(self._failed)
        if row.id in self.done:
            return
        if row.seed >= 1 << 64:
            raise InputError(f"episode {row.id}: seed {row.seed} has more than 64 bits")
        with self._keeping_failure():
            self._journal.append(encode_row(row))
            self.done.add(row.id)
            self._waiting += 1
            if self._waiting >= self._part_rows and self._makes_parts:
                self._make_part()

    def note_end(self, stopped: Stopped) -> None:
        """Write down why the evaluation ends without a row for each episode.

        Raises:
            OutputError: If it cannot be written.
        """
        replace(Manifest.load(self.folder), stopped=stopped).save(self.folder)

    def close(self) -> None:
        """Put all rows on the disk, as Parquet where DuckDB is installed; closing twice does nothing.

        Raises:
            OutputError: If that fails. The rows are in the journal.
        """
        if not self._is_open:
            return
        self._is_open = False
        try:
            if self._failed is None:
                with self._keeping_failure():
                    self._journal.sync()
                    if self._waiting and self._makes_parts:
                        self._make_part()
        finally:
            self._journal.close()
            self._parts.close()
            self._lock.release()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _make_part(self) -> None:
        """Turn the journal into a Parquet file. A kill between the two steps leaves its rows in both."""
        self._parts.write(self._journal.path, self._waiting)
        self._journal.renew()
        self._waiting = 0

    @contextmanager
    def _keeping_failure(self) -> Iterator[None]:
        """Refuse all writes after one has failed."""
        try:
            yield
        except (OutputError, OSError) as error:
            self._failed = (
                f"{error}. {len(self.done)} rows are safe in {self.folder}: give the same command to continue"
            )
            raise OutputError(self._failed) from error

    def _select(self, keys: Keys) -> None:
        """Note which rows are of the suite, where the folder has others or their indices are different now."""
        indices = self._found_indices
        fits = indices < len(keys)
        if np.all(fits) and np.array_equal(keys[indices], self._found_keys):
            (self.folder / SELECTION).unlink(missing_ok=True)
            return
        content = BytesIO()
        np.save(content, keys)
        write_bytes(self.folder / SELECTION, content.getvalue(), durable=True)


def _clear(folder: Path) -> None:
    """Delete an evaluation; its manifest last, so that a kill leaves an evaluation."""
    if not exists(folder / MANIFEST):
        return
    try:
        for name in (JOURNAL, DAMAGED_LINES, *WRITTEN_AFTERWARDS, SELECTION, SUITE):
            (folder / name).unlink(missing_ok=True)
        if exists(folder / PARTS):
            for part in (folder / PARTS).iterdir():
                part.unlink()
            (folder / PARTS).rmdir()
        (folder / MANIFEST).unlink()
    except OSError as error:
        raise OutputError(f"cannot replace the evaluation in {folder}: {error}") from error


_WRITTEN = ("journal", "evaluation", "suite", "selection")
_PURPOSE = "continuing an evaluation that has Parquet files"


@dataclass(frozen=True, slots=True)
class Found:
    """The rows that a folder holds.

    Attributes:
        keys: Their ids as numbers.
        indices: Their indices in the suite with which they were made.
        waiting: How many of them are in the journal.
        damage: What was damaged, as messages.
    """

    keys: Keys
    indices: NDArray[np.int64]
    waiting: int
    damage: list[str]


def mend(folder: Path) -> Found:
    """Remove what a kill or damage left: half files, damaged parts and lines, and rows that are in a part already.

    A damaged part is kept with `.damaged` added to its name, and a damaged line in `journal.jsonl.damaged`.

    Raises:
        OutputError: If the folder cannot be read or written.
        MissingExtraError: If it has Parquet files, and DuckDB is not installed.
    """
    damage: list[str] = []
    try:
        (folder / PARTS).mkdir(exist_ok=True)
        for left in (*(folder / PARTS).glob(".*"), *(path for name in _WRITTEN for path in folder.glob(f".{name}-*"))):
            left.unlink()
        keys, indices = _mend_parts(folder, damage)
        journal_keys, journal_indices = _mend_journal(folder, IdSet(keys), damage)
    except OSError as error:
        raise OutputError(f"cannot continue the evaluation in {folder}: {error}") from error
    return Found(
        np.concatenate([keys, journal_keys]),
        np.concatenate([indices, journal_indices]),
        len(journal_keys),
        damage,
    )


def _mend_parts(folder: Path, damage: list[str]) -> tuple[Keys, NDArray[np.int64]]:
    parts = list_parts(folder)
    if not parts:
        return np.empty(0, np.uint64), np.empty(0, np.int64)
    with connect(_PURPOSE) as database:
        usable = []
        for part in parts:
            fault = find_fault(database, part)
            if fault is None:
                usable.append(part)
                continue
            aside = part.with_name(f"{part.name}.damaged")
            part.replace(aside)
            damage.append(f"{part}: {fault}; its episodes run again, and it is kept as {aside.name}")
        sync_folder(folder / PARTS)
        return read_keys(database, usable)


def _mend_journal(folder: Path, in_parts: IdSet, damage: list[str]) -> tuple[Keys, NDArray[np.int64]]:
    """Remove lines that hold no row, or one that is there already."""
    path = folder / JOURNAL
    problems: list[str] = []
    keys: list[int] = []
    indices: list[int] = []
    rows, is_new = 0, _novelty(in_parts)
    for entry in read_journal(path, problems):
        rows += 1
        if is_new(entry):
            keys.append(to_key(entry.values["id"]))
            indices.append(entry.values["index"])
    if problems:
        aside = put_damage_aside(path)
        damage.extend(f"{problem}; its episode runs again, and it is kept in {aside.name}" for problem in problems)
    if problems or len(keys) < rows:
        rewrite_journal(path, filter(_novelty(in_parts), read_journal(path, [])))
    return np.array(keys, np.uint64), np.array(indices, np.int64)


def _novelty(in_parts: IdSet) -> Callable[[Entry], bool]:
    """Says of one entry after the other whether its row is neither in a part nor came before."""
    seen = IdSet(np.empty(0, np.uint64))
    return lambda entry: entry.values["id"] not in in_parts and seen.add(entry.values["id"])
