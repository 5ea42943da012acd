"""Verbs in MuJoCo's window: watching a run, driving by its arrow keys."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

from trundle.errors import InputError

if TYPE_CHECKING:
    from trundle.cli.drive_log import DriveLog
    from trundle.geometry import Pose2D
    from trundle.mission import Episode, RunInfo, Step
    from trundle.robots import Robot
    from trundle.sim import Simulator
    from trundle.viewer.native import NativeWindow
    from trundle.worlds import World


def open_window(world: World, robot: Robot, pose: Pose2D) -> NativeWindow:
    """Open a window on a robot that drives; the camera stays behind it.

    Raises:
        InputError: If there is no screen.
    """
    from trundle.viewer.native import NativeWindow, has_screen

    if not has_screen():
        raise InputError("--view needs a screen that shows OpenGL, and there is none here; leave it out")
    return NativeWindow(world, robot, pose, chase=True)


def drive_in_window(simulator: Simulator, log: DriveLog, window: NativeWindow, *, period_s: float) -> None:
    """Drive in real time by the arrow keys of a window, until it is closed or Ctrl-C."""
    from trundle.viewer.native import StepDrive

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
        pass  # One of the ways to end; the drive is recorded all the same.


class Watcher:
    """Shows a run in a window, no faster than real time. Closing the window lets the run go on unseen."""

    def __init__(self, window: NativeWindow) -> None:
        self._window = window
        self._began = 0.0

    def on_start(self, run: RunInfo) -> None:
        """Start the clock."""
        self._began = time.monotonic()

    def on_step(self, step: Step) -> None:
        """Show the robot, and wait until it is due there."""
        if self._window.is_open:
            self._window.show(step.state.pose, step.state.wheel_positions)
            time.sleep(max(0.0, self._began + step.state.time - time.monotonic()))

    def on_end(self, episode: Episode) -> None:
        """Leave the last picture as it is."""
