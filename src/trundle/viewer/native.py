"""MuJoCo's own window: shows a robot in a world where there is a screen, and reads keys for driving by hand."""

from __future__ import annotations

import math
import os
import queue
import sys
import time
import warnings
from collections.abc import Sequence
from typing import Any, Self

import mujoco

from trundle.errors import SimulationError
from trundle.geometry import Pose2D, Twist2D
from trundle.robots import Limits, Robot, WheelSpeeds
from trundle.viewer.stage import AT_REST, SHOWN_GROUPS, Stage
from trundle.worlds import World

_KEYS = {265: "up", 264: "down", 263: "left", 262: "right", 32: "stop"}
"""GLFW's codes of the keys that drive. Letters are taken: the window switches what it shows by them."""


def has_screen() -> bool:
    """Whether a window with OpenGL can be opened here; it tries, unseen."""
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
    """MuJoCo's window on a robot in a world; the camera follows the robot and is moved with the mouse.

    Args:
        world: What stands on the floor.
        robot: Who is shown.
        pose: Where it stands, map frame; none means at the world's first seed point, or at the origin.

    Raises:
        SimulationError: If there is no screen.
    """

    def __init__(self, world: World, robot: Robot, pose: Pose2D | Sequence[float] | None = None) -> None:
        if not has_screen():
            raise SimulationError("there is no screen that shows OpenGL; draw a picture instead")
        import mujoco.viewer

        if pose is None:
            pose = world.seeds[0] if world.seeds else (0.0, 0.0)
        pose = Pose2D.of(pose)
        self._stage = Stage(world, robot, size=(1280, 720), samples=4, shadow_size=4096)
        self._stage.place(pose)
        self._keys: queue.SimpleQueue[str] = queue.SimpleQueue()
        model, data = self._stage.model, self._stage.data
        self._handle: Any = mujoco.viewer.launch_passive(
            model, data, key_callback=self._on_key, show_left_ui=False, show_right_ui=False
        )
        with self._handle.lock():
            self._handle.opt.geomgroup[:] = SHOWN_GROUPS
            self._follow(pose)
        self._handle.sync()

    @property
    def is_open(self) -> bool:
        """Whether nobody has closed it yet."""
        return bool(self._handle.is_running())

    def show(self, pose: Pose2D, wheel_positions: WheelSpeeds = AT_REST) -> None:
        """Show the robot at another pose (map frame), its drive wheels turned by these angles [rad]."""
        if self.is_open:
            with self._handle.lock():
                self._stage.place(pose, wheel_positions)
            self._handle.sync()

    def read_keys(self) -> list[str]:
        """Return the keys pressed since the last call: `up`, `down`, `left`, `right`, `stop` (the space bar)."""
        keys: list[str] = []
        while not self._keys.empty():
            keys.append(self._keys.get())
        return keys

    def wait(self) -> None:
        """Wait until somebody closes it."""
        while self.is_open:
            time.sleep(0.05)

    def close(self) -> None:
        """Close it; closing twice does nothing."""
        self._handle.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _on_key(self, code: int) -> None:
        if code in _KEYS:
            self._keys.put(_KEYS[code])

    def _follow(self, pose: Pose2D) -> None:
        camera = self._stage.aim("chase", pose)
        azimuth, elevation = camera.angles()
        view = self._handle.cam
        view.type = mujoco.mjtCamera.mjCAMERA_TRACKING.value
        view.trackbodyid = self._stage.model.body("base_link").id
        view.distance = camera.distance
        view.azimuth, view.elevation = math.degrees(azimuth), math.degrees(elevation)


class StepDrive:
    """Turns single key presses into a twist, a fifth of the robot's largest speed a press.

    The window tells when a key goes down and never when it comes up, so that a key cannot mean "while held": up and
    down change the speed, left and right the turn, and `stop` ends both.
    """

    STEPS = 5

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._forward = 0
        self._left = 0

    def press(self, key: str) -> None:
        """Take one key of `NativeWindow.read_keys`; others do nothing."""
        match key:
            case "up" | "down":
                self._forward = self._stepped(self._forward, key == "up")
            case "left" | "right":
                self._left = self._stepped(self._left, key == "left")
            case "stop":
                self._forward = self._left = 0
            case _:
                pass

    def twist(self) -> Twist2D:
        """Return the command."""
        return Twist2D(
            self._forward / self.STEPS * self._limits.linear_speed,
            self._left / self.STEPS * self._limits.angular_speed,
        )

    def _stepped(self, value: int, up: bool) -> int:
        return max(-self.STEPS, min(self.STEPS, value + (1 if up else -1)))
