"""When a search has to stop: a deadline, and a flag that another thread may set."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError


class Cancellation:
    """Stops a search from another thread: hand it to the search, and call `cancel`."""

    def __init__(self) -> None:
        self.flag: npt.NDArray[np.uint8] = np.zeros(1, dtype=np.uint8)

    def cancel(self) -> None:
        """Stop every search that this was handed to, now and in future."""
        self.flag[0] = 1

    @property
    def cancelled(self) -> bool:
        """Whether `cancel` was called."""
        return bool(self.flag[0])


def check_limits(deadline_s: float | None, cancel: Cancellation | None) -> npt.NDArray[np.uint8] | None:
    """The flag of a cancellation, for the kernels, if there is one.

    Raises:
        InputError: If the deadline is no positive number of seconds, or `cancel` is no `Cancellation`.
    """
    if deadline_s is not None and not (isinstance(deadline_s, (int, float)) and deadline_s > 0.0):
        raise InputError(f"deadline_s must be a positive number of seconds, got {deadline_s!r}")
    if cancel is None:
        return None
    if not isinstance(cancel, Cancellation):
        raise InputError(f"cancel must be a Cancellation, got {type(cancel).__name__}")
    return cancel.flag
