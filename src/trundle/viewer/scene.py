"""`SceneRenderer`: pictures of a robot in a world, one after another."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Self

import numpy.typing as npt

from trundle.errors import InputError, SimulationError
from trundle.geometry import Pose2D
from trundle.robots import Robot, WheelSpeeds
from trundle.sim.mover_history import ShownMovers
from trundle.viewer.cameras import Camera
from trundle.viewer.painters import Painter, Pixels, RendererKind, open_painter
from trundle.viewer.scene_model import AT_REST, SceneModel
from trundle.worlds import World

MAX_SIZE = 4096
"""Largest width and height of a picture, in pixels."""


class SceneRenderer:
    """Draws a robot in a world for one pose after another, with OpenGL if there is a driver, else in software.

    Args:
        world: The world.
        robot: The robot.
        size: Width and height of the pictures, in pixels.
        camera: One of `CAMERAS` or a fixed `Camera`.
        path: Waypoints [m] in the map frame, shape (N, 2) or more columns, drawn on the floor.
        goal: Drawn on the floor as a disc.
        samples: Samples per pixel at edges; 0 is fastest, 4 looks best.
        shadow_size: Edge of the shadow map, in pixels; 0 draws no shadows.

    Raises:
        InputError: If the size is out of range, or the path is invalid.
        WorldError: If a solid cannot be modelled.
    """

    def __init__(
        self,
        world: World,
        robot: Robot,
        *,
        size: tuple[int, int] = (1280, 720),
        camera: str | Camera = "chase",
        path: npt.ArrayLike | None = None,
        goal: Pose2D | None = None,
        samples: int = 0,
        shadow_size: int = 1024,
    ) -> None:
        width, height = (int(edge) for edge in size)
        if not (1 <= width <= MAX_SIZE and 1 <= height <= MAX_SIZE):
            raise InputError(f"a picture's size must be 1 to {MAX_SIZE} pixels wide and high, got {width} x {height}")
        self._camera = camera
        self._scene = SceneModel(
            world, robot, size=(width, height), path=path, goal=goal, samples=samples, shadow_size=shadow_size
        )
        self._painter: Painter | None = open_painter(self._scene.model, (width, height))
        self._kind: RendererKind = self._painter.kind

    @property
    def kind(self) -> RendererKind:
        """The kind of renderer: `egl`, `osmesa` or `software`."""
        return self._kind

    def render(
        self,
        pose: Pose2D | Sequence[float],
        *,
        wheel_positions: WheelSpeeds = AT_REST,
        movers: ShownMovers | None = None,
    ) -> Pixels:
        """Draw the robot at a pose.

        Args:
            pose: Pose of base_link in the map frame.
            wheel_positions: Angles of the drive wheels [rad].
            movers: The moving obstacles; None leaves them where they were, at first where their motions begin.

        Returns:
            RGB, shape (height, width, 3).

        Raises:
            SimulationError: If it was closed.
        """
        if self._painter is None:
            raise SimulationError("this SceneRenderer is closed; create a new one")
        pose = Pose2D.of(pose)
        self._scene.place(pose, wheel_positions, movers)
        return self._painter.paint(self._scene.data, self._scene.aim(self._camera, pose))

    def close(self) -> None:
        """Release the driver's context; closing twice does nothing."""
        if self._painter is not None:
            self._painter.close()
            self._painter = None

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
