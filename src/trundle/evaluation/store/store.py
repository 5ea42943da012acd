"""`Store`: writes the rows of an evaluation into its folder, so that a kill at any moment loses none."""

from __future__ import annotations

import os
from array import array
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import replace
from datetime import datetime
from io import BytesIO
from pathlib import Path
from typing import Self

import numpy as np

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
from trundle.evaluation.store.journal import Journal
from trundle.evaluation.store.mending import Found, mend
from trundle.evaluation.store.parts import PartWriter, has_duckdb
from trundle.evaluation.store.row_encoding import IdSet, Keys, encode_row
from trundle.files.folder_lock import FolderLock
from trundle.files.opening import exists
from trundle.files.writing import make_folder, new_folder, write_bytes, write_text

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
        """After a write failed, refuse any other."""
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
