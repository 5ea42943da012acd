"""`ScanMail` delays the scans of a run; `report_latency` says to agents and monitors how late all is."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from trundle.control.latency import Latency
from trundle.observation import Scan


class ScanMail:
    """Holds scans back until they are of a certain age.

    Args:
        age_s: That age [s].
    """

    def __init__(self, age_s: float) -> None:
        self._age_s = age_s
        self._waiting: deque[Scan] = deque()

    def deliver(self, time: float, scans: Sequence[Scan]) -> tuple[Scan, ...]:
        """Take scans that were measured, and return those that arrive by now [s]."""
        self._waiting.extend(scans)
        arrived: list[Scan] = []
        while self._waiting and self._waiting[0].time + self._age_s <= time + 1e-9:
            arrived.append(self._waiting.popleft())
        return tuple(arrived)


def report_latency(one: object, latency: Latency) -> None:
    """Tell an agent or a monitor that can take it into account how late scans and commands arrive."""
    report_latency = getattr(one, "set_latency", None)
    if callable(report_latency):
        report_latency(latency)
