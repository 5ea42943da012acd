"""`Steering`: the queue of directives of a run in progress, which any thread may put them into."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from trundle.errors import InputError, TrundleError
from trundle.mission.steering.directives import DIRECTIVES, Directive
from trundle.mission.steering.tasks import TaskWatcher
from trundle.values import check_kind

DEAD_MAN_S = 0.3
"""How long a manual command holds [s], real time, unless it is repeated."""

Refused: TypeAlias = Callable[[str], None]
"""Called by the thread that drives the run, with the reason why a directive could not be applied."""

Applied: TypeAlias = Callable[[], None]
"""Called by the thread that drives the run once a directive was applied."""


@dataclass(frozen=True, slots=True)
class Order:
    """A directive that waits to be applied.

    Attributes:
        directive: The directive.
        by: Who gave it.
        refused: Called where it cannot be applied; none where nobody waits for that.
        given_s: When it was given [s], by `time.monotonic`; none for one of a record, which holds until the next.
        watcher: Gets what becomes of the goal, path or behavior that it gives; none where nobody waits for that.
        applied: Called where it was applied; none where nobody waits for that.
    """

    directive: Directive
    by: str = ""
    refused: Refused | None = None
    given_s: float | None = None
    watcher: TaskWatcher | None = None
    applied: Applied | None = None

    def refuse(self, error: TrundleError) -> None:
        """Tell those who wait for it that it is not applied."""
        if self.refused is not None:
            self.refused(str(error))
        if self.watcher is not None:
            self.watcher.refuse(error)


class Steering:
    """Hands directives from any thread to the one that drives a run, which applies them between control periods.

    `put` returns at once. Directives are applied in the order in which they were put; only the thread that drives the
    run touches the simulator and the agent.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._orders: deque[Order] = deque()

    @property
    def waiting(self) -> int:
        """How many directives wait to be applied."""
        return len(self._orders)

    def put(
        self,
        directive: Directive,
        *,
        by: str = "",
        refused: Refused | None = None,
        watcher: TaskWatcher | None = None,
        applied: Applied | None = None,
    ) -> None:
        """Give a directive, from any thread.

        Args:
            directive: The directive.
            by: Who gives it, for the record.
            refused: Called with the reason if it cannot be applied, such as a goal where the robot cannot stand; by
                the thread that drives the run. The run goes on then as before.
            watcher: Gets what becomes of the goal, path or behavior that the directive gives: by the thread that drives
                the run, or, where that has ended, by the one that refuses what waits.
            applied: Called once it was applied, by the thread that drives the run.

        Raises:
            InputError: If it is no directive.
        """
        check_kind(directive, tuple(DIRECTIVES.values()), "a directive", "Pause(), SetGoal((5.0, 3.5)) make one")
        if not isinstance(by, str):
            raise InputError(f"who gives a directive is a text, got {by!r}")
        with self._changed:
            self._orders.append(Order(directive, by, refused, time.monotonic(), watcher, applied))
            self._changed.notify_all()

    def take(self) -> Order | None:
        """Take the oldest directive that waits, or None; for the thread that drives the run."""
        with self._changed:
            return self._orders.popleft() if self._orders else None

    def refuse_all(self, why: str) -> None:
        """Refuse all directives that wait, for this reason."""
        while (order := self.take()) is not None:
            order.refuse(InputError(why))

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait until there is a directive, or for so long [s]; whether there is one."""
        with self._changed:
            return self._changed.wait_for(lambda: bool(self._orders), timeout_s)
