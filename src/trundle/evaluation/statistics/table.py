"""`Table`: the columns of an evaluation's rows as arrays, small enough for a million of them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.evaluation.row import Row
from trundle.geometry import FloatArray

ARRIVED = "arrived"
LABELS = ("world", "robot", "planner", "controller", "backend", "settings")
"""Columns that name what an episode was run with."""
VARIANT = ("planner", "controller", "backend", "settings")
"""Those of them that are compared on the same missions: a mission fixes world and robot."""

_EXACT = ("time_s", "distance_m", "spl", "min_clearance_m")
_SMALL = ("contacts", "replans", "path_length_m", "max_cross_track_error_m", "smoothness_rad_per_m")
_CLOCKS = ("planning_ms", "cpu_s", "wall_s")
_PLACES = ("start_x", "start_y", "end_x", "end_y", "closest_x", "closest_y")
NUMBERS = (*_EXACT, *_SMALL, *_CLOCKS, *_PLACES)
_NAMED = (*LABELS, "outcome")
_KEYS = {"id": "S16", "mission": "S32", "place": "S32"}

_AT_ONCE = 8192
MOST_FAILED = 10_000
"""Failed rows that are kept whole."""
_MOST_TRAILS = 2_000
_TRAILS_OF_ARRIVED = 60


@dataclass(frozen=True, slots=True)
class Names:
    """A column of few distinct texts.

    Attributes:
        names: The distinct texts, in order of appearance.
        codes: Index into them for each row, shape (N,).
    """

    names: tuple[str, ...]
    codes: npt.NDArray[np.int32]

    def where(self, name: str) -> npt.NDArray[np.bool_]:
        """Which rows have this text."""
        return self.codes == (self.names.index(name) if name in self.names else -1)

    def of(self, row: int) -> str:
        """The text of one row."""
        return self.names[self.codes[row]]


@dataclass(frozen=True, slots=True)
class Table:
    """The rows of an evaluation by column.

    Attributes:
        numbers: Columns of numbers, NaN where a row has none; see `NUMBERS`.
        named: Columns of labels, and `outcome`.
        keys: `id`, `mission` and `place` as bytes.
        index: Number of the episode in its suite.
        seed: Of the mission.
        vary: What was varied, by name; NaN where a row does not have it.
        failed: The first 10,000 rows that did not arrive, the first 2,000 with their trails.
        examples: For each world the first rows that arrived, for their trails.
    """

    numbers: Mapping[str, npt.NDArray[np.floating]]
    named: Mapping[str, Names]
    keys: Mapping[str, npt.NDArray[np.bytes_]]
    index: npt.NDArray[np.int64]
    seed: npt.NDArray[np.uint64]
    vary: Mapping[str, FloatArray]
    failed: tuple[Row, ...]
    examples: Mapping[str, tuple[Row, ...]]

    @classmethod
    def of(cls, rows: Iterable[Row]) -> Table:
        """Read rows once, in any number; those of an unfinished evaluation will do.

        Raises:
            InputError: If a row occurs twice.
        """
        reader = _Reader()
        source = iter(rows)
        while batch := list(islice(source, _AT_ONCE)):
            reader.add(batch)
        table = reader.finish()
        ids = np.sort(table.keys["id"])
        twice = np.flatnonzero(ids[1:] == ids[:-1])
        if len(twice):
            raise InputError(f"episode {bytes(ids[twice[0]]).decode()} occurs twice among the rows")
        return table

    def __len__(self) -> int:
        return len(self.index)

    @property
    def arrived(self) -> npt.NDArray[np.bool_]:
        """Which rows arrived."""
        return self.named["outcome"].where(ARRIVED)

    @property
    def clusters(self) -> npt.NDArray[np.bytes_]:
        """The world of each row, for the bootstrap: its map where it is known, as a label may stand for many worlds."""
        worlds = self.named["world"]
        names = np.array([name.encode()[:32] for name in worlds.names] or [b""], dtype="S32")
        return np.where(self.keys["place"] == b"", names[worlds.codes], self.keys["place"])

    def id_of(self, row: int) -> str:
        """The id of one row."""
        return self.keys["id"][row].decode()

    def labels_of(self, row: int) -> dict[str, str]:
        """The labels of one row."""
        return {name: self.named[name].of(row) for name in LABELS}


class _Reader:
    """Rows into arrays, a batch at a time."""

    def __init__(self) -> None:
        self._chunks: dict[str, list[npt.NDArray]] = {}
        self._names: dict[str, dict[str, int]] = {name: {} for name in _NAMED}
        self._vary: dict[str, list[tuple[int, float]]] = {}
        self._rows = 0
        self._failed: list[Row] = []
        self._examples: dict[str, list[Row]] = {}

    def add(self, batch: Sequence[Row]) -> None:
        for name in NUMBERS:
            kind = np.float64 if name in _EXACT else np.float32
            self._put(name, [_number(getattr(row, name)) for row in batch], kind)
        for name, known in self._names.items():
            self._put(name, [known.setdefault(getattr(row, name), len(known)) for row in batch], np.int32)
        for name, kind in _KEYS.items():
            self._put(name, [(getattr(row, name) or "").encode() for row in batch], kind)
        self._put("index", [row.index for row in batch], np.int64)
        self._put("seed", [row.seed & 0xFFFF_FFFF_FFFF_FFFF for row in batch], np.uint64)
        for row in batch:
            self._keep(row)
            for name, value in (row.vary or {}).items():
                self._vary.setdefault(name, []).append((self._rows, value))
            self._rows += 1

    def _put(self, name: str, values: list, kind: object) -> None:
        self._chunks.setdefault(name, []).append(np.array(values, dtype=kind))  # type: ignore[arg-type]

    def _keep(self, row: Row) -> None:
        if row.outcome != ARRIVED:
            if len(self._failed) < MOST_FAILED:
                self._failed.append(row if len(self._failed) < _MOST_TRAILS else replace(row, trail=()))
            return
        examples = self._examples.setdefault(row.world, [])
        if len(examples) < _TRAILS_OF_ARRIVED and row.trail:
            examples.append(row)

    def _take(self, name: str, kind: object) -> npt.NDArray:
        chunks = self._chunks.pop(name, [])
        return np.concatenate(chunks) if chunks else np.empty(0, dtype=kind)  # type: ignore[call-overload]

    def finish(self) -> Table:
        vary: dict[str, FloatArray] = {}
        for name in sorted(self._vary):
            column = np.full(self._rows, np.nan)
            places, values = zip(*self._vary.pop(name), strict=True)
            column[list(places)] = values
            vary[name] = column
        return Table(
            numbers={name: self._take(name, np.float64) for name in NUMBERS},
            named={name: Names(tuple(self._names[name]), self._take(name, np.int32)) for name in _NAMED},
            keys={name: self._take(name, kind) for name, kind in _KEYS.items()},
            index=self._take("index", np.int64),
            seed=self._take("seed", np.uint64),
            vary=vary,
            failed=tuple(self._failed),
            examples={name: tuple(rows) for name, rows in self._examples.items()},
        )


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


@dataclass(frozen=True, slots=True)
class Group:
    """Rows that share labels.

    Attributes:
        name: The labels that tell the groups apart, for people.
        labels: The labels that all its rows share.
        rows: Their numbers in the table.
    """

    name: str
    labels: Mapping[str, str]
    rows: npt.NDArray[np.intp]


def group_rows(table: Table, columns: Sequence[str] = LABELS) -> list[Group]:
    """Groups of rows with the same labels, in order of appearance of the labels.

    Groups are named after the labels in which they differ; a single one after world and planner.
    """
    if len(table) == 0:
        return []
    codes = np.stack([table.named[name].codes for name in columns], axis=1)
    found, place = np.unique(codes, axis=0, return_inverse=True)
    order = np.argsort(place, kind="stable")
    parts = np.split(order, np.cumsum(np.bincount(place, minlength=len(found)))[:-1])
    differ = [name for name, column in zip(columns, found.T, strict=True) if np.ptp(column) > 0]
    named = differ or [name for name in ("world", "planner") if name in columns] or list(columns[:1])
    groups: list[Group] = []
    for key, rows in zip(found, parts, strict=True):
        labels = {name: table.named[name].names[code] for name, code in zip(columns, key, strict=True)}
        groups.append(Group(name_labels(labels, named), labels, rows))
    return groups


def name_labels(labels: Mapping[str, str], named: Iterable[str]) -> str:
    """Some labels in one line; settings at their default are called so."""
    return " · ".join(labels[name] or "default" for name in named)


def iterate_groups(groups: Sequence[Group], table: Table) -> Iterator[tuple[Group, int, int]]:
    """Each group with how many of its rows arrived, and how many there are."""
    arrived = table.arrived
    for group in groups:
        yield group, int(arrived[group.rows].sum()), len(group.rows)
