"""`Client`: one page that is connected, and what it has not been sent yet."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Iterator

from trundle.serve.feed import Feed

_FRAGMENT = 64 * 1024
"""Characters of a part of a long message; the next part is sent once the socket has room for it."""

_MOST_REPLIES = 64
"""Replies that wait; more than these are sent only by a page that does not read, and the oldest are dropped."""

RATE_PER_S, BURST = 60.0, 120.0
"""How many messages a client may send per second, and at once. A page that drives by hand sends 11 in a second."""


class Client:
    """Knows what one page has got: a cursor in what it must get all of, numbers for what only the newest counts.

    Args:
        number: Number of the client, from 1.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.wake = asyncio.Event()
        self._replies: deque[str] = deque(maxlen=_MOST_REPLIES)
        self._feed: Feed | None = None
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

    def take(self, feed: Feed | None) -> str | None:
        """Return the next message for the page, or None if it has everything."""
        if self._replies:
            return self._replies.popleft()
        if feed is not self._feed:
            self._begin(feed)
        if feed is None:
            return None
        return self._take_first(feed) or self._take_rest(feed)

    def _begin(self, feed: Feed | None) -> None:
        self._feed = feed
        self._opening = deque(() if feed is None else filter(None, (feed.scene, feed.run)))
        self._solids = self._log = 0
        self._seen = [0] * (0 if feed is None else len(feed.newest))
        self._ended = self._log_is_next = False

    def _take_first(self, feed: Feed) -> str | None:
        if self._opening:
            return self._opening.popleft()
        if self._solids < len(feed.solids):
            self._solids += 1
            return feed.solids[self._solids - 1]
        return None

    def _take_rest(self, feed: Feed) -> str | None:
        # The log and the newest take turns, so that neither keeps the other from a slow page.
        self._log_is_next = not self._log_is_next
        if self._log_is_next:
            return self._take_log(feed) or self._take_newest(feed) or self._take_end(feed)
        return self._take_newest(feed) or self._take_log(feed) or self._take_end(feed)

    def _take_log(self, feed: Feed) -> str | None:
        found = feed.log.read(self._log)
        if found is None:
            return None
        text, self._log = found
        return text

    def _take_newest(self, feed: Feed) -> str | None:
        for i, newest in enumerate(feed.newest):
            if self._seen[i] < newest.number:
                self._seen[i] = newest.number
                return newest.text
        return None

    def _take_end(self, feed: Feed) -> str | None:
        if feed.end is None or self._ended or feed.is_behind:
            return None
        self._ended = True
        return feed.end


def fragments(text: str) -> Iterator[str]:
    """Return parts of a long message, each of which is sent when the socket has room for it."""
    return (text[first : first + _FRAGMENT] for first in range(0, len(text), _FRAGMENT))


def is_long(text: str) -> bool:
    """Return whether a message is to be sent in fragments."""
    return len(text) > _FRAGMENT
