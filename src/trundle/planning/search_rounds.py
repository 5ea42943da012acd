"""Searches of poses for one query, in rounds of rising effort, until one of them finds a path or none can."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from trundle.path import Path
from trundle.planning.cancellation import Patience
from trundle.planning.enclosure import BOXES_AN_EXPANSION, Enclosure, find_enclosure
from trundle.planning.queries.query import Query

FOUND, UNREACHABLE, TIMEOUT, CANCELLED, SPENT, CLOSED_OFF, GOAL_CLOSED, START_CLOSED = range(8)
"""How a search ends, by the numbers of the kernel."""

ALL_TRIED = (UNREACHABLE, GOAL_CLOSED, START_CLOSED)


class Answer(NamedTuple):
    """The result of a search.

    Attributes:
        status: The kernel's.
        path: The path, if there is one; maybe a partial one.
        expansions: How many nodes were expanded.
        enclosure: Why no search can find a path, where that is known.
    """

    status: int
    path: Path | None
    expansions: int
    enclosure: Enclosure | None = None


class PoseSearch(Protocol):
    """A search of poses, which can be repeated in smaller cells and by shorter motions."""

    @property
    def max_expansions(self) -> int:
        """How many nodes one search expands at most."""
        ...

    def search(self, query: Query, patience: Patience) -> Answer:
        """Search in cells of the usual size."""
        ...

    def search_finely(self, query: Query, patience: Patience, most: int) -> Answer:
        """Search in smaller cells, with so many expansions at most."""
        ...


@dataclass(frozen=True, slots=True)
class _Round:
    """The effort of one round.

    Attributes:
        boxes: Boxes that one flood fills at most, to see whether an end is enclosed.
        expansions: Nodes that one search expands at most.
    """

    boxes: int
    expansions: int


_ROUNDS = (_Round(20_000, 20_000), _Round(500_000, 100_000))
"""The rounds of finer searches. In an office, a search with turns in place used up the planning deadline where the one
without them finds a path in 50 ms: so each gets 20,000 expansions before one of them gets 100,000."""


def search_in_rounds(searches: Sequence[PoseSearch], query: Query, patience: Patience) -> tuple[int, Answer]:
    """Run each search in turn, then finer ones in rounds of rising effort.

    A finer search that finds nothing takes long, while another search may find a path soon. So in each round every
    search has its turn before one of them goes on. A search whose first run is spent has no finer one. Where an end is
    enclosed, no search can find a path.

    Args:
        searches: One or more, with the preferred one first.
        query: The ends.
        patience: When to stop.

    Returns:
        Which search has the last word, and its answer.

    Raises:
        PlanningStoppedError: If patience ends.
    """
    answers: list[Answer] = []
    for search in searches:
        answers.append(search.search(query, patience))
        if _is_final(answers[-1]):
            return len(answers) - 1, answers[-1]
    most = BOXES_AN_EXPANSION * max(search.max_expansions for search in searches)
    open_ = [index for index, answer in enumerate(answers) if answer.status in ALL_TRIED]
    may_be_enclosed = len(open_) > 0
    for round_ in _ROUNDS:
        enclosure = find_enclosure(query, patience, min(most, round_.boxes)) if may_be_enclosed else None
        if enclosure is not None:
            return len(answers) - 1, answers[-1]._replace(enclosure=enclosure)
        for index in open_.copy():
            before, search = answers[index], searches[index]
            closer = search.search_finely(query, patience, min(round_.expansions, search.max_expansions))
            total = before.expansions + closer.expansions
            answers[index] = closer._replace(path=closer.path or before.path, expansions=total)
            if _is_final(closer):
                return index, answers[index]
            if closer.status in ALL_TRIED or search.max_expansions <= round_.expansions:
                open_.remove(index)
    return len(answers) - 1, answers[-1]


def _is_final(answer: Answer) -> bool:
    return answer.status in (FOUND, CLOSED_OFF)
