"""Driving by the arrow keys of MuJoCo's window."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from typing import TYPE_CHECKING

from trundle.geometry import Twist2D
from trundle.teleop.drive import drive_by_hand
from trundle.teleop.keys import StepDrive

if TYPE_CHECKING:
    from trundle.geometry import Pose2D
    from trundle.mission import Observer, Step
    from trundle.record.drive_log import DriveLog
    from trundle.sim import Simulator
    from trundle.viewer.native import NativeWindow


class WindowKeys:
    """The arrow keys of a window, until it is closed.

    Args:
        drive: Converts the keys.
        window: The window.
    """

    def __init__(self, drive: StepDrive, window: NativeWindow) -> None:
        self._drive = drive
        self._window = window

    def read(self) -> Twist2D | None:
        """The command of the keys that were pressed until now; None when the window is closed."""
        if not self._window.is_open:
            return None
        for key in self._window.read_keys():
            self._drive.press(key)
        return self._drive.twist()


def drive_in_window(
    simulator: Simulator,
    start: Pose2D,
    log: DriveLog,
    window: NativeWindow,
    *,
    period_s: float,
    seed: int = 0,
    observers: Sequence[Observer] = (),
) -> None:
    """Drive in real time by the arrow keys of a window, until it is closed or Ctrl-C; see `drive_by_hand`."""
    print("arrows: faster, slower, left, right   space: stop   close the window to end", file=sys.stderr)
    keys = WindowKeys(StepDrive(simulator.robot.limits), window)

    def show(step: Step) -> None:
        window.show(step.state)

    drive_by_hand(simulator, start, log, keys, show, period_s=period_s, seed=seed, observers=observers)
