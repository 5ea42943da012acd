"""Driving by the arrow keys of MuJoCo's window."""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING

from trundle.geometry import Goal, Twist2D
from trundle.mission import Session
from trundle.navigation import NavigationStatus
from trundle.teleop.keys import StepDrive

if TYPE_CHECKING:
    from trundle.geometry import Pose2D
    from trundle.observation import Estimate, Observation
    from trundle.record.drive_log import DriveLog
    from trundle.sim import Simulator
    from trundle.viewer.native import NativeWindow


class WindowAgent:
    """An agent that drives by the arrow keys of a window until it is closed.

    Args:
        drive: Converts the keys.
        window: The window.
        period_s: Length of a control period [s].

    Attributes:
        status: FINISHED when the window is closed.
        dt: Length of a control period [s].
    """

    def __init__(self, drive: StepDrive, window: NativeWindow, *, period_s: float) -> None:
        self._drive = drive
        self._window = window
        self.dt = period_s
        self.status = NavigationStatus.DRIVING

    def reset(self, *, seed: int = 0) -> None:
        """Do nothing: the window keeps the keys."""

    def set_goal(self, goal: Goal, /) -> None:
        """Do nothing: the keys say where to drive."""

    def update(self, observation: Observation, estimate: Estimate, /) -> Twist2D:
        """Return the command of the keys that were pressed."""
        if not self._window.is_open:
            self.status = NavigationStatus.FINISHED
            return Twist2D()
        for key in self._window.read_keys():
            self._drive.press(key)
        return self._drive.twist()


def drive_in_window(
    simulator: Simulator, start: Pose2D, log: DriveLog, window: NativeWindow, *, period_s: float, seed: int = 0
) -> None:
    """Drive in real time by the arrow keys of a window, until it is closed or Ctrl-C."""
    agent = WindowAgent(StepDrive(simulator.robot.limits), window, period_s=period_s)
    session = Session(simulator, agent, start, seed=seed, stop_on_contact=False, measure=None)
    log.add(session.state)
    print("arrows: faster, slower, left, right   space: stop   close the window to end", file=sys.stderr)
    log.begin(0.0, 0.0, 0.0)
    due = time.monotonic()
    try:
        while (step := session.step()) is not None:
            log.add(step.state, step.sent)
            window.show(step.state)
            due += period_s
            time.sleep(max(0.0, due - time.monotonic()))
    except KeyboardInterrupt:
        return  # Ctrl-C is a normal end: the drive is still recorded.
    if session.error is not None and not isinstance(session.error, KeyboardInterrupt):
        raise session.error
