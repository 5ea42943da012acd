"""`Client`: one page that is connected, and what it has not been sent yet."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Iterator

from trundle.serve.show import Show

_FRAGMENT = 64 * 1024
_MOST_REPLIES = 64
RATE_PER_S, BURST = 60.0, 120.0
"""How many messages a client may send per second, and at once."""


class Client:
    """What one page has got: a cursor in everything that loses nothing, a number of what only the newest counts.

    Args:
        number: Of the client, from 1.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.wake = asyncio.Event()
        self._replies: deque[str] = deque(maxlen=_MOST_REPLIES)
        self._show: Show | None = None
        self._allowance, self._counted_s = BURST, 0.0
        self._begin(None)

    def reply(self, text: str) -> None:
        """Send this to the page, before anything else."""
        self._replies.append(text)
        self.wake.set()

    def may_send(self, now_s: float) -> bool:
        """Count a message that the page has sent; False where there were too many."""
        if self._counted_s:
            self._allowance = min(BURST, self._allowance + RATE_PER_S * (now_s - self._counted_s))
        self._counted_s = now_s
        self._allowance -= 1.0
        return self._allowance >= 0.0

    def take(self, show: Show | None) -> str | None:
        """The next message for the page; None where it has everything."""
        if self._replies:
            return self._replies.popleft()
        if show is not self._show:
            self._begin(show)
        if show is None:
            return None
        return self._take_first(show) or self._take_rest(show)

    def _begin(self, show: Show | None) -> None:
        self._show = show
        self._opening = deque(() if show is None else filter(None, (show.scene, show.run)))
        self._solids = self._log = self._frame = self._costmap = 0
        self._ended = self._log_is_next = False

    def _take_first(self, show: Show) -> str | None:
        if self._opening:
            return self._opening.popleft()
        if self._solids < len(show.solids):
            self._solids += 1
            return show.solids[self._solids - 1]
        return None

    def _take_rest(self, show: Show) -> str | None:
        # The log and the newest take turns, so that neither keeps the other from a slow page.
        self._log_is_next = not self._log_is_next
        if self._log_is_next:
            return self._take_log(show) or self._take_newest(show) or self._take_end(show)
        return self._take_newest(show) or self._take_log(show) or self._take_end(show)

    def _take_log(self, show: Show) -> str | None:
        found = show.log.read(self._log)
        if found is None:
            return None
        text, self._log = found
        return text

    def _take_newest(self, show: Show) -> str | None:
        if self._frame < show.frame.number:
            self._frame = show.frame.number
            return show.frame.text
        if self._costmap < show.costmap.number:
            self._costmap = show.costmap.number
            return show.costmap.text
        return None

    def _take_end(self, show: Show) -> str | None:
        if show.end is None or self._ended or show.is_behind:
            return None
        self._ended = True
        return show.end


def fragments(text: str) -> Iterator[str]:
    """Parts of a long message, each of which is sent when the socket has room for it."""
    return (text[first : first + _FRAGMENT] for first in range(0, len(text), _FRAGMENT))


def is_long(text: str) -> bool:
    """Whether a message is to be sent in fragments."""
    return len(text) > _FRAGMENT
