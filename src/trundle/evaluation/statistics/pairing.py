"""Which rows are of the same mission, so that they are compared; and settings that only raised, which are not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.evaluation.row import Row
from trundle.evaluation.statistics.table import VARIANT, Group, Table, group_rows, name_labels
from trundle.values import first_names

ERROR = "error"


@dataclass(frozen=True, slots=True)
class OnlyErrors:
    """Settings of which every episode so far ended in `error`.

    Attributes:
        name: Name of the settings.
        labels: Their planner, controller, backend and other settings.
        episodes: How many there are.
        error: The exception of the first one, with its place in the code.
        example: Its id.
    """

    name: str
    labels: Mapping[str, str]
    episodes: int
    error: str
    example: str

    def as_dict(self) -> dict[str, Any]:
        """Return the same as plain values, for JSON."""
        return {
            "labels": dict(self.labels),
            "episodes": self.episodes,
            "error": self.error,
            "example": self.example,
        }

    def __str__(self) -> str:
        count = "its only episode" if self.episodes == 1 else f"all its {self.episodes:,} episodes"
        return f"{self.name}: {count} ended in an error: {self.error}"


def has_only_errors(table: Table, group: Group) -> bool:
    """Return whether every row of a group ended in `error`."""
    return bool(table.named["outcome"].where(ERROR)[group.rows].all())


def _is_of(row: Row, group: Group) -> bool:
    return all(getattr(row, name) == label for name, label in group.labels.items())


def find_only_errors(table: Table) -> list[OnlyErrors]:
    """Find the settings of which every episode so far ended in `error`."""
    found: list[OnlyErrors] = []
    for group in group_rows(table, VARIANT):
        if has_only_errors(table, group):
            row = next((row for row in table.failed if _is_of(row, group)), None)
            error, example = ("", "") if row is None else (row.error or row.message, row.id)
            found.append(OnlyErrors(group.name, group.labels, len(group.rows), error, example))
    return found


Rows = npt.NDArray[np.intp]
_ALL_PAIRS = 3
"""With more settings, each is compared with the first one."""


@dataclass(frozen=True, slots=True)
class Pairing:
    """Rows of the same missions.

    Attributes:
        first: Name of the first setting.
        second: Name of the second.
        first_rows: Rows of the first one's table, shape (N,).
        second_rows: The rows of the same missions in the second one's table, shape (N,).
    """

    first: str
    second: str
    first_rows: Rows
    second_rows: Rows


def pair_within(table: Table) -> list[Pairing]:
    """Pair the settings of one evaluation: all of up to three, of more each with the first."""
    groups = _usable_groups(table)
    few = len(groups) <= _ALL_PAIRS
    pairs = combinations(groups, 2) if few else ((groups[0], other) for other in groups[1:])
    return [_pair(table, one, table, other, (one.name, other.name)) for one, other in pairs]


def pair_between(first: Table, second: Table, *, by_ends: bool = False) -> list[Pairing]:
    """Pair the settings of two evaluations: of the same labels, or else the same agent, or that differ in one respect.

    Args:
        first: Rows of the first.
        second: Rows of the second.
        by_ends: Whether missions are the same by their ends and the names of their worlds alone, whatever the content
            of world and robot.

    Raises:
        InputError: If it is not clear which settings to compare.
    """
    ones, others = _usable_groups(first), _usable_groups(second)
    matches = _match(ones, others, VARIANT)
    matches = matches or _match_agents(first, ones, second, others)
    if not matches:
        kept = [name for name in VARIANT if _values(ones, name) == _values(others, name)]
        matches = _match(ones, others, kept)
    differ = [name for name in VARIANT if any(one.labels[name] != other.labels[name] for one, other in matches)]
    several = len(matches) > 1
    named = [name for name in VARIANT if len(_values(ones, name)) > 1] if several else []
    columns = list(dict.fromkeys([*named, *differ]))
    pairings: list[Pairing] = []
    for one, other in matches:
        names = name_labels(one.labels, columns), name_labels(other.labels, columns)
        pairings.append(_pair(first, one, second, other, names, by_ends=by_ends))
    return pairings


def _usable_groups(table: Table) -> list[Group]:
    """Return the settings without those that only raised exceptions: how good they are is not known."""
    return [group for group in group_rows(table, VARIANT) if not has_only_errors(table, group)]


def _match(ones: Sequence[Group], others: Sequence[Group], columns: Sequence[str]) -> list[tuple[Group, Group]]:
    """Return the pairs of groups that agree in these labels."""
    found = [
        (one, other)
        for one in ones
        for other in others
        if all(one.labels[name] == other.labels[name] for name in columns)
    ]
    for side in (0, 1):
        seen: set[str] = set()
        for pair in found:
            name = name_labels(pair[side].labels, VARIANT)
            if name in seen:
                raise InputError(
                    f"it is not clear what to compare: {_list(ones)} in the first evaluation, {_list(others)} in the "
                    "second; run both with the same settings, or cross them in one suite"
                )
            seen.add(name)
    return found


def _match_agents(
    first: Table, ones: Sequence[Group], second: Table, others: Sequence[Group]
) -> list[tuple[Group, Group]]:
    """Return the pairs of one agent, with and without the names of its planner and controller; none if not clear."""

    def by_agent(table: Table, groups: Sequence[Group]) -> dict[tuple[str, str, str], Group]:
        agents = table.named["agent"]
        found = {
            (agents.of(int(group.rows[0])), group.labels["backend"], group.labels["settings"]): group
            for group in groups
        }
        return found if len(found) == len(groups) else {}

    mine, theirs = by_agent(first, ones), by_agent(second, others)
    return [(group, theirs[key]) for key, group in mine.items() if key in theirs]


def _list(groups: Sequence[Group]) -> str:
    return first_names([group.name for group in groups], 4)


def _values(groups: Sequence[Group], name: str) -> set[str]:
    return {group.labels[name] for group in groups}


def _pair(
    first: Table, one: Group, second: Table, other: Group, names: tuple[str, str], *, by_ends: bool = False
) -> Pairing:
    mine, my_rows = _missions(first, one.rows, by_ends=by_ends)
    theirs, their_rows = _missions(second, other.rows, by_ends=by_ends)
    _, at, their_at = np.intersect1d(mine, theirs, assume_unique=True, return_indices=True)
    order = np.argsort(first.index[my_rows[at]], kind="stable")
    return Pairing(*names, my_rows[at][order], their_rows[their_at][order])


def _missions(table: Table, rows: Rows, *, by_ends: bool) -> tuple[npt.NDArray[Any], Rows]:
    """Return the missions of these rows, each once, and the first row of each; a row that has none is left out."""
    keys = table.ends[rows] if by_ends else table.keys["mission"][rows]
    known = keys != (np.uint64(0) if by_ends else b"")
    missions, first = np.unique(keys[known], return_index=True)
    return missions, rows[known][first]
