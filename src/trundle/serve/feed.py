"""`Feed`: what pages are shown, as the server hands it on to each of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from trundle.mission import LiveStatus


@dataclass(frozen=True, slots=True)
class Newest:
    """A message of which only the newest counts.

    Attributes:
        number: Grows with every new one.
        text: The message; "" where there has been none.
    """

    number: int = 0
    text: str = ""

    def next(self, text: str) -> Newest:
        """Return the one that replaces it."""
        return Newest(self.number + 1, text)


class Log(Protocol):
    """Holds what every page gets all of."""

    def read(self, cursor: int) -> tuple[str, int] | None:
        """Return the `log` message for a client whose cursor is here, and its next cursor; None if it has everything.

        Cursors start at 0.
        """
        ...


class Feed(Protocol):
    """One run, or one loop, as the pages get it; its members are read by the server's thread."""

    @property
    def scene(self) -> str:
        """The `scene` message."""
        ...

    @property
    def run(self) -> str | None:
        """The `run` message; None if nothing runs."""
        ...

    @property
    def solids(self) -> Sequence[str]:
        """Messages of what was added to the world; they only become more."""
        ...

    @property
    def log(self) -> Log:
        """What every page gets all of."""
        ...

    @property
    def newest(self) -> tuple[Newest, ...]:
        """Messages of which a page gets the newest alone, those that matter most first; always as many."""
        ...

    @property
    def end(self) -> str | None:
        """The `end` message; None until the run has ended."""
        ...

    @property
    def is_behind(self) -> bool:
        """Whether something happened that is not in the log yet."""
        ...

    def encode(self, status: LiveStatus, *, watched: bool) -> None:
        """Encode what is new, once for all pages; `watched` tells whether there are any."""
        ...
