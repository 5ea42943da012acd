"""`compare`: what changed between two evaluations, on the same missions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from trundle.errors import InputError
from trundle.evaluation.statistics.figures import FIGURES, Figure
from trundle.evaluation.statistics.paired_tests import Mean, bootstrap_means, holm, mcnemar_exact
from trundle.evaluation.statistics.pairing import OnlyErrors, Pairing, find_only_errors, pair_between, pair_within
from trundle.evaluation.statistics.table import Table
from trundle.geometry import FloatArray

CLEAR = 0.05
"""A change is clear where its p, adjusted by Holm for all comparisons made at once, is below this."""
MARGIN = 0.01
"""A mean that is clearly worse by a smaller share of what it was does not count as worse."""
JUDGED = ("success", "spl", "time_s", "distance_m", "contacts")
"""Figures that can make a comparison worse; the others are for information."""


@dataclass(frozen=True, slots=True)
class Change:
    """The change of one figure.

    Attributes:
        figure: Which one.
        first: Its mean with the first setting, over the missions that are compared.
        second: Its mean with the second setting, likewise.
        difference: Mean of second minus first, with its interval.
        p: Probability of such a change by chance: McNemar's exact test for success, the bootstrap for the others.
        adjusted_p: `p` after Holm's correction for all comparisons made at once.
    """

    figure: Figure
    first: float
    second: float
    difference: Mean
    p: float
    adjusted_p: float

    @property
    def clear(self) -> bool:
        """Whether it is statistically clear that the figure changed."""
        return self.adjusted_p < CLEAR

    @property
    def direction(self) -> str:
        """`better`, `worse`, `more` or `less` where the change is clear, otherwise empty."""
        if not self.clear or self.difference.value == 0.0:
            return ""
        grew = "more" if self.difference.value > 0.0 else "less"
        return grew if self.figure.better is None else ("better" if grew == self.figure.better else "worse")

    @property
    def worse(self) -> bool:
        """Whether this makes the comparison worse: clear, of a figure in `JUDGED`, and of means by more than 1 %."""
        if self.direction != "worse" or self.figure.name not in JUDGED:
            return False
        return self.figure.name == "success" or abs(self.difference.value) > MARGIN * abs(self.first)

    def as_dict(self) -> dict[str, Any]:
        """Return the change as plain values, for JSON; None where there is nothing to tell from."""
        difference = self.difference
        return {
            "figure": self.figure.name,
            "a": _known(self.first),
            "b": _known(self.second),
            "difference": _known(difference.value),
            "low": _known(difference.interval.low),
            "high": _known(difference.interval.high),
            "missions": difference.n,
            "p": _known(self.p),
            "adjusted_p": _known(self.adjusted_p),
            "clear": self.clear,
            "worse": self.worse,
        }


@dataclass(frozen=True, slots=True)
class Turned:
    """A mission that only one of the two arrives on.

    Attributes:
        mission: Its hash.
        world: Its world.
        first: Id of the first one's episode.
        second: Id of the second one's.
        outcome: How the one that failed ended.
    """

    mission: str
    world: str
    first: str
    second: str
    outcome: str

    def as_dict(self) -> dict[str, str]:
        """Return the mission as plain values, for JSON."""
        return {
            "mission": self.mission,
            "world": self.world,
            "a": self.first,
            "b": self.second,
            "outcome": self.outcome,
        }


@dataclass(frozen=True, slots=True)
class PairComparison:
    """Two settings on the same missions.

    Attributes:
        first: Name of the first; empty where the two have the same labels.
        second: Name of the second.
        missions: How many missions are compared.
        both: On how many both arrive; times and distances are compared on these alone.
        changes: One for each figure.
        newly_failing: Missions on which only the first arrives.
        newly_passing: Missions on which only the second does.
    """

    first: str
    second: str
    missions: int
    both: int
    changes: tuple[Change, ...]
    newly_failing: tuple[Turned, ...]
    newly_passing: tuple[Turned, ...]

    @property
    def worse(self) -> bool:
        """Whether the second is clearly worse in a figure that counts."""
        return any(change.worse for change in self.changes)

    def change(self, figure: str) -> Change:
        """Return the change of one figure."""
        return next(change for change in self.changes if change.figure.name == figure)

    def as_dict(self) -> dict[str, Any]:
        """Return the comparison as plain values, for JSON."""
        return {
            "a": self.first,
            "b": self.second,
            "missions": self.missions,
            "both_arrive": self.both,
            "worse": self.worse,
            "changes": [change.as_dict() for change in self.changes],
            "newly_failing": [mission.as_dict() for mission in self.newly_failing],
            "newly_passing": [mission.as_dict() for mission in self.newly_passing],
        }


@dataclass(frozen=True, slots=True)
class Comparison:
    """Two evaluations, or the settings of one, on the same missions.

    `worse` is true where, for any pair of settings, one of these is statistically clear (p below 0.05 after Holm's
    correction for all figures of all pairs): success fell, by McNemar's exact test; or the mean SPL fell, or the mean
    time, distance or number of contacts rose, by more than 1 % of what it was, by the paired bootstrap clustered by
    world. Other figures, among them all clock times, never make it worse.

    Attributes:
        first: Name of the first evaluation, as its folder is called.
        second: Name of the second.
        pairs: The settings that are compared.
        only_first: Episodes of the first that have no partner and are left out.
        only_second: Episodes of the second that are left out, likewise.
        by_ends: Whether the missions are the same by the names of their worlds, seeds, starts and goals alone, as the
            content of the worlds or the robots is not.
        only_errors: Settings of the first and of the second of which every episode ended in an exception; they are
            compared with nothing.
    """

    first: str
    second: str
    pairs: tuple[PairComparison, ...]
    only_first: int
    only_second: int
    by_ends: bool = False
    only_errors: tuple[Sequence[OnlyErrors], Sequence[OnlyErrors]] = ((), ())

    @property
    def worse(self) -> bool:
        """Whether the second is clearly worse; see the class."""
        return any(pair.worse for pair in self.pairs)

    @property
    def count(self) -> int:
        """The number of comparisons that Holm's correction is for."""
        return sum(not math.isnan(change.p) for pair in self.pairs for change in pair.changes)

    def as_dict(self) -> dict[str, Any]:
        """Return the comparison as plain values, for JSON."""
        return {
            "a": self.first,
            "b": self.second,
            "worse": self.worse,
            "only_in_a": self.only_first,
            "only_in_b": self.only_second,
            "paired_by": "ends" if self.by_ends else "mission",
            "only_errors_in_a": [each.as_dict() for each in self.only_errors[0]],
            "only_errors_in_b": [each.as_dict() for each in self.only_errors[1]],
            "comparisons": self.count,
            "pairs": [pair.as_dict() for pair in self.pairs],
        }


def compare(first: Table, second: Table, names: tuple[str, str] = ("a", "b")) -> Comparison:
    """Compare two evaluations on the missions that both have.

    Settings with the same labels are compared with each other. Where no labels are the same, what differs between the
    two is what is compared: planner `least_cost` in one with `astar` in the other. Where no mission is the same, as the
    robot was changed, those with the same world's name, seed, start and goal are compared, and the text says so.

    Args:
        first: Rows of the first, which is the reference.
        second: Rows of the second.
        names: What they are called in the text.

    Raises:
        InputError: If no mission is in both, or it is not clear which settings to compare.
    """
    for name, table in zip(names, (first, second), strict=True):
        if len(table) == 0:
            raise InputError(f"{name} has no episode yet; resume it with trundle evaluate")
    only_errors = find_only_errors(first), find_only_errors(second)
    for by_ends in (False, True):
        found = pair_between(first, second, by_ends=by_ends)
        pairings = [pairing for pairing in found if len(pairing.first_rows)]
        if pairings:
            break
    else:
        broken = [f"{name}: {each}" for name, found in zip(names, only_errors, strict=True) for each in found]
        if broken:
            raise InputError("there is nothing to compare: " + "; ".join(broken))
        raise InputError(
            f"no mission of {names[0]} is in {names[1]}, and none has the same name of the world, seed, start and "
            f"goal. {_differences(first, second)}"
        )
    used, others = (
        np.unique(np.concatenate([getattr(pairing, side) for pairing in pairings]))
        for side in ("first_rows", "second_rows")
    )
    pairs = _compare_pairs(first, second, pairings)
    return Comparison(*names, pairs, len(first) - len(used), len(second) - len(others), by_ends, only_errors)


def compare_within(table: Table, name: str = "") -> Comparison | None:
    """Compare the settings of one evaluation with each other; None where there is only one, or no mission in common."""
    pairings = [pairing for pairing in pair_within(table) if len(pairing.first_rows)]
    if not pairings:
        return None
    return Comparison(name, name, _compare_pairs(table, table, pairings), 0, 0)


def _differences(first: Table, second: Table) -> str:
    for label in ("world", "robot"):
        mine, theirs = (set(table.named[label].names) for table in (first, second))
        if not mine & theirs:
            return f"The {label}s are {', '.join(sorted(mine))} and {', '.join(sorted(theirs))}."
    return "Run both with the same worlds, robots and seeds."


def _compare_pairs(first: Table, second: Table, pairings: Sequence[Pairing]) -> tuple[PairComparison, ...]:
    pairs = [_compare_pair(first, second, pairing) for pairing in pairings]
    adjusted = iter(holm([change.p for pair in pairs for change in pair.changes]))
    return tuple(
        replace(pair, changes=tuple(replace(change, adjusted_p=next(adjusted)) for change in pair.changes))
        for pair in pairs
    )


def _compare_pair(first: Table, second: Table, pairing: Pairing) -> PairComparison:
    mine, theirs = pairing.first_rows, pairing.second_rows
    before: list[float] = []
    after: list[float] = []

    def differences() -> Iterator[FloatArray]:
        """A figure at a time: all at once would need much memory for a million episodes."""
        for figure in FIGURES:
            one, other = figure.values(first)[mine], figure.values(second)[theirs]
            if not figure.is_used(one, other):
                one = np.full_like(one, np.nan)
            known = ~(np.isnan(one) | np.isnan(other))
            before.append(float(one[known].mean()) if known.any() else math.nan)
            after.append(float(other[known].mean()) if known.any() else math.nan)
            yield other - one

    means = bootstrap_means(differences(), first.clusters[mine])
    arrived, arrived_after = first.arrived[mine], second.arrived[theirs]
    lost, won = arrived & ~arrived_after, ~arrived & arrived_after
    changes: list[Change] = []
    for figure, mean, one, other in zip(FIGURES, means, before, after, strict=True):
        p = mcnemar_exact(int(lost.sum()), int(won.sum())) if figure.name == "success" else mean.p
        changes.append(Change(figure, one, other, mean, p, p))
    return PairComparison(
        first=pairing.first,
        second=pairing.second,
        missions=len(mine),
        both=int((arrived & arrived_after).sum()),
        changes=tuple(changes),
        newly_failing=tuple(_turned(first, second, pairing, at, lost=True) for at in np.flatnonzero(lost).tolist()),
        newly_passing=tuple(_turned(first, second, pairing, at, lost=False) for at in np.flatnonzero(won).tolist()),
    )


def _turned(first: Table, second: Table, pairing: Pairing, at: int, *, lost: bool) -> Turned:
    row, other = int(pairing.first_rows[at]), int(pairing.second_rows[at])
    return Turned(
        mission=first.keys["mission"][row].decode(),
        world=first.named["world"].of(row),
        first=first.id_of(row),
        second=second.id_of(other),
        outcome=second.named["outcome"].of(other) if lost else first.named["outcome"].of(row),
    )


def _known(value: float) -> float | None:
    return None if math.isnan(value) else value
