"""`Output`: one thing that is published of a run; and what outputs are made with: `Cadence`, `Stencil`."""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray
from trundle.mission import Step
from trundle.observation import Observation


def observed(step: Step) -> Observation:
    """Return what the robot observes at the end of a control period."""
    return step.state.observation if step.observation is None else step.observation


class Output(Protocol):
    """Publishes one thing of a run, where it is wanted."""

    def publish(self, step: Step, time: float) -> None:
        """Publish it for a control period that ends at a time [s] on the network's clock."""
        ...


_SAME_S = 1e-9
"""Times of a run are sums of steps: a period that is short by this is over [s]."""


class Cadence:
    """Says when something is due; where time goes back, it is due at once.

    Args:
        period_s: The period [s].
    """

    def __init__(self, period_s: float) -> None:
        self._period_s = period_s
        self._last_s = -math.inf

    def is_due(self, time: float) -> bool:
        """Return whether a period has passed at a time [s] since the last `mark`, or there was none."""
        return not 0.0 <= time - self._last_s < self._period_s - _SAME_S

    def mark(self, time: float) -> None:
        """Take note that it was published at this time [s]."""
        self._last_s = time


_STAMP = struct.Struct("<iI")
_MARK_STAMP, _FIRST_MARK = (0x3A5C7E11, 0x0BADCAFE), -1.8372e205
"""Values that no message has by chance: `_find` checks that each is there once."""


class Stencil:
    """Writes messages by changing the bytes of one: several times as fast as making and serialising each.

    What changes is found by marks: the message has the stamp of `mark_stamp`, and the numbers of `mark(n, length)`
    where the n-th run of numbers is to be.

    Args:
        data: The CDR bytes of the message with its marks.
        runs: How many numbers each run has.
    """

    def __init__(self, data: bytes, runs: Sequence[int] = ()) -> None:
        self._data = bytearray(data)
        self._stamp_at = _find(data, _STAMP.pack(*_MARK_STAMP))
        self._runs: list[tuple[struct.Struct, int]] = []
        for number, length in enumerate(runs):
            marks = struct.pack(f"<{length}d", *mark(number, length))
            self._runs.append((struct.Struct(f"<{length}d"), _find(data, marks)))

    def fill(self, time: float, *runs: Sequence[float]) -> bytes:
        """Return the bytes for a time [s] and these numbers."""
        data = self._data
        _STAMP.pack_into(data, self._stamp_at, *divmod(round(time * 1e9), 1_000_000_000))
        for (form, at), numbers in zip(self._runs, runs, strict=True):
            form.pack_into(data, at, *numbers)
        return bytes(data)

    def array(self, mark: bytes, kind: npt.DTypeLike, count: int) -> npt.NDArray[Any]:
        """Return the elements that begin with these bytes as an array; what is written to it is in the next message."""
        return np.frombuffer(self._data, kind, count, _find(bytes(self._data), mark))


def mark_stamp(stamp: Any) -> Any:
    """Put the mark of the stamp into a builtin_interfaces/Time, and return it."""
    stamp.sec, stamp.nanosec = _MARK_STAMP
    return stamp


def mark(number: int, length: int) -> FloatArray:
    """Return the marks of a run of numbers."""
    return _FIRST_MARK * (1.0 + number + np.arange(length) / 64.0)


def _find(data: bytes, wanted: bytes) -> int:
    at = data.find(wanted)
    if at < 0 or data.find(wanted, at + 1) >= 0:
        raise ValueError("a mark is not in the message exactly once")
    return at
