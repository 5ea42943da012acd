"""`Table`: the columns of an evaluation's rows as arrays, small enough for a million of them."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import islice
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.evaluation.row import Row
from trundle.geometry import FloatArray

ARRIVED = "arrived"
LABELS = ("world", "robot", "planner", "controller", "backend", "settings")
"""Columns that name what an episode was run with."""
VARIANT = ("planner", "controller", "backend", "settings")
"""The columns that are compared on the same missions: a mission fixes world and robot."""

_EXACT = ("time_s", "distance_m", "spl", "min_clearance_m")
_SMALL = ("contacts", "replans", "max_cross_track_error_m", "smoothness_rad_per_m")
_SCORES = ("barn_score", "shortest_time_s")
_LOCATED = ("position_error_m", "localization_error_m", "localization_error_p95_m", "lost_s")
_SENSING = ("standing_contacts", "unseen_contacts", *_LOCATED, "monitor_stops", "recoveries")
_CLOCKS = ("planning_ms", "cpu_s", "wall_s")
_PLACES = ("end_x", "end_y", "closest_x", "closest_y")
NUMBERS = (*_EXACT, "complete", *_SMALL, *_SENSING, *_SCORES, *_CLOCKS, *_PLACES)
_NAMED = (*LABELS, "agent", "outcome", "handed_over")
_KEYS = {"id": "S16", "mission": "S16"}

_FIGURES = tuple(field.name for field in fields(Row) if field.type == "float | None")
_AT_ONCE = 4096
_BLOCK = 32 * _AT_ONCE
"""Rows of an array that is filled: large ones go back to the system when they are joined."""
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
    codes: npt.NDArray[np.signedinteger]

    def where(self, name: str) -> npt.NDArray[np.bool_]:
        """Return which rows have this text."""
        return self.codes == (self.names.index(name) if name in self.names else -1)

    def of(self, row: int) -> str:
        """Return the text of one row."""
        return self.names[self.codes[row]]


@dataclass(frozen=True, slots=True)
class Table:
    """The rows of an evaluation by column.

    Attributes:
        numbers: Columns of numbers, NaN where a row has none; see `NUMBERS`.
        named: Columns of labels, `agent`, `outcome` and `handed_over`.
        keys: `id` and `mission` as bytes, up to 16 of them.
        clusters: A number for the world of each row, for the bootstrap; see `cluster_of`.
        ends: A number for the world's label, the seed, the start and the goal of each row, whatever the content of
            world and robot; 0 where the start is not known.
        index: Number of the episode in its suite.
        seed: Seed of the mission.
        vary: What was varied, by name; NaN where a row does not have it.
        failed: The first 10,000 rows that did not arrive, the first 2,000 with their trails.
        examples: For each world the first rows that arrived, for their trails.
    """

    numbers: Mapping[str, npt.NDArray[np.floating]]
    named: Mapping[str, Names]
    keys: Mapping[str, npt.NDArray[np.bytes_]]
    clusters: npt.NDArray[np.uint64]
    ends: npt.NDArray[np.uint64]
    index: npt.NDArray[np.int32]
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
        """The rows that arrived, as a mask of shape (N,)."""
        return self.named["outcome"].where(ARRIVED)

    def id_of(self, row: int) -> str:
        """Return the id of one row."""
        return self.keys["id"][row].decode()

    def labels_of(self, row: int) -> dict[str, str]:
        """Return the labels of one row."""
        return {name: self.named[name].of(row) for name in LABELS}


def cluster_of(row: Row) -> int:
    """Return 64 bits for a row's world: of its map where it is known, as one label may stand for many worlds."""
    return _hash(f"place {row.place}" if row.place else f"world {row.world}")


def _ends_of(row: Row) -> int:
    if row.start_x is None:
        return 0
    goal = row.goal_x, row.goal_y, row.goal_yaw
    return _hash(repr((row.world, row.seed, row.start_x, row.start_y, row.start_yaw, *goal)))


def _hash(text: str) -> int:
    return int.from_bytes(hashlib.blake2b(text.encode(), digest_size=8).digest(), "little")


class _Reader:
    """Rows into arrays, a batch at a time."""

    def __init__(self) -> None:
        self._blocks: dict[str, list[npt.NDArray]] = {}
        self._names: dict[str, dict[str, int]] = {name: {} for name in _NAMED}
        self._vary: dict[str, list[tuple[int, FloatArray]]] = {}
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
        self._put("index", [row.index for row in batch], np.int32)
        self._put("seed", [row.seed & 0xFFFF_FFFF_FFFF_FFFF for row in batch], np.uint64)
        self._put("ends", [_ends_of(row) for row in batch], np.uint64)
        self._put("cluster", [cluster_of(row) for row in batch], np.uint64)
        for name in sorted({name for row in batch for name in row.vary or ()}):
            values = np.array([_number((row.vary or {}).get(name)) for row in batch], dtype=float)
            self._vary.setdefault(name, []).append((self._rows, values))
        self._rows += len(batch)
        for row in batch:
            self._keep(row)

    def _put(self, name: str, values: list, kind: Any) -> None:
        """Add a batch to a column; only the last batch may be shorter than the others."""
        blocks = self._blocks.setdefault(name, [])
        at = self._rows % _BLOCK
        if at == 0:
            blocks.append(np.empty(_BLOCK, dtype=kind))
        blocks[-1][at : at + len(values)] = values

    def _keep(self, row: Row) -> None:
        if row.outcome != ARRIVED:
            if len(self._failed) < MOST_FAILED:
                row = _drawable(row)
                self._failed.append(row if len(self._failed) < _MOST_TRAILS else replace(row, trail=()))
            return
        examples = self._examples.setdefault(row.world, [])
        if len(examples) < _TRAILS_OF_ARRIVED and (drawable := _drawable(row)).trail:
            examples.append(drawable)

    def _take(self, name: str, kind: Any) -> npt.NDArray:
        """Return a whole column, and give its blocks back."""
        blocks = self._blocks.pop(name, [])
        whole = np.empty(self._rows, dtype=blocks[0].dtype if blocks else kind)
        for number in range(len(blocks)):
            first = number * _BLOCK
            whole[first : first + _BLOCK] = blocks[number][: self._rows - first]
            blocks[number] = blocks[number][:0].copy()
        return whole

    def _take_names(self, name: str) -> Names:
        names = tuple(self._names[name])
        return Names(names, self._take(name, np.int32).astype(np.int16 if len(names) < 2**15 else np.int32))

    def finish(self) -> Table:
        vary: dict[str, FloatArray] = {}
        for name in sorted(self._vary):
            column = np.full(self._rows, np.nan)
            for first, values in self._vary.pop(name):
                column[first : first + len(values)] = values
            if not np.isnan(column).all():
                vary[name] = column
        return Table(
            numbers={name: self._take(name, np.float64) for name in NUMBERS},
            named={name: self._take_names(name) for name in _NAMED},
            keys={name: self._take(name, kind) for name, kind in _KEYS.items()},
            clusters=self._take("cluster", np.uint64),
            ends=self._take("ends", np.uint64),
            index=self._take("index", np.int32),
            seed=self._take("seed", np.uint64),
            vary=vary,
            failed=tuple(self._failed),
            examples={name: tuple(rows) for name, rows in self._examples.items()},
        )


def _number(value: float | None) -> float:
    """Return a figure; NaN where it is not known or not finite."""
    return value if value is not None and math.isfinite(value) else math.nan


def _drawable(row: Row) -> Row:
    """Return the row without figures and a trail that are not finite, which no drawing can hold."""
    values = ((name, getattr(row, name)) for name in _FIGURES)
    broken = {name: None for name, value in values if value is not None and not math.isfinite(value)}
    trail = row.trail if all(map(math.isfinite, row.trail)) else ()
    return replace(row, trail=trail, **broken) if broken or len(trail) < len(row.trail) else row


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
    """Group the rows with the same labels, in order of appearance of the labels.

    Groups are named after the labels in which they differ; a single one after world and planner.
    """
    if len(table) == 0:
        return []
    counts = [len(table.named[name].names) for name in columns]
    key = np.zeros(len(table), dtype=np.int64)
    for name, count in zip(columns, counts, strict=True):
        key *= count
        key += table.named[name].codes
    order = np.argsort(key, kind="stable")
    starts = np.flatnonzero(np.diff(key[order], prepend=-1))
    parts = np.split(order, starts[1:])
    found = np.stack(np.unravel_index(key[order[starts]], counts), axis=1)
    differ = [name for name, column in zip(columns, found.T, strict=True) if np.ptp(column) > 0]
    named = differ or [name for name in ("world", "planner") if name in columns] or list(columns[:1])
    groups: list[Group] = []
    for key, rows in zip(found, parts, strict=True):
        labels = {name: table.named[name].names[code] for name, code in zip(columns, key, strict=True)}
        groups.append(Group(name_labels(labels, named), labels, rows))
    return groups


def name_labels(labels: Mapping[str, str], named: Iterable[str]) -> str:
    """Return some labels in one line; settings at their default are called so."""
    return " · ".join(labels[name] or "default" for name in named)


def iterate_groups(groups: Sequence[Group], table: Table) -> Iterator[tuple[Group, int, int]]:
    """Yield each group with how many of its rows arrived, and how many there are."""
    arrived = table.arrived
    for group in groups:
        yield group, int(arrived[group.rows].sum()), len(group.rows)
