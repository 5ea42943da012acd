"""MuJoCo's own window: shows a robot in a world or a run, and reads the keys for teleoperation."""

from __future__ import annotations

import math
import os
import queue
import sys
import threading
import time
import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self

import mujoco
import numpy.typing as npt

from trundle.errors import InputError, SimulationError
from trundle.geometry import Pose2D
from trundle.robots import Robot
from trundle.sim import RobotState
from trundle.sim.mover_history import MoverHistory
from trundle.viewer.cameras import Camera
from trundle.viewer.route import goal_radius, mark_route
from trundle.viewer.scene_model import AT_REST, SHOWN_GROUPS, SceneModel, movers_at_start
from trundle.worlds import World

if TYPE_CHECKING:
    from trundle.mission import Episode, RunInfo, Step
    from trundle.path import Path
    from trundle.robots import Robot
    from trundle.worlds import World

_KEYS = {265: "up", 264: "down", 263: "left", 262: "right", 32: "stop"}
"""GLFW's codes of the keys that drive. Letters are in use: the window toggles its display with them."""

_CLOSING_S = 10.0  # how long a window may take to close
_SHADOWS_M = 40.0
"""Half the width of the shadow map [m], beyond which the floor is speckled."""


def has_screen() -> bool:
    """Return whether a window with OpenGL can be opened here, tried with a hidden one."""
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return False
    import glfw

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # glfw reports a missing screen as a warning
        if not glfw.init():
            return False
        glfw.window_hint(glfw.VISIBLE, glfw.FALSE)
        window = glfw.create_window(16, 16, "trundle", None, None)
        if window:
            glfw.destroy_window(window)
        glfw.terminate()
    return bool(window)


class NativeWindow:
    """MuJoCo's window on a robot in a world.

    Args:
        world: The world.
        robot: The robot.
        pose: Its pose, map frame. By default, it is the world's first seed point, or the origin.
        chase: Keep the camera behind the robot; otherwise it starts close to its front and is moved by the mouse.

    Raises:
        SimulationError: If there is no screen.
    """

    def __init__(
        self, world: World, robot: Robot, pose: Pose2D | Sequence[float] | None = None, *, chase: bool = False
    ) -> None:
        if not has_screen():
            raise SimulationError("no screen with OpenGL was found; write a picture instead (-o scene.png)")
        import mujoco.viewer

        if pose is None:
            pose = world.seeds[0] if world.seeds else (0.0, 0.0)
        pose = Pose2D.of(pose)
        self._scene = SceneModel(world, robot, size=(1280, 720), samples=4, shadow_size=4096)
        self._scene.place(pose, AT_REST, movers_at_start(world, robot, pose))
        self._movers = MoverHistory()
        self._chase = chase
        self._scene.model.vis.map.shadowclip = _SHADOWS_M / self._scene.model.stat.extent
        camera = self._scene.aim("chase" if chase else "robot", pose)
        self._keys: queue.SimpleQueue[str] = queue.SimpleQueue()
        model, data = self._scene.model, self._scene.data
        others = set(threading.enumerate())
        self._handle: Any = mujoco.viewer.launch_passive(
            model, data, key_callback=self._on_key, show_left_ui=False, show_right_ui=False
        )
        self._threads = [thread for thread in threading.enumerate() if thread not in others]
        with self._handle.lock():
            self._handle.opt.geomgroup[:] = SHOWN_GROUPS
            self._point(camera)
        self._handle.sync()

    @property
    def is_open(self) -> bool:
        """Whether it is still open."""
        return bool(self._handle.is_running())

    def show(self, state: RobotState) -> None:
        """Show the robot in another state, and the movers with their trails."""
        pose = state.pose
        self._movers.add(state.time, state.movers)
        if self.is_open:
            with self._handle.lock():
                self._scene.place(pose, state.wheel_positions, self._movers.at(state.time))
                if self._chase:
                    self._point(self._scene.aim("chase", pose))
            self._handle.sync()

    def mark_route(self, path: npt.ArrayLike | None, goal: Pose2D | None) -> None:
        """Show a path (waypoints [m], map frame, shape (N, 2) or more columns) and a goal on the floor, or neither."""
        if self.is_open:
            with self._handle.lock():
                mark_route(self._handle.user_scn, path, goal, goal_radius(self._scene.robot.circumscribed_radius))
            self._handle.sync()

    def read_keys(self) -> list[str]:
        """Return the keys pressed since the last call: `up`, `down`, `left`, `right`, `stop` (the space bar)."""
        keys: list[str] = []
        while not self._keys.empty():
            keys.append(self._keys.get())
        return keys

    def wait(self) -> None:
        """Wait until it is closed."""
        while self.is_open:
            time.sleep(0.05)

    def close(self) -> None:
        """Close it; closing twice does nothing."""
        self._handle.close()
        # GLFW is terminated when the program ends; a window that is still being drawn would crash it.
        for thread in self._threads:
            thread.join(_CLOSING_S)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _on_key(self, code: int) -> None:
        if code in _KEYS:
            self._keys.put(_KEYS[code])

    def _point(self, camera: Camera) -> None:
        azimuth, elevation = camera.angles()
        view = self._handle.cam
        view.type = mujoco.mjtCamera.mjCAMERA_FREE.value
        view.lookat[:] = camera.target
        view.distance = camera.distance
        view.azimuth, view.elevation = math.degrees(azimuth), math.degrees(elevation)


def open_window(world: World, robot: Robot, pose: Pose2D) -> NativeWindow:
    """Open a window on a robot that drives; the camera stays behind it.

    Raises:
        InputError: If there is no screen.
    """
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
        """Do nothing: the last picture stays."""

    def _mark(self, step: Step) -> None:
        """Show the path that it follows and the goal that it drives to, if they have changed."""
        if self._run is None or (self._shown[0] is step.path and self._shown[1] == step.goal):
            return
        self._shown = (step.path, step.goal)
        goals = self._run.goals
        goal = Pose2D.of(goals[min(step.goal, len(goals) - 1)]) if goals else None
        self._window.mark_route(None if step.path is None else step.path.poses, goal)
