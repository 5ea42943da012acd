"""`CommandArbiter`: which of the commands from the network drives the robot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from trundle.geometry import Twist2D

TIMEOUT_S = 0.5
"""A robot without a new command stops after this simulated time [s]."""

STAND = Twist2D()


@dataclass(frozen=True, slots=True)
class _Command:
    twist: Twist2D
    source: str
    time: float


class CommandArbiter:
    """Holds the command that drives the robot; the listening thread offers, the thread of the run reads.

    One source drives at a time: the first that moves the robot keeps it until it commands to stand, or is silent for
    `timeout_s`. What another source sends meanwhile is dropped and reported.

    Args:
        warn: Reports what is dropped: its kind, and what makes the text.
        describe: Who a source is, in words.
        timeout_s: How long a command holds, in simulated time [s].
    """

    def __init__(
        self,
        warn: Callable[[str, Callable[[], str]], None],
        describe: Callable[[str], str],
        *,
        timeout_s: float = TIMEOUT_S,
    ) -> None:
        self._warn, self._describe, self._timeout_s = warn, describe, timeout_s
        self._held: _Command | None = None

    def offer(self, twist: Twist2D, source: str, now: float) -> bool:
        """Take a command that came at a simulated time [s]; whether it drives the robot."""
        held = self._held
        if held is not None and held.source != source and held.twist != STAND and not self._is_old(held, now):
            self._warn(
                "cmd_vel: two sources",
                lambda: (
                    f"{self._describe(source)} commands the robot, too, while {self._describe(held.source)} drives "
                    f"it: it is not heard until the other commands to stand, or is silent for {self._timeout_s:g} s"
                ),
            )
            return False
        self._held = _Command(twist, source, now)
        return True

    def command(self, now: float) -> Twist2D:
        """The command at a simulated time [s]; to stand, where there is none or it is too old."""
        held = self._held
        if held is None:
            return STAND
        if self._is_old(held, now):
            if held.twist != STAND:
                self._warn(
                    "cmd_vel: timeout",
                    lambda: f"no command for {self._timeout_s:g} s from {self._describe(held.source)}: the robot stops",
                )
            self._held = None
            return STAND
        return held.twist

    def clear(self) -> bool:
        """Let the robot stand until the next command; whether it was driven."""
        held, self._held = self._held, None
        return held is not None and held.twist != STAND

    def _is_old(self, held: _Command, now: float) -> bool:
        return not -1e-9 <= now - held.time < self._timeout_s - 1e-9
