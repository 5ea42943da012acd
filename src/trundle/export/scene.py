"""`Scene`: a robot in a world, and the way that it shall go."""

from __future__ import annotations

from dataclasses import dataclass

from trundle.geometry import Pose2D
from trundle.maps.masks import SpeedMask
from trundle.path import Path
from trundle.robots import Robot
from trundle.worlds import World


@dataclass(frozen=True, slots=True)
class Scene:
    """What a scenario comes to before anything moves.

    Attributes:
        name: Of the file that is written, for people.
        world: Where it drives.
        robot: What drives.
        start: Where its base_link stands, map frame.
        paths: The plans to its goals, in order; none where nothing was planned.
        speed_mask: What limits its speed on the way, or None.
    """

    name: str
    world: World
    robot: Robot
    start: Pose2D
    paths: tuple[Path, ...] = ()
    speed_mask: SpeedMask | None = None
