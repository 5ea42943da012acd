"""Showing a robot in a window while it drives."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

from trundle.errors import InputError
from trundle.geometry import Pose2D

if TYPE_CHECKING:
    from trundle.mission import Episode, RunInfo, Step
    from trundle.path import Path
    from trundle.robots import Robot
    from trundle.viewer.native import NativeWindow
    from trundle.worlds import World


def open_window(world: World, robot: Robot, pose: Pose2D) -> NativeWindow:
    """Open a window on a robot that drives; the camera stays behind it.

    Raises:
        InputError: If there is no screen.
    """
    from trundle.viewer.native import NativeWindow, has_screen

    if not has_screen():
        raise InputError("--view needs a screen with OpenGL, but none was found; run without it")
    return NativeWindow(world, robot, pose, chase=True)


class Watcher:
    """Shows a run in a window, with its path and its goal.

    If the window is closed, the run continues without it.

    Args:
        window: The window.
        paces: Whether it holds the run back to real time; otherwise something else sets its speed.
    """

    def __init__(self, window: NativeWindow, *, paces: bool = True) -> None:
        self._window, self._paces = window, paces
        self._began = 0.0
        self._run: RunInfo | None = None
        self._shown: tuple[Path | None, int] = (None, -1)

    def on_start(self, run: RunInfo) -> None:
        """Start the clock."""
        self._run, self._shown = run, (None, -1)
        self._began = time.monotonic()

    def on_step(self, step: Step) -> None:
        """Show the robot, and wait until real time has caught up."""
        if not self._window.is_open:
            return
        self._mark(step)
        self._window.show(step.state)
        if self._paces:
            time.sleep(max(0.0, self._began + step.state.time - time.monotonic()))

    def on_end(self, episode: Episode) -> None:
        """Leave the last picture as it is."""

    def _mark(self, step: Step) -> None:
        """Show the path that it follows and the goal that it drives to, if they have changed."""
        if self._run is None or (self._shown[0] is step.path and self._shown[1] == step.goal):
            return
        self._shown = (step.path, step.goal)
        goals = self._run.goals
        goal = Pose2D.of(goals[min(step.goal, len(goals) - 1)]) if goals else None
        self._window.mark_route(None if step.path is None else step.path.poses, goal)
