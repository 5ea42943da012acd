"""How rows are encoded: as lines of JSON and as columns in SQL; and `IdSet`, their ids in a few megabytes."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import fields
from functools import cache
from operator import attrgetter
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from trundle.evaluation.row import Row

LONGEST_LINE = 4 << 20
"""The longest line of a row [bytes]: one that goes on is damaged, and must not fill the memory."""

_NUMBER = (int, float)
_LARGEST = 1e18
"""Finite figures are below it, so that they fit into 64 bits as whole numbers, too."""
_BOUNDS = {"index": 1 << 31, "seed": 1 << 64}
_ID = re.compile(r"[0-9a-f]{16}")
_SURROGATE = re.compile(r"[\ud800-\udfff]")
_KINDS: Mapping[str, tuple[str, tuple[type, ...]]] = {
    "str": ("VARCHAR", (str,)),
    "str | None": ("VARCHAR", (str, type(None))),
    "bool | None": ("BOOLEAN", (bool, type(None))),
    "int": ("BIGINT", (int,)),
    "int | None": ("BIGINT", (int, type(None))),
    "float": ("DOUBLE", _NUMBER),
    "float | None": ("DOUBLE", (*_NUMBER, type(None))),
    "tuple[float, ...]": ("DOUBLE[]", (list,)),
    "Mapping[str, float] | None": ("MAP(VARCHAR, DOUBLE)", (dict, type(None))),
}
"""The type in SQL, and the types in JSON, by annotation."""

SQL_TYPES = {**{field.name: _KINDS[str(field.type)][0] for field in fields(Row)}, "seed": "UBIGINT"}
"""The type of each column in SQL and Parquet."""

_JSON_TYPES = {field.name: _KINDS[str(field.type)][1] for field in fields(Row)}
_NEEDED = ("id", "mission", "index", "world", "robot", "planner", "controller", "backend", "seed", "outcome")
_PLAIN = tuple(name for name in Row.columns() if name != "trail")
_values = attrgetter(*_PLAIN)
_encode = json.JSONEncoder(separators=(",", ":")).encode


@cache
def _trail_format(count: int) -> str:
    return ",".join(["%.2f"] * count)


def encode_row(row: Row) -> bytes:
    """Write a row as a line of JSON; its trail is written with two decimals, to which it is rounded."""
    trail = _trail_format(len(row.trail)) % row.trail
    if "n" in trail:  # nan and inf, which JSON's reader knows by other names
        trail = _encode(row.trail)[1:-1]
    return f'{_encode(dict(zip(_PLAIN, _values(row), strict=True)))[:-1]},"trail":[{trail}]}}\n'.encode()


def decode_row(line: bytes) -> dict[str, Any]:
    """Read the values that a line holds, all of which DuckDB can read, too.

    Raises:
        ValueError: If it is not a row; the message says why.
    """
    try:
        values = json.loads(line.decode(), object_pairs_hook=_unique_keys)
    except RecursionError as error:
        raise ValueError("not JSON") from error
    if not isinstance(values, dict):
        raise ValueError("not a JSON object")
    missing = [name for name in _NEEDED if name not in values]
    if missing:
        raise ValueError(f"no {', '.join(missing)}")
    for name, value in values.items():
        kinds = _JSON_TYPES.get(name)
        if kinds is not None and not (type(value) in kinds and _is_in_bounds(name, value)):
            raise ValueError(f"{name} is {value!r:.40}")
    return values


def _unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    values = dict(pairs)
    if len(values) < len(pairs):
        raise ValueError("a key is there twice")
    return values


def _is_in_bounds(name: str, value: Any) -> bool:
    """Return whether a value of the right type is one that a row can have."""
    if name in _BOUNDS:
        return 0 <= value < _BOUNDS[name]
    if name == "id":
        return _ID.fullmatch(value) is not None
    if isinstance(value, str):
        return value.isascii() if name == "mission" else _is_text(value)
    if name == "trail":
        return len(value) % 2 == 0 and all(_is_figure(number) for number in value)
    if isinstance(value, dict):
        return all(_is_text(key) and _is_figure(number) for key, number in cast("dict[str, Any]", value).items())
    return value is None or isinstance(value, bool) or _is_figure(value)


def _is_figure(value: Any) -> bool:
    return type(value) in _NUMBER and (abs(value) < _LARGEST or (type(value) is float and not math.isfinite(value)))


def _is_text(text: str) -> bool:
    """Return whether it has no half of a surrogate pair, which UTF-8 cannot write."""
    return text.isascii() or not _SURROGATE.search(text)


def to_key(identity: str) -> int:
    """Return an id as a number of 64 bits.

    Raises:
        ValueError: If it is not 16 hexadecimal digits.
    """
    if len(identity) != 16:
        raise ValueError(f"the id {identity!r:.40} is not 16 hexadecimal digits")
    return int(identity, 16)


Keys = NDArray[np.uint64]

_RECENT = 1 << 16


class IdSet:
    """A set of ids, kept as numbers of 64 bits.

    Args:
        keys: The ids to start with.
    """

    def __init__(self, keys: Keys) -> None:
        self._sorted: Keys = np.unique(keys)
        self._recent: set[int] = set()

    def add(self, identity: str) -> bool:
        """Add an id.

        Returns:
            Whether it was new.
        """
        key = to_key(identity)
        if key in self._recent or self._is_old(key):
            return False
        self._recent.add(key)
        if len(self._recent) >= _RECENT:
            self._sorted = np.union1d(self._sorted, np.fromiter(self._recent, np.uint64, len(self._recent)))
            self._recent = set()
        return True

    def contains(self, keys: Keys) -> NDArray[np.bool_]:
        """Return which of these are in the set."""
        recent = np.fromiter(self._recent, np.uint64, len(self._recent))
        return np.isin(keys, self._sorted) | np.isin(keys, recent)

    def __contains__(self, identity: str) -> bool:
        key = to_key(identity)
        return key in self._recent or self._is_old(key)

    def __len__(self) -> int:
        return len(self._sorted) + len(self._recent)

    def _is_old(self, key: int) -> bool:
        wanted = np.uint64(key)
        place = int(np.searchsorted(self._sorted, wanted))
        return place < len(self._sorted) and self._sorted[place] == wanted
