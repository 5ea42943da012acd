"""`SceneRenderer`: pictures of a robot in a world, one by one; `render`, a single one; the frames of a video."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Self

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, SimulationError
from trundle.files.writing import atomic_path
from trundle.geometry import Pose2D
from trundle.robots import Robot, WheelSpeeds
from trundle.sim.mover_history import ShownMovers
from trundle.viewer.cameras import Camera
from trundle.viewer.gl import describe_missing_gl
from trundle.viewer.painters import Painter, Pixels, RendererKind, open_painter
from trundle.viewer.scene_model import AT_REST, SceneModel, movers_at_start
from trundle.worlds import World

if TYPE_CHECKING:
    from trundle.mission import Episode, Mission

MAX_SIZE = 4096
"""Largest width and height of a picture, in pixels."""

QUICK_S = 0.01
"""If a small picture takes longer than this, it is rendered by the CPU instead of a GPU."""

STRIDE = 2
"""Without a GPU, frames per rendered picture."""


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
            movers: The moving obstacles. If None, they stay where they were, at first where their motions begin.

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


@dataclass(frozen=True, slots=True)
class Picture:
    """A drawn picture.

    Attributes:
        pixels: RGB, shape (height, width, 3), uint8, read-only.
        kind: How it was drawn: `egl`, `osmesa` or `software`.
        advice: What to install for a better picture; may be empty.
    """

    pixels: npt.NDArray[np.uint8]
    kind: RendererKind
    advice: str = ""

    def __post_init__(self) -> None:
        self.pixels.flags.writeable = False

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it as PNG, atomically.

        Raises:
            OutputError: If the file cannot be written.
        """
        from PIL import Image

        with atomic_path(path) as temporary:
            Image.fromarray(self.pixels).save(temporary, format="PNG")


def render(
    world: World,
    robot: Robot,
    pose: Pose2D | Sequence[float] | None = None,
    *,
    size: tuple[int, int] = (1280, 720),
    camera: str | Camera = "robot",
    path: npt.ArrayLike | None = None,
    goal: Pose2D | None = None,
) -> Picture:
    """Draw a robot in a world.

    Args:
        world: The world.
        robot: The robot.
        pose: Its pose, map frame. By default, it is the world's first seed point, or the origin.
        size: Width and height, in pixels.
        camera: One of `CAMERAS` or a fixed `Camera`.
        path: Waypoints [m], map frame, shape (N, 2) or more columns, drawn on the floor.
        goal: Drawn on the floor as a disc.

    Raises:
        InputError: If the size is out of range or there is no such camera.
        WorldError: If a solid cannot be modelled.
    """
    if pose is None:
        pose = Pose2D(*world.seeds[0]) if world.seeds else Pose2D(0.0, 0.0)
    with SceneRenderer(
        world, robot, size=size, camera=camera, path=path, goal=goal, samples=4, shadow_size=4096
    ) as scene:
        at = Pose2D.of(pose)
        pixels = scene.render(at, movers=movers_at_start(world, robot, at))
        kind = scene.kind
    return Picture(pixels, kind, describe_missing_gl() if kind == "software" else "")


class SceneFrames:
    """Follows the robot with a camera behind it.

    With a GPU: large, with shadows. Without one: smaller, without shadows, and each picture is shown twice.

    Args:
        mission: The mission.
        episode: Its episode.
    """

    def __init__(self, mission: Mission, episode: Episode) -> None:
        self._mission = mission
        self._path = episode.paths[0].poses if episode.paths else None
        self._goal = episode.goals[-1].pose if episode.goals else None
        self._stride = STRIDE
        self._count = 0
        self._scene = self._open((960, 540), shadow_size=0)
        if self._is_quick():
            self._scene.close()
            self._stride = 1
            self._scene = self._open((1280, 720), shadow_size=2048)
        self._picture = self._scene.render(mission.start)

    def render(self, pose: Pose2D, movers: ShownMovers) -> Pixels:
        """Return the picture for the next frame."""
        if self._count % self._stride == 0:
            self._picture = self._scene.render(pose, movers=movers)
        self._count += 1
        return self._picture

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._scene.close()

    def _open(self, size: tuple[int, int], *, shadow_size: int) -> SceneRenderer:
        return SceneRenderer(
            self._mission.world,
            self._mission.robot,
            size=size,
            camera="chase",
            path=self._path,
            goal=self._goal,
            shadow_size=shadow_size,
        )

    def _is_quick(self) -> bool:
        self._scene.render(self._mission.start)  # the first picture also prepares the driver
        began = time.perf_counter()
        self._scene.render(self._mission.start)
        return time.perf_counter() - began < QUICK_S
