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
from trundle.viewer.cameras import Camera, front_views
from trundle.viewer.gl import describe_missing_gl
from trundle.viewer.painters import Painter, Pixels, RendererKind, open_painter
from trundle.viewer.route import DRIVEN_COLOR, FloorLine, bends, path_pieces
from trundle.viewer.scene_model import AT_REST, SceneModel, movers_at_start
from trundle.worlds import World

if TYPE_CHECKING:
    from trundle.mission import Episode, Mission

MAX_SIZE = 4096
"""Largest width and height of a picture, in pixels."""

QUICK_S = 0.01
"""If a small picture takes longer than this, it is rendered by the CPU instead of a GPU."""

STRIDE = 2
"""Frames per rendered picture where there is no GPU."""


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
        camera: Camera | None = None,
        lines: Sequence[FloorLine] = (),
    ) -> Pixels:
        """Draw the robot at a pose.

        Args:
            pose: Pose of base_link in the map frame.
            wheel_positions: Angles of the drive wheels [rad].
            movers: The moving obstacles. If None, they stay where they were, at first where their motions begin.
            camera: Another camera for this picture.
            lines: Lines on the floor, drawn with OpenGL only.

        Returns:
            RGB, shape (height, width, 3).

        Raises:
            SimulationError: If it was closed.
        """
        if self._painter is None:
            raise SimulationError("this SceneRenderer is closed; create a new one")
        pose = Pose2D.of(pose)
        self._scene.place(pose, wheel_positions, movers)
        view = self._scene.aim(self._camera if camera is None else camera, pose)
        return self._painter.paint(self._scene.data, view, lines)

    def front_views(self, poses: npt.NDArray[np.float64]) -> list[Camera]:
        """Return cameras at the robot's front quarter for pictures of a run, poses [m, m, rad] of shape (N, 3)."""
        return front_views(self._scene.robot, poses, self._scene.is_clear)

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
    """Shows the robot from its front quarter, with the path that it follows and the one that it has driven.

    With a GPU: large, with shadows. Without one: smaller, without shadows, and each picture is shown twice.

    Args:
        mission: The mission.
        episode: Its episode.
        rows: Which rows of its trajectory are rendered, in order.
    """

    def __init__(self, mission: Mission, episode: Episode, rows: npt.NDArray[np.intp]) -> None:
        self._mission = mission
        self._goal = episode.goals[-1].pose if episode.goals else None
        self._stride = STRIDE
        self._count = 0
        self._scene = self._open((960, 540), shadow_size=0)
        if self._is_quick():
            self._scene.close()
            self._stride = 1
            self._scene = self._open((1280, 720), shadow_size=2048)
        self._poses = episode.trajectory.poses[rows]
        self._views = self._scene.front_views(self._poses)
        self._planned = [FloorLine(np.array(path_pieces(path.poses)).reshape(-1, 2, 2)) for path in episode.paths]
        self._follows = episode.trajectory.path[rows]
        self._picture = self._render(self._mission.start, None)

    def render(self, pose: Pose2D, movers: ShownMovers) -> Pixels:
        """Return the picture for the next frame."""
        if self._count % self._stride == 0:
            self._picture = self._render(pose, movers)
        self._count += 1
        return self._picture

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._scene.close()

    def _render(self, pose: Pose2D, movers: ShownMovers | None) -> Pixels:
        row = min(self._count, len(self._poses) - 1)
        driven = np.array(path_pieces(bends(self._poses[: row + 1]))).reshape(-1, 2, 2)
        lines = [FloorLine(driven, DRIVEN_COLOR, width=0.04, height=0.010)]
        # The first row is the start, before the first path is followed.
        follows = max(0, int(self._follows[row]))
        lines += self._planned[follows : follows + 1]
        return self._scene.render(pose, movers=movers, camera=self._views[row], lines=lines)

    def _open(self, size: tuple[int, int], *, shadow_size: int) -> SceneRenderer:
        return SceneRenderer(
            self._mission.world,
            self._mission.robot,
            size=size,
            goal=self._goal,
            shadow_size=shadow_size,
        )

    def _is_quick(self) -> bool:
        self._scene.render(self._mission.start)  # the first picture also prepares the driver
        began = time.perf_counter()
        self._scene.render(self._mission.start)
        return time.perf_counter() - began < QUICK_S
