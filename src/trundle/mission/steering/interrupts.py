"""`Interrupts`: Ctrl-C while a run is driven, which is handled between two control periods."""

from __future__ import annotations

import _thread
import signal
import threading
import time
from collections.abc import Callable
from types import FrameType
from typing import Self, TypeAlias

PATIENCE_S = 2.0
"""A control period that takes longer after Ctrl-C is interrupted where it is [s], real time."""

_Handler: TypeAlias = Callable[[int, FrameType | None], object]


class Interrupts:
    """Defers the handlers of SIGINT and SIGTERM to `check`; use it in a `with` block.

    A KeyboardInterrupt may be raised anywhere in Python's code: in `Condition.__enter__`, once the lock is taken, it
    leaves the lock held for ever, and in `__del__` or the callback of a weak reference it is dropped. So the program
    would hang, or go on. A handler is not deferred any longer than `PATIENCE_S`, or until the second signal.

    Outside the main thread, which alone gets signals, it does nothing.
    """

    def __init__(self) -> None:
        self._handlers: dict[int, _Handler] = {}
        self._pending: int | None = None

    def __enter__(self) -> Self:
        if threading.current_thread() is threading.main_thread():
            found = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
            self._handlers = {number: handler for number, handler in found.items() if callable(handler)}
            for number in self._handlers:
                signal.signal(number, self._defer)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._handlers.items():
            signal.signal(number, handler)
        self.check()

    def check(self) -> None:
        """Call the handler of the signal that has come, which raises KeyboardInterrupt unless it was replaced."""
        number, self._pending = self._pending, None
        if number is not None:
            self._handlers[number](number, None)

    def _defer(self, number: int, frame: FrameType | None) -> None:
        if self._pending is not None:
            self._pending = None
            self._handlers[number](number, frame)
            return
        self._pending = number
        # Not a `Thread`, which takes locks to start: this may have interrupted whoever holds them.
        _thread.start_new_thread(self._insist, (number,))

    def _insist(self, number: int) -> None:
        time.sleep(PATIENCE_S)
        if self._pending is not None:
            signal.pthread_kill(threading.main_thread().ident or 0, number)
