"""`Steering`: the queue of directives of a run in progress; `TaskWatcher`, which gets what becomes of a goal."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias

from trundle.errors import InputError, TrundleError
from trundle.fault import Fault
from trundle.mission.steering.directives import DIRECTIVES, Directive, Restart
from trundle.navigation import NavigationStatus
from trundle.values import check_count, check_kind

_MOST_RUNS = 10**9

DEAD_MAN_S = 0.3
"""How long a manual command holds [s], real time, unless it is repeated."""

Refused: TypeAlias = Callable[[str], None]
"""Called by the thread that drives the run, with the reason why a directive could not be applied."""

Applied: TypeAlias = Callable[[], None]
"""Called by the thread that drives the run once a directive was applied."""


TaskResult: TypeAlias = Literal["succeeded", "failed", "cancelled", "replaced", "stopped"]
"""How a task ended: "replaced" by another one, "stopped" as the run ended."""


@dataclass(frozen=True, slots=True)
class TaskEnd:
    """How a goal, a path or a behavior that a run was given ended.

    Attributes:
        result: How it ended.
        message: Why; empty where it succeeded.
        time: Simulated time at which it ended [s].
        status: What the agent was doing then.
        error: The planning error behind it, or None.
        fault: The exception that ended the run, and with it this, as "failed"; None where there was none.
    """

    result: TaskResult
    message: str
    time: float
    status: NavigationStatus
    error: TrundleError | None = None
    fault: Fault | None = None


class TaskWatcher(Protocol):
    """Gets what becomes of a task that was given to a run, from the thread that drives it."""

    def begin(self, time: float) -> None:
        """The run has taken it up at this simulated time [s]."""
        ...

    def refuse(self, error: TrundleError) -> None:
        """The run has not taken it up; the goals that it had stay."""
        ...

    def end(self, end: TaskEnd) -> None:
        """Note the end of the run; nothing follows."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class Order:
    """A directive that waits to be applied.

    Attributes:
        directive: The directive.
        by: Who gave it.
        refused: Called where it cannot be applied; none where nobody waits for that.
        given_s: When it was given [s], by `time.monotonic`; none for one of a record, which holds until the next.
        watcher: Gets what becomes of the goal, path or behavior that it gives; none where nobody waits for that.
        applied: Called where it was applied; none where nobody waits for that.
        run: Number of the run that it is for.
    """

    directive: Directive
    by: str = ""
    refused: Refused | None = None
    given_s: float | None = None
    watcher: TaskWatcher | None = None
    applied: Applied | None = None
    run: int = 1

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

    Sessions that are steered by it one after another are numbered from 1, and each takes only the orders of its own
    number. What is put before the first one is for that. What is put after the end of a run, or after a `Restart`, and
    before the next run begins, is refused, unless it waits: it was meant for a run that is over.

    Attributes:
        run: Number of the run in progress, or of the last one where none is; 1 before the first.
    """

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._orders: deque[Order] = deque()
        self._restarting: set[int] = set()
        """Runs for which a `Restart` was given: nothing comes after it."""
        self._has_begun = self._has_ended = False
        self.run = 1

    @property
    def waiting(self) -> int:
        """How many directives wait to be applied."""
        return len(self._orders)

    @property
    def is_restarting(self) -> bool:
        """Whether the run in progress is about to start again: a `Restart` was given."""
        return self.run in self._restarting

    def put(
        self,
        directive: Directive,
        *,
        by: str = "",
        refused: Refused | None = None,
        watcher: TaskWatcher | None = None,
        applied: Applied | None = None,
        run: int | None = None,
        waits: bool = False,
    ) -> None:
        """Give a directive, from any thread.

        Args:
            directive: The directive.
            by: Who gives it, for the record.
            refused: Called with the reason if it cannot be applied, such as a goal where the robot cannot stand; by
                the thread that drives the run, or by this one where the run has ended. The run goes on then as before.
            watcher: Gets what becomes of the goal, path or behavior that the directive gives: by the thread that drives
                the run, or, where that has ended, by the one that refuses it.
            applied: Called once it was applied, by the thread that drives the run.
            run: Number of the run that it is for; None means `run` as it is now. The next one takes it as it begins.
            waits: Whether a run that is about to start again leaves it to the next one, instead of refusing it.

        Raises:
            InputError: If it is no directive, or the number is not 1 or more.
        """
        check_kind(directive, tuple(DIRECTIVES.values()), "a directive", "Pause(), SetGoal((5.0, 3.5)) make one")
        if not isinstance(by, str):
            raise InputError(f"who gives a directive is a text, got {by!r}")
        number = None if run is None else check_count("the number of a run", run, 1, _MOST_RUNS)
        with self._changed:
            if number is None:
                number = self.run + (waits and self.is_restarting)
            order = Order(directive, by, refused, time.monotonic(), watcher, applied, number)
            why = self._why_refused(number)
            if not why:
                self._orders.append(order)
                if isinstance(directive, Restart):
                    self._restarting.add(number)
                self._changed.notify_all()
        if why:
            order.refuse(InputError(why))

    def _why_refused(self, run: int) -> str:
        if run < self.run:
            return f"run {run} has ended"
        if run == self.run and self._has_ended:
            return "the run has ended"
        return "the run is about to start again: wait until it has" if run in self._restarting else ""

    def begin(self) -> int:
        """Begin a run, for the thread that drives it; what waits for an earlier one is refused.

        Returns:
            Its number.
        """
        if self._has_begun:
            self.end(self.run, "another run has begun")
        with self._changed:
            self.run += self._has_begun
            self._has_begun, self._has_ended = True, False
            self._restarting = {run for run in self._restarting if run >= self.run}
            return self.run

    def end(self, run: int, why: str) -> None:
        """End the run of this number, unless another one has begun: its orders are refused for this reason."""
        with self._changed:
            self._has_ended |= run == self.run
            late = [order for order in self._orders if order.run <= run]
            self._orders = deque(order for order in self._orders if order.run > run)
        for order in late:
            order.refuse(InputError(why))

    def take(self, run: int | None = None) -> Order | None:
        """Take the oldest directive that waits for this run, or for any; None without one."""
        with self._changed:
            order = next((order for order in self._orders if run in (None, order.run)), None)
            if order is not None:
                self._orders.remove(order)
            return order

    def refuse_all(self, why: str) -> None:
        """Refuse all directives that wait, for this reason."""
        while (order := self.take()) is not None:
            order.refuse(InputError(why))

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait until there is a directive for the run in progress, or for so long [s]; whether there is one."""
        with self._changed:
            return self._changed.wait_for(lambda: any(order.run == self.run for order in self._orders), timeout_s)
