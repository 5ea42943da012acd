"""Which solids the planar lidars of a robot can see at all: those that the plane of one crosses."""

from __future__ import annotations

from collections.abc import Iterable

from trundle.geometry.solids import Solid
from trundle.robots import Robot
from trundle.worlds import World
from trundle.worlds.movers.crowd import each_body


def crosses_height(solid: Solid, height: float) -> bool:
    """Whether a solid has a part at a height above the floor [m]."""
    low, high = solid.bounds()
    return bool(low[2] <= height <= high[2])


def unseen_names(world: World, robot: Robot, lidars: Iterable[str] | None = None) -> frozenset[str]:
    """Names of the solids and movers of a world that are too low or too high for the robot's lidars.

    Args:
        world: The world.
        robot: The robot.
        lidars: Names of the lidars that are used. If None, all of the robot's.

    Returns:
        Names as contacts have them. Of the cells of a map, the name of the solid. A mover is seen if one of its solids
        is.
    """
    heights = [robot.lidars[name].z for name in (robot.lidars if lidars is None else lidars)]
    things = [(solid.name, (solid,)) for solid in world.solids] + each_body(world.movers)
    return frozenset(
        name for name, parts in things if not any(crosses_height(part, height) for part in parts for height in heights)
    )
