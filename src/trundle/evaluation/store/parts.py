"""The Parquet files of an evaluation: written from the journal in bulk, and checked by the digest in their name."""

from __future__ import annotations

import errno
import hashlib
import os
import re
from collections.abc import Iterable, Sequence
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from trundle.errors import OutputError
from trundle.evaluation.store.folder import PARTS
from trundle.evaluation.store.row_encoding import LONGEST_LINE, SQL_TYPES, Keys
from trundle.extras import missing_extra
from trundle.files.writing import cannot_write, sync_file, sync_folder

if TYPE_CHECKING:
    import duckdb

_NAME = re.compile(r"\d{6,}(-\w+)?-(?P<digest>[0-9a-f]{16})\.parquet")
_NEEDED = ("id", "index", "outcome")
_PLACE = ", filename = true, file_row_number = true"


def has_duckdb() -> bool:
    """Return whether DuckDB is installed."""
    return find_spec("duckdb") is not None


def connect(purpose: str) -> duckdb.DuckDBPyConnection:
    """Start DuckDB in memory, on one thread, without keeping what it reads of files.

    Args:
        purpose: What needs it, for the message where it is missing.

    Raises:
        MissingExtraError: If it is not installed.
    """
    try:
        import duckdb
    except ImportError as error:
        raise missing_extra(purpose, "DuckDB", "evaluate") from error
    database = duckdb.connect(":memory:", config={"threads": 1, "temp_directory": ""})
    with suppress(duckdb.CatalogException):  # DuckDB before 1.3 keeps nothing.
        database.execute("SET enable_external_file_cache = false")
    return database


def list_parts(folder: Path) -> list[Path]:
    """Return the Parquet files of an evaluation's folder, in order."""
    return sorted((folder / PARTS).glob("[!.]*.parquet"))


class PartWriter:
    """Writes files of rows as the parts of a folder; DuckDB is started by the first one.

    Args:
        folder: The folder of the evaluation.
        tag: Tells its parts from those of other writers into the same evaluation.
    """

    def __init__(self, folder: Path, tag: str = "") -> None:
        self._folder = folder / PARTS
        self._tag = tag
        self._database: duckdb.DuckDBPyConnection | None = None

    def write(self, rows: Path, count: int) -> Path:
        """Write a file of lines as the next part, onto the disk.

        Args:
            rows: The lines of JSON, all of them rows.
            count: How many rows they are.

        Returns:
            The part.

        Raises:
            OutputError: If it cannot be written, or gets another number of rows. If it cannot be written, nothing is
                left behind.
            MissingExtraError: If DuckDB is not installed.
        """
        if self._database is None:
            self._database = connect("writing Parquet files")
        import duckdb

        temporary = self._folder / f".writing{self._tag}.parquet"
        try:
            copied = self._database.execute(
                f"COPY ({select_lines(rows)}) TO {quote(temporary)} "
                "(FORMAT parquet, COMPRESSION zstd, USE_TMP_FILE false)"
            ).fetchone()
            digest = digest_file(temporary)
            sync_file(temporary)
            found = list_parts(self._folder.parent)
            taken = (int(path.name.split("-")[0]) for path in found if _NAME.fullmatch(path.name))
            part = self._folder / f"{max(taken, default=0) + 1:06d}{self._tag}-{digest}.parquet"
            temporary.replace(part)
            sync_folder(self._folder)
        except (OSError, duckdb.Error) as error:
            if isinstance(error, OSError):
                raise cannot_write(self._folder, error) from error
            number = errno.ENOSPC if os.strerror(errno.ENOSPC) in str(error) else errno.EIO
            raise cannot_write(self._folder, OSError(number, str(error).splitlines()[0])) from error
        finally:
            temporary.unlink(missing_ok=True)
        written = 0 if copied is None else int(copied[0])
        if written != count:
            raise OutputError(f"{self._folder}: a part got {written} rows of {count}")
        return part

    def close(self) -> None:
        """Stop DuckDB."""
        if self._database is not None:
            self._database.close()
        self._database = None


def find_fault(database: duckdb.DuckDBPyConnection, part: Path) -> str | None:
    """Return why a part cannot be used; None where it can."""
    import duckdb

    match = _NAME.fullmatch(part.name)
    if match is None:
        return "trundle did not write it"
    try:
        if digest_file(part) != match["digest"]:
            return "it is damaged: its content is not what was written"
        columns = database.execute(f"DESCRIBE SELECT * FROM read_parquet({quote(part)})").fetchall()
    except (OSError, duckdb.Error) as error:
        return f"it cannot be read ({str(error).splitlines()[0]})"
    found = {name: kind for name, kind, *_ in columns}
    wrong = [name for name, kind in SQL_TYPES.items() if name in found and found[name] != kind]
    wrong += [name for name in _NEEDED if name not in found]
    return f"its columns {', '.join(wrong)} are not those of a row" if wrong else None


def digest_file(path: Path) -> str:
    """Return a hash of a file's content, sixteen digits."""
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, lambda: hashlib.blake2b(digest_size=8)).hexdigest()


def select_lines(rows: Path) -> str:
    """Return SQL that gives the rows of a file of lines of JSON, which must not be empty."""
    columns = ", ".join(f"{quote_name(name)}: {quote(kind)}" for name, kind in SQL_TYPES.items())
    return (
        f"SELECT * FROM read_json({quote(rows)}, format = 'newline_delimited', columns = {{{columns}}}, "
        f"maximum_object_size = {LONGEST_LINE})"
    )


def select_parts(parts: Sequence[Path], columns: Iterable[str] = tuple(SQL_TYPES), *, without: str = "") -> str:
    """Return SQL that gives these columns of the rows of all parts; a column that a part lacks is NULL.

    Args:
        parts: The files.
        columns: Names.
        without: Table of rows that are left out, as `select_repeated` gives; empty for none.
    """
    names = list(columns)
    typed = ", ".join(f"NULL::{SQL_TYPES[name]} AS {quote_name(name)}" for name in names)
    empty = f"(SELECT {typed} LIMIT 0)"
    if not parts:
        return empty
    wanted = ", ".join(quote_name(name) for name in names)
    source = _read_parts(parts)
    if without:
        source = f"{_read_parts(parts, _PLACE)} ANTI JOIN {quote_name(without)} USING (filename, file_row_number)"
    return f"SELECT {wanted} FROM ({empty} UNION ALL BY NAME SELECT * FROM {source})"


def select_repeated(parts: Sequence[Path]) -> str:
    """Return SQL that gives the places of rows whose id is in another row before."""
    return (
        "SELECT filename, file_row_number FROM (SELECT filename, file_row_number, "
        "row_number() OVER (PARTITION BY id ORDER BY filename, file_row_number) AS number "
        f"FROM {_read_parts(parts, _PLACE)}) WHERE number > 1"
    )


def _read_parts(parts: Sequence[Path], options: str = "") -> str:
    return f"read_parquet([{', '.join(quote(path) for path in parts)}], union_by_name = true{options})"


def read_keys(database: duckdb.DuckDBPyConnection, parts: Sequence[Path]) -> tuple[Keys, NDArray[np.int64]]:
    """Read the ids, as numbers, and the indices of the rows of all parts."""
    rows = select_parts(parts, ("id", "index"))
    found = database.execute(f"""SELECT ('0x' || id)::UBIGINT AS key, "index" FROM ({rows})""").fetchnumpy()
    return np.asarray(found["key"], np.uint64), np.asarray(found["index"], np.int64)


def quote(text: str | os.PathLike[str]) -> str:
    """Return a text as SQL writes it."""
    return "'" + str(text).replace("'", "''") + "'"


def quote_name(name: str) -> str:
    """Return a name as SQL writes it."""
    return '"' + name.replace('"', '""') + '"'
