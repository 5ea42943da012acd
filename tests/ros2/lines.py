"""What a process prints, for tests that wait for it."""

from __future__ import annotations

import contextlib
import json
import queue
import subprocess
import threading
import time
from collections.abc import Callable
from typing import Any

QUICK_S = 120.0
"""Longer than anything waits here, on a loaded machine."""


class Lines:
    """What a process prints, line by line, without blocking for ever."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        self.errors: list[str] = []
        self._lines: queue.Queue[str | None] = queue.Queue()
        for stream, take in ((process.stdout, self._lines.put), (process.stderr, self.errors.append)):
            threading.Thread(target=self._read, args=(stream, take), daemon=True).start()

    def _read(self, stream: Any, take: Callable[[str], object]) -> None:
        with contextlib.suppress(ValueError):  # closed after the test
            for line in stream:
                take(line)
        if stream is self.process.stdout:
            self._lines.put(None)

    def next(self, within_s: float = QUICK_S) -> Any:
        """The next line, which is JSON."""
        try:
            line = self._lines.get(timeout=within_s)
        except queue.Empty:
            line = None
        assert line is not None, f"it said no more:\n{''.join(self.errors)}"
        return json.loads(line)

    def until(self, wanted: Callable[[Any], bool], within_s: float = QUICK_S) -> Any:
        """The first line that is wanted."""
        end = time.monotonic() + within_s
        while not wanted(found := self.next(max(0.1, end - time.monotonic()))):
            assert time.monotonic() < end, f"it said something else for {within_s:g} s, at last {str(found)[:200]}"
        return found

    def rest(self, within_s: float = QUICK_S) -> list[str]:
        """All lines until it ends, which may be this far apart."""
        found: list[str] = []
        while True:
            try:
                line = self._lines.get(timeout=within_s)
            except queue.Empty:
                said = "".join([*found, *self.errors])
                raise AssertionError(f"it said no more for {within_s:g} s, and before that:\n{said}") from None
            if line is None:
                return found
            found.append(line)

    def wait_for_error(self, words: str) -> None:
        """Wait until it complained so."""
        until = time.monotonic() + QUICK_S
        while not any(words in line for line in self.errors):
            assert time.monotonic() < until, f"not said: {words}\n{self.errors}"
            time.sleep(0.02)
