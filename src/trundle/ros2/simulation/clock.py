"""`SimulationClock`: the time on the network, which goes on over restarts of a run."""

from __future__ import annotations

JUMP_S = 1.0
"""After a restart the clock goes on at the next full multiple of this [s], so that the time never goes back."""


class SimulationClock:
    """Time [s] on the network: that of the run, plus that of the runs before.

    The thread that drives the run sets it; any thread reads it.

    Attributes:
        now: The time now [s].
        offset: What is added to the time of the present run [s].
    """

    def __init__(self) -> None:
        self.now = 0.0
        self.offset = 0.0
        self._begun = False
        self._from_zero = False

    def begin(self) -> None:
        """Begin a run: the first one at 0; the next ones at the next full `JUMP_S`, or at 0 after `start_over`."""
        if self._from_zero or not self._begun:
            self.offset = 0.0
        else:
            self.offset = (self.now // JUMP_S + 1.0) * JUMP_S
        self._begun, self._from_zero = True, False
        self.now = self.offset

    def start_over(self) -> None:
        """Let the next run begin at 0, as one asks for who resets the time."""
        self._from_zero = True

    def set(self, time: float) -> float:
        """The run has reached this time [s] since its start; returns the time on the network."""
        self.now = now = self.offset + time
        return now
