"""Mends an evaluation's folder after a kill or damage, so that every row in it is whole and there once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from trundle.errors import OutputError
from trundle.evaluation.store.folder import JOURNAL, PARTS
from trundle.evaluation.store.journal import Entry, put_damage_aside, read_journal, rewrite_journal
from trundle.evaluation.store.parts import connect, find_fault, list_parts, read_keys
from trundle.evaluation.store.row_encoding import IdSet, Keys, to_key
from trundle.files.writing import sync_folder

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
