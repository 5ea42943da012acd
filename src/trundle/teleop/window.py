"""Driving by the arrow keys of MuJoCo's window."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

from trundle.teleop.keys import StepDrive

if TYPE_CHECKING:
    from trundle.record.drive_log import DriveLog
    from trundle.sim import Simulator
    from trundle.viewer.native import NativeWindow


def drive_in_window(simulator: Simulator, log: DriveLog, window: NativeWindow, *, period_s: float) -> None:
    """Drive in real time by the arrow keys of a window, until it is closed or Ctrl-C."""
    drive = StepDrive(simulator.robot.limits)
    print("arrows: faster, slower, left, right   space: stop   close the window to end", file=sys.stderr)
    log.begin(0.0, 0.0, 0.0)
    due = time.monotonic()
    try:
        while window.is_open:
            for key in window.read_keys():
                drive.press(key)
            command = drive.twist()
            state = simulator.step(command, period_s)
            log.add(state, command)
            window.show(state.pose, state.wheel_positions)
            due += period_s
            time.sleep(max(0.0, due - time.monotonic()))
    except KeyboardInterrupt:
        pass  # Ctrl-C is a normal end: the drive is still recorded.
