"""`Hub`: knows who is connected, passes on what pages ask for, and by its `DriverLock` lets one of them drive."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Literal, Protocol

from trundle.errors import InputError
from trundle.mission import LiveStatus
from trundle.serve.choosing import Choices
from trundle.serve.feed import Feed
from trundle.serve.page_messages import Drive, Message, Ping, encode_message, parse_message

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


ANSWER_S = 30.0
"""A request that the driver has not answered for this long [s] is granted, because the driver has left the page."""


class DriverLock:
    """Lets one client drive; the others watch, and may ask to take over.

    The first client drives. Where nobody drives, because the driver has left, the next one that asks does.

    Attributes:
        driver: The client that drives, or None.
        request: The client that asks to drive, or None.
    """

    def __init__(self) -> None:
        self.driver: int | None = None
        self.request: int | None = None
        self._clients: list[int] = []
        self._asked_s = 0.0

    def __len__(self) -> int:
        return len(self._clients)

    def join(self, client: int) -> None:
        """Add a client that has connected; it drives if it is alone."""
        self._clients.append(client)
        if len(self._clients) == 1:
            self.driver = client

    def leave(self, client: int) -> bool:
        """Remove a client that has gone; the one that asked to take over drives then.

        Returns:
            Whether the client was the driver.
        """
        self._clients.remove(client)
        if self.request == client:
            self.request = None
        if self.driver != client:
            return False
        self.driver, self.request = self.request, None
        return True

    def ask(self, client: int, now_s: float) -> bool:
        """Let a client ask to drive; the first one that asks is answered first.

        Returns:
            Whether something changed.
        """
        if client == self.driver:
            return False
        if self.driver is None:
            self.driver = client
            return True
        if self.request is not None:
            return False
        self.request, self._asked_s = client, now_s
        return True

    def answer(self, client: int, answer: Literal["grant", "refuse"]) -> bool:
        """Let the driver answer the request; return whether there was one to answer."""
        if client != self.driver or self.request is None:
            return False
        if answer == "grant":
            self.driver = self.request
        self.request = None
        return True

    def expire(self, now_s: float) -> bool:
        """Grant a request that was not answered for `ANSWER_S`; return whether one was granted."""
        if self.request is None or now_s - self._asked_s < ANSWER_S:
            return False
        self.driver, self.request = self.request, None
        return True


MAX_CLIENTS = 64
"""Each client costs its socket and what waits to be sent; everything else is encoded once for all."""

_MOST_MISTAKES = 20
"""A client that has sent so many messages that cannot be read is disconnected."""


class Controls(Protocol):
    """Carries out what the driver asks for. It is called in the server's thread, and must not block."""

    @property
    def status(self) -> LiveStatus:
        """State of what runs now."""
        ...

    def handle(self, message: Message, client: int, refuse: Callable[[str], None]) -> None:
        """Carry out a request of the driver; `refuse` tells its page, from any thread, why it cannot be done."""
        ...

    def let_go(self, client: int) -> None:
        """Stop what the driver drives by hand, because it has gone or handed over."""
        ...


class TooManyMessagesError(InputError):
    """Raised for a client that sends too much, or what cannot be read; it is to be disconnected."""


class Hub:
    """Stands between one run and many pages.

    `present` and `announce` may be called by any thread; the rest is the server's.

    Args:
        choices: What a page can choose from.
        source: What the server was started with, for the page; None if it was started with nothing.

    Attributes:
        choices: What a page can choose from.
        controls: What carries out what pages ask for; to be set before the server starts.
        lacks: What pages cannot do here, so that they do not offer it: "restart", "box", "speed", "find".
        folders: Folders of runs by number, whose files are served.
        feed: What is shown now.
        joined: How many clients there have been.
    """

    def __init__(self, *, choices: Choices, source: str | None = None) -> None:
        self.controls: Controls | None = None
        self.lacks: tuple[str, ...] = ()
        self.folders: dict[int, Path] = {}
        self.feed: Feed | None = None
        self.joined = 0
        self.left_s = time.monotonic()
        self.choices = choices
        self._source = source
        self._clients: dict[int, Client] = {}
        self._mistakes: dict[int, int] = {}
        self._lock = DriverLock()
        self._announced: deque[tuple[int | None, str]] = deque(maxlen=256)

    def __len__(self) -> int:
        """Return how many clients are connected."""
        return len(self._clients)

    # Any thread -----------------------------------------------------------------------------------------------------

    def present(self, feed: Feed) -> None:
        """Show this from now on; a client gets all of it."""
        self.feed = feed

    def announce(self, text: str, *, to: int | None = None) -> None:
        """Send an error in words to one client, or to all."""
        self._announced.append((to, encode_message("error", text=text)))

    # The server's thread --------------------------------------------------------------------------------------------

    @property
    def is_full(self) -> bool:
        """Whether no more clients are accepted."""
        return len(self._clients) >= MAX_CLIENTS

    def connect(self) -> Client:
        """Add a page that has connected."""
        self.joined += 1
        client = Client(self.joined)
        self._clients[client.number] = client
        self._mistakes[client.number] = 0
        self._lock.join(client.number)
        client.reply(self._hello(client))
        self._tell_drivers()
        return client

    def disconnect(self, client: Client) -> None:
        """Remove a page that has gone."""
        del self._clients[client.number], self._mistakes[client.number]
        self.left_s = time.monotonic()
        if self._lock.leave(client.number):
            self._controls.let_go(client.number)
        self._tell_drivers()

    def receive(self, client: Client, data: str | bytes) -> None:
        """Handle a message of a page.

        Raises:
            TooManyMessagesError: If there are too many, or too many that cannot be read.
        """
        if not client.may_send(time.monotonic()):
            raise TooManyMessagesError("too many messages")
        try:
            if not isinstance(data, str):
                raise InputError("message refused: send text")
            message = parse_message(data)
        except InputError as error:
            self._mistakes[client.number] += 1
            if self._mistakes[client.number] >= _MOST_MISTAKES:
                raise TooManyMessagesError("too many messages that cannot be read") from error
            client.reply(encode_message("error", text=str(error)))
            return
        self._take(client, message)

    def tick(self) -> None:
        """Encode what is new, once for all clients, and wake those that wait for it."""
        while self._announced:
            to, text = self._announced.popleft()
            for client in self._clients.values():
                if to is None or client.number == to:
                    client.reply(text)
        before = self._lock.driver
        if self._lock.expire(time.monotonic()):
            self._hand_over(before)
        if self.feed is not None:
            self.feed.encode(self._controls.status, watched=bool(self._clients))
        for client in self._clients.values():
            client.wake.set()

    @property
    def _controls(self) -> Controls:
        if self.controls is None:
            raise InputError("a hub needs its controls before a page connects")
        return self.controls

    def _take(self, client: Client, message: Message) -> None:
        if isinstance(message, Ping):
            client.reply(encode_message("pong", echo=message.echo))
        elif isinstance(message, Drive):
            self._steer(client, message)
        elif client.number != self._lock.driver:
            client.reply(encode_message("error", text="another page drives: ask to take over first"))
        else:
            self._controls.handle(message, client.number, lambda why: self.announce(why, to=client.number))

    def _steer(self, client: Client, message: Drive) -> None:
        before = self._lock.driver
        if message.answer is None:
            changed = self._lock.ask(client.number, time.monotonic())
        else:
            changed = self._lock.answer(client.number, message.answer)
        if changed:
            self._hand_over(before)

    def _hand_over(self, before: int | None) -> None:
        if before is not None and before != self._lock.driver:
            self._controls.let_go(before)
        self._tell_drivers()

    def _tell_drivers(self) -> None:
        lock = self._lock
        text = encode_message("drivers", driver=lock.driver, request=lock.request, clients=len(lock))
        for client in self._clients.values():
            client.reply(text)

    def _hello(self, client: Client) -> str:
        return encode_message(
            "hello",
            client=client.number,
            driver=self._lock.driver,
            clients=len(self._lock),
            you_drive=self._lock.driver == client.number,
            choices=self.choices.as_dict(),
            state=self._controls.status.state,
            source=self._source,
            lacks=list(self.lacks),
        )
