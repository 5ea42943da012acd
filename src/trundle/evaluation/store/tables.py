"""The rows of an evaluation's folder as a table: in DuckDB, or from the journal alone."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from trundle.errors import InputError
from trundle.evaluation.store.folder import JOURNAL
from trundle.evaluation.store.journal import read_journal
from trundle.evaluation.store.parts import (
    connect,
    find_fault,
    list_parts,
    quote,
    quote_name,
    read_keys,
    select_lines,
    select_parts,
    select_repeated,
)
from trundle.evaluation.store.row_encoding import SQL_TYPES, IdSet, Keys, decode_row, to_key

Column = NDArray[Any]
_BATCH = 5000
_LARGE_BATCH = 50_000
_NUMBERS = {"DOUBLE": np.float64, "BIGINT": np.int64, "UBIGINT": np.uint64}


class JournalTable:
    """The rows of a journal, read where they lie."""

    def __init__(self, folder: Path, selection: Keys | None, damage: list[str]) -> None:
        places: dict[int, int] = {}
        ids: list[str] = []
        offsets: list[int] = []
        indices: list[int] = []
        wanted = None if selection is None else _first_places(selection)
        self._path = folder / JOURNAL
        for entry in read_journal(self._path, damage):
            key = to_key(entry.values["id"])
            if key in places or (wanted is not None and key not in wanted):
                continue
            places[key] = len(ids)
            ids.append(entry.values["id"])
            offsets.append(entry.offset)
            indices.append(entry.values["index"] if wanted is None else wanted[key])
        order = np.argsort(np.array(indices, np.int64), kind="stable")
        self._ids = [ids[place] for place in order]
        self._offsets = np.array(offsets, np.int64)[order]
        self._indices = np.array(indices, np.int64)[order]

    def __len__(self) -> int:
        return len(self._ids)

    def rows(self) -> Iterator[dict[str, Any]]:
        """Yield the values of the rows, one after the other."""
        return self._read(range(len(self._ids)))

    def columns(self, names: Sequence[str]) -> dict[str, Column]:
        """Return columns as arrays."""
        gathered: dict[str, list[Any]] = {name: [] for name in names}
        for values in self.rows():
            for name, column in gathered.items():
                column.append(values.get(name))
        return {name: _as_array(name, column) for name, column in gathered.items()}

    def find(self, prefix: str, limit: int) -> list[dict[str, Any]]:
        """Return the first rows whose id starts so."""
        places = [place for place, identity in enumerate(self._ids) if identity.startswith(prefix)]
        return list(self._read(places[:limit]))

    def close(self) -> None:
        """Free what it holds."""
        self._ids = []

    def _read(self, places: Sequence[int]) -> Iterator[dict[str, Any]]:
        if not places:
            return
        with self._path.open("rb") as stream:
            for place in places:
                stream.seek(int(self._offsets[place]))
                yield {**decode_row(stream.readline()), "index": int(self._indices[place])}


class SqlTable:
    """The rows of parts and journal, in DuckDB as the view `episodes`.

    In the view, what was varied has one column for each name (`vary_friction`).
    """

    def __init__(self, folder: Path, selection: Keys | None, damage: list[str]) -> None:
        self.database = connect("reading Parquet files")
        # The journal first: a row that becomes part of a Parquet file meanwhile is then in both, rather than in none.
        self._load_journal(folder, damage)
        parts = []
        for part in list_parts(folder):
            fault = find_fault(self.database, part)
            if fault is None:
                parts.append(part)
            else:
                damage.append(f"{part}: {fault}; its episodes run again when the evaluation is continued")
        self._make_view(parts, selection)

    def __len__(self) -> int:
        return int(self._fetch('SELECT count("index") FROM rows')[0][0])

    def rows(self) -> Iterator[dict[str, Any]]:
        """Yield the values of the rows, one after the other."""
        names = list(SQL_TYPES)
        for some in self._some_rows(_BATCH):
            for values in self._fetch(f"SELECT {_list(names)} {some}"):
                yield dict(zip(names, values, strict=True))

    def columns(self, names: Sequence[str]) -> dict[str, Column]:
        """Return columns as arrays."""
        nested = [name for name in names if SQL_TYPES[name] not in ("VARCHAR", *_NUMBERS)]
        flat = [name for name in names if name not in nested]
        chunks: dict[str, list[Column]] = {name: [_as_array(name, [])] for name in names}
        texts: dict[str, str] = {}
        for some in self._some_rows(_LARGE_BATCH):
            found: dict[str, Any] = {}
            if flat:
                found = self.database.execute(f"SELECT {_list(flat)} {some}").fetchnumpy()
            for name in flat:
                chunks[name].append(_unmask(name, found[name], texts))
            for name in nested:
                values = self._fetch(f"SELECT {quote_name(name)} {some}")
                chunks[name].append(_as_array(name, [value for (value,) in values]))
        return {name: np.concatenate(chunks.pop(name)) for name in names}

    def find(self, prefix: str, limit: int) -> list[dict[str, Any]]:
        """Return the first rows whose id starts so."""
        names = list(SQL_TYPES)
        found = self._fetch(f"SELECT {_list(names)} FROM rows WHERE starts_with(id, {quote(prefix)}) LIMIT {limit}")
        return [dict(zip(names, values, strict=True)) for values in found]

    def close(self) -> None:
        """Free what it holds."""
        self.database.close()

    def _some_rows(self, size: int) -> Iterator[str]:
        """SQL for about so many rows at a time, by index: sorting all at once would need memory for all."""
        found: dict[str, Any] = self.database.execute('SELECT DISTINCT "index" FROM rows').fetchnumpy()
        indices = np.sort(found["index"])
        for place in range(0, len(indices), size):
            batch = indices[place : place + size]
            yield f'FROM rows WHERE "index" BETWEEN {batch[0]} AND {batch[-1]} ORDER BY "index"'

    def _load_journal(self, folder: Path, damage: list[str]) -> None:
        seen = IdSet(np.empty(0, np.uint64))
        with tempfile.NamedTemporaryFile(suffix=".jsonl") as copy:
            entries = read_journal(folder / JOURNAL, damage)
            copy.writelines(entry.line for entry in entries if seen.add(entry.values["id"]))
            copy.flush()
            source = select_lines(Path(copy.name)) if Path(copy.name).stat().st_size else select_parts([])
            self._fetch(f"CREATE TABLE journal AS {source}")

    def _make_view(self, parts: Sequence[Path], selection: Keys | None) -> None:
        keys, _ = read_keys(self.database, parts)
        repeated = ""
        if len(np.unique(keys)) < len(keys):  # Shards of a cluster that ran twice.
            repeated = "repeated"
            self._fetch(f"CREATE TABLE repeated AS {select_repeated(parts)}")
        self._fetch(f"CREATE VIEW in_parts AS {select_parts(parts, without=repeated)}")
        self._fetch("DELETE FROM journal WHERE id IN (SELECT id FROM in_parts)")
        self._fetch("CREATE VIEW every_row AS SELECT * FROM in_parts UNION ALL SELECT * FROM journal")
        source = "every_row"
        if selection is not None:
            keys, first = np.unique(selection, return_index=True)
            self.database.register("given", {"key": keys, "number": first})
            self._fetch("CREATE TABLE selection AS SELECT * FROM given")
            self.database.unregister("given")
            source = (
                f'(SELECT every.* REPLACE (number AS "index") FROM {source} AS every '
                "JOIN selection ON ('0x' || id)::UBIGINT = key)"
            )
        self._fetch(f"CREATE VIEW rows AS SELECT * FROM {source}")
        varied = self._fetch(
            "SELECT DISTINCT unnest(map_keys(vary)) AS name FROM rows WHERE vary IS NOT NULL ORDER BY 1"
        )
        plain = _list([name for name in SQL_TYPES if name != "vary"])
        own = "".join(f", vary[{quote(name)}] AS {quote_name(f'vary_{name}')}" for (name,) in varied)
        self._fetch(f"CREATE VIEW episodes AS SELECT {plain}{own} FROM rows")

    def _fetch(self, sql: str) -> list[tuple[Any, ...]]:
        return self.database.execute(sql).fetchall()


Table = JournalTable | SqlTable
"""Rows, by index, without duplicates; only those of the selection where there is one."""


def _first_places(selection: Keys) -> dict[int, int]:
    keys, first = np.unique(selection, return_index=True)
    return dict(zip(keys.tolist(), first.tolist(), strict=True))


def _list(names: Sequence[str]) -> str:
    return ", ".join(quote_name(name) for name in names)


def check_columns(names: Sequence[str]) -> None:
    """Refuse names that are no columns."""
    unknown = [name for name in names if name not in SQL_TYPES]
    if unknown:
        raise InputError(f"no column {', '.join(unknown)}; there are: {', '.join(SQL_TYPES)}")


def _as_array(name: str, values: Sequence[Any]) -> Column:
    """Return an array of a column's values; a number that is missing is NaN, and makes whole numbers floats."""
    kind = SQL_TYPES[name]
    if kind in _NUMBERS:
        is_missing = any(value is None for value in values)
        if kind == "DOUBLE" or is_missing:
            return np.array([np.nan if value is None else value for value in values], float)
        return np.array(values, _NUMBERS[kind])
    column = np.empty(len(values), object)
    for place, value in enumerate(values):
        column[place] = value
    return column


def _unmask(name: str, column: Column, texts: dict[str, str]) -> Column:
    """Convert an array with masked missing values as `_as_array` does; equal texts become one object."""
    values = np.ma.getdata(column)
    is_missing = np.ma.getmaskarray(column)
    if SQL_TYPES[name] == "VARCHAR":
        kept = (None if missing else text for text, missing in zip(values.tolist(), is_missing.tolist(), strict=True))
        return _as_array(name, [text and texts.setdefault(text, text) for text in kept])
    if is_missing.any():
        values = values.astype(float)
        values[is_missing] = np.nan
    return values
