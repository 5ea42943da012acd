"""`Results`: reads the rows of an evaluation's folder, also while they are being written."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from trundle.errors import InputError
from trundle.evaluation.row import Row
from trundle.evaluation.store.folder import SELECTION, SUITE, Manifest, Stopped, check_holds_evaluation
from trundle.evaluation.store.parts import has_duckdb, list_parts
from trundle.evaluation.store.row_encoding import Keys
from trundle.evaluation.store.tables import JournalTable, SqlTable, Table, check_columns
from trundle.extras import missing_extra

if TYPE_CHECKING:
    import pandas as pd


class Results:
    """The rows of an evaluation, by index: those that its folder held when this was opened.

    Rows that are not of the suite (now) are left out. Without DuckDB it reads the journal, and has no `query` and no
    `to_pandas`.

    Attributes:
        folder: The folder.
        damage: What is damaged: a message for each part and line; `trundle evaluate` runs those episodes again.
    """

    def __init__(self, folder: Path, manifest: Manifest, table: Table, damage: Sequence[str]) -> None:
        self.folder = folder
        self.damage = tuple(damage)
        self._manifest = manifest
        self._opened: Table | None = table

    @classmethod
    def open(cls, folder: str | os.PathLike[str]) -> Self:
        """Read the folder of an evaluation.

        Raises:
            InputError: If it holds none, or cannot be read.
            MissingExtraError: If it has Parquet files, and DuckDB is not installed.
        """
        path = Path(folder)
        check_holds_evaluation(path)
        damage: list[str] = []
        try:
            selection = _read_selection(path)
            uses_sql = has_duckdb() or bool(list_parts(path))
            table = (SqlTable if uses_sql else JournalTable)(path, selection, damage)
        except OSError as error:
            raise InputError(f"cannot read the evaluation in {path}: {error}") from error
        return cls(path, Manifest.load(path), table, damage)

    @property
    def name(self) -> str:
        """Name of the suite."""
        return self._manifest.name

    @property
    def total(self) -> int:
        """Number of episodes of the suite."""
        return self._manifest.total

    @property
    def stopped(self) -> Stopped | None:
        """Why the evaluation has ended without a row for each episode; None while it runs, and where it is done."""
        return self._manifest.stopped

    @property
    def started(self) -> str:
        """When the evaluation was started, as ISO 8601."""
        return self._manifest.started

    @property
    def versions(self) -> Mapping[str, str]:
        """Versions of the code that made the rows, or the last of them."""
        return self._manifest.versions

    @property
    def earlier_versions(self) -> Sequence[Mapping[str, str]]:
        """Versions of other code that made some of the rows (`--mixed`)."""
        return self._manifest.earlier_versions

    @property
    def suite_text(self) -> str:
        """The suite, as YAML.

        Raises:
            InputError: If it cannot be read.
        """
        try:
            return (self.folder / SUITE).read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"cannot read {self.folder / SUITE}: {error}") from error

    @property
    def is_closed(self) -> bool:
        """Whether it is closed, so that its rows cannot be read."""
        return self._opened is None

    @property
    def _table(self) -> Table:
        if self._opened is None:
            raise InputError(
                f"the evaluation in {self.folder} is closed: read its rows inside the with block, or before close()"
            )
        return self._opened

    def __len__(self) -> int:
        return len(self._table)

    def rows(self) -> Iterator[Row]:
        """Yield the rows, one after the other."""
        return (Row.of(values) for values in self._table.rows())

    def columns(self, *names: str) -> dict[str, NDArray[Any]]:
        """Return columns as arrays: numbers as int64 or float64, others as objects; NaN or None where missing.

        Raises:
            InputError: For a name that is no column.
        """
        check_columns(names)
        return self._table.columns(names)

    def find(self, prefix: str) -> Row:
        """Return the row whose id starts so.

        Raises:
            InputError: If there is none, or more than one.
        """
        wanted = prefix.lower()
        found = self._table.find(wanted, 4) if wanted else []
        if not found:
            raise InputError(
                f"{self.folder}: no episode {prefix!r} among its {len(self)}; `trundle evaluate show {self.folder}` "
                "lists them"
            )
        if len(found) > 1:
            some = ", ".join(values["id"] for values in found[:3]) + (", …" if len(found) > 3 else "")
            raise InputError(f"{self.folder}: several episodes start with {prefix!r}: {some}; give more digits")
        return Row.of(found[0])

    def query(self, sql: str) -> pd.DataFrame:
        """Ask in SQL of DuckDB; the table is called `episodes`, and what was varied has columns `vary_<name>`.

        Raises:
            InputError: If DuckDB does not take it.
            MissingExtraError: If DuckDB or pandas is not installed.
        """
        table = self._table
        if not isinstance(table, SqlTable):
            raise missing_extra("asking in SQL", "DuckDB", "evaluate")
        try:
            import pandas as pd  # noqa: F401 (DuckDB makes its frames)
        except ImportError as error:
            raise missing_extra("a table of episodes", "pandas", "evaluate") from error
        import duckdb

        try:
            return table.database.execute(sql).df()
        except duckdb.Error as error:
            raise InputError(f"this query cannot be run: {error}") from error

    def to_pandas(self) -> pd.DataFrame:
        """Return all columns of all rows.

        Raises:
            MissingExtraError: If DuckDB or pandas is not installed.
        """
        return self.query('SELECT * FROM episodes ORDER BY "index"')

    def close(self) -> None:
        """Free what it holds; its rows cannot be read afterwards."""
        if self._opened is not None:
            self._opened.close()
        self._opened = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def _read_selection(folder: Path) -> Keys | None:
    try:
        with (folder / SELECTION).open("rb") as stream:
            selection = np.load(stream, allow_pickle=False)
        if not isinstance(selection, np.ndarray) or selection.ndim != 1 or selection.dtype != np.uint64:
            raise ValueError("it holds no ids")
        return selection
    except FileNotFoundError:
        return None
    except (ValueError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(
            f"{folder / SELECTION}: it is damaged ({error}); continue the evaluation with trundle evaluate to write it "
            "again"
        ) from error
