"""One picture of a robot in a world, with or without a screen, with or without OpenGL."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.files.writing import atomic_path
from trundle.geometry import Pose2D
from trundle.robots import Robot
from trundle.viewer.cameras import Camera
from trundle.viewer.gl import describe_missing_gl
from trundle.viewer.moving import movers_at_start
from trundle.viewer.painters import RendererKind
from trundle.viewer.scene import SceneRenderer
from trundle.worlds import World


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
        pose: Its pose, map frame; None means the world's first seed point, or the origin.
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
