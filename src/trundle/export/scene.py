"""`Scene`: a robot in a world, with its start pose and planned paths."""

from __future__ import annotations

from dataclasses import dataclass

from trundle.geometry import Pose2D
from trundle.maps.masks import SpeedMask
from trundle.path import Path
from trundle.robots import Robot
from trundle.worlds import World


@dataclass(frozen=True, slots=True)
class Scene:
    """A prepared scenario: world, robot, start and plans.

    Attributes:
        name: Shown in the exported file.
        world: The world.
        robot: The robot.
        start: Pose of base_link, map frame.
        paths: The planned paths to its goals, in order; empty if nothing was planned.
        speed_mask: Limits its speed, or None.
    """

    name: str
    world: World
    robot: Robot
    start: Pose2D
    paths: tuple[Path, ...] = ()
    speed_mask: SpeedMask | None = None
