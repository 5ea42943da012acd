"""`Warnings`: one warning for each kind of bad input, and how often each kind came."""

from __future__ import annotations

import logging
import threading
from collections import Counter
from collections.abc import Callable

_LOGGER = logging.getLogger("trundle.ros2")


class Warnings:
    """Counts what is dropped, and warns of the first of each kind; any thread may use it.

    Args:
        report: Gets each first warning; none means the log.
    """

    def __init__(self, report: Callable[[str], None] | None = None) -> None:
        self._report = report
        self._lock = threading.Lock()
        self._counts: Counter[str] = Counter()

    @property
    def counts(self) -> dict[str, int]:
        """How often each kind came, those that came first at the front."""
        with self._lock:
            return dict(self._counts)

    def warn(self, kind: str, text: str | Callable[[], str]) -> None:
        """Count one of a kind; the first one is reported.

        Args:
            kind: The kind, such as "cmd_vel: not finite".
            text: What came, and what becomes of it; or what makes that text, for the first one alone.
        """
        with self._lock:
            self._counts[kind] += 1
            if self._counts[kind] > 1:
                return
        text = text if isinstance(text, str) else text()
        self._tell(f"{text}; further ones are counted, and not reported")

    def note(self, text: str) -> None:
        """Report something every time, such as a connection that was lost."""
        self._tell(text)

    def summary(self) -> str:
        """What was counted, in one line; empty where nothing was."""
        return ", ".join(f"{kind} ({count})" for kind, count in self.counts.items())

    def _tell(self, text: str) -> None:
        if self._report is not None:
            self._report(text)
        else:
            _LOGGER.warning("%s", text)
