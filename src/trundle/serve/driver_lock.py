"""`DriverLock`: only one of the clients drives at a time."""

from __future__ import annotations

from typing import Literal

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
