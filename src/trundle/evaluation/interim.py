"""`InterimReports`: writes the reports of an evaluation from time to time while it runs."""

from __future__ import annotations

import os
import subprocess
import time
from collections.abc import Callable

from trundle.evaluation.writer import Writer, start_writer

FIRST_S = 30.0
"""When the first report is started, after the evaluation [s]."""

_REST = 20.0
"""The pause after a report in times that it took, which bounds what reports cost to 5 % of one CPU."""

_END_S = 0.5


class InterimReports:
    """Writes the reports of an evaluation from time to time, in a separate process: results do not wait for it.

    A report that cannot be written is left out; the one at the end says why.

    Args:
        folder: The folder, or the URI of one in an object store.
        start: Starts what writes them.
        clock: Gives the time [s].
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        *,
        start: Callable[[str], Writer] = start_writer,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._folder = os.fspath(folder)
        self._start = start
        self._clock = clock
        self._writer: Writer | None = None
        self._began = 0.0
        self._next = clock() + FIRST_S

    def look(self) -> None:
        """Start a report if it is time for one; call this often."""
        now = self._clock()
        if self._writer is not None:
            if self._writer.poll() is None:
                return
            self._writer = None
            self._next = now + _REST * (now - self._began)
        if now < self._next:
            return
        self._began = now
        try:
            self._writer = self._start(self._folder)
        except OSError:
            self._next = now + FIRST_S

    def close(self) -> None:
        """End the report that is being written."""
        writer, self._writer = self._writer, None
        if writer is None or writer.poll() is not None:
            return
        writer.terminate()
        try:
            writer.wait(_END_S)
        except subprocess.TimeoutExpired:
            writer.kill()
            writer.wait(_END_S)
