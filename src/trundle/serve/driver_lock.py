"""`DriverLock`: which one of the clients drives."""

from __future__ import annotations

from typing import Literal

ANSWER_S = 30.0
"""A driver that has not answered a request for this long has left the page: it is granted."""


class DriverLock:
    """One client drives, the others watch and may ask to take over.

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
        """A client has connected; it drives if it is alone."""
        self._clients.append(client)
        if len(self._clients) == 1:
            self.driver = client

    def leave(self, client: int) -> bool:
        """A client has gone; whether it was the driver. Who asked to take over drives then."""
        self._clients.remove(client)
        if self.request == client:
            self.request = None
        if self.driver != client:
            return False
        self.driver, self.request = self.request, None
        return True

    def ask(self, client: int, now_s: float) -> bool:
        """A client asks to drive; whether something changed. The first that asks is answered first."""
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
        """The driver answers the request; whether there was one to answer."""
        if client != self.driver or self.request is None:
            return False
        if answer == "grant":
            self.driver = self.request
        self.request = None
        return True

    def expire(self, now_s: float) -> bool:
        """Grant a request that was not answered for `ANSWER_S`; whether one was."""
        if self.request is None or now_s - self._asked_s < ANSWER_S:
            return False
        self.driver, self.request = self.request, None
        return True
