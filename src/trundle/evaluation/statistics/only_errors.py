"""Settings of which every episode ended in an exception: they are named first, and compared with nothing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from trundle.evaluation.row import Row
from trundle.evaluation.statistics.table import VARIANT, Group, Table, group_rows

ERROR = "error"


@dataclass(frozen=True, slots=True)
class OnlyErrors:
    """Settings of which every episode so far ended in `error`.

    Attributes:
        name: Of the settings.
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
        """The same as plain values, for JSON."""
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
    """Whether every row of a group ended in `error`."""
    return bool(table.named["outcome"].where(ERROR)[group.rows].all())


def _is_of(row: Row, group: Group) -> bool:
    return all(getattr(row, name) == label for name, label in group.labels.items())


def find_only_errors(table: Table) -> list[OnlyErrors]:
    """The settings of which every episode so far ended in `error`."""
    found: list[OnlyErrors] = []
    for group in group_rows(table, VARIANT):
        if has_only_errors(table, group):
            row = next((row for row in table.failed if _is_of(row, group)), None)
            error, example = ("", "") if row is None else (row.error or row.message, row.id)
            found.append(OnlyErrors(group.name, group.labels, len(group.rows), error, example))
    return found
