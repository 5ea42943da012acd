"""A robot's lidars: their timing, directions and noise, what they can see, and their beams through a world."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import TypeAlias

import numpy as np

from trundle import _core
from trundle.errors import InputError, UnknownNameError
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.geometry.solids import Solid
from trundle.observation import Scan, make_scan
from trundle.robots import Lidar, Robot
from trundle.sim.beams import WorldOutline
from trundle.sim.movers import MoverField, MoverOutline
from trundle.values import check_seed, show_value
from trundle.worlds import World
from trundle.worlds.movers.crowd import each_body

_NO_NOISE = np.zeros(0)

BeamCaster: TypeAlias = Callable[[float, float, float, FloatArray, float], FloatArray]
"""`cast(x, y, z, angles, reach)`: distances [m] in the map frame from (x, y, z) [m] along level beams at `angles`
[rad], evenly spaced and ascending, to the nearest solid, infinity without one within `reach` [m]."""

LidarChoice: TypeAlias = bool | str | Iterable[str]
"""True for all of a robot's lidars, False for none, or names."""


def beam_angles(lidar: Lidar) -> FloatArray:
    """Directions of a lidar's beams [rad] in its own frame, shape (beams,), counter-clockwise.

    They include both ends of the field of view, except on a full turn, whose ends are one direction.
    """
    return lidar.angles


def choose_lidars(robot: Robot, choice: LidarChoice) -> tuple[str, ...]:
    """Return the names of a robot's lidars that are chosen, in order.

    Raises:
        UnknownNameError: If the robot has no lidar of a chosen name.
        InputError: If the choice is neither a bool nor names, or a name is there twice.
    """
    if isinstance(choice, bool):
        return tuple(robot.lidars) if choice else ()
    if not isinstance(choice, Iterable):
        raise InputError(f"lidar must be true, false, or names of lidars, got {show_value(choice)}")
    names = (choice,) if isinstance(choice, str) else tuple(choice)
    for name in names:
        if not isinstance(name, str) or name not in robot.lidars:
            raise UnknownNameError(f"lidar of {robot.name}", str(name), robot.lidars)
        if names.count(name) > 1:
            raise InputError(f"lidar {name!r} is chosen twice; name each lidar once")
    return names


class LidarSet:
    """The enabled lidars of a robot.

    Beams are level, at the mount's height above the floor, and pass through the robot itself. A range below
    `range_min` reads `range_min`; noise is Gaussian, drawn per beam from the run's seed.

    Args:
        robot: The robot.
        choice: The enabled lidars.
        cast: Measures distances.

    Raises:
        UnknownNameError: If the robot has no lidar of a chosen name.
        InputError: If the choice is none, or has a name twice.
    """

    def __init__(self, robot: Robot, choice: LidarChoice, cast: BeamCaster) -> None:
        names = choose_lidars(robot, choice)
        self._lidars = [(name, robot.lidars[name], beam_angles(robot.lidars[name])) for name in names]
        self._mounts = {name: Pose2D(lidar.x, lidar.y, lidar.yaw) for name, lidar, _ in self._lidars}
        self._cast = cast
        self.reset(0)

    @property
    def heights(self) -> tuple[float, ...]:
        """Heights [m] above the floor at which beams run."""
        return tuple(lidar.z for _, lidar, _ in self._lidars)

    def reset(self, seed: int) -> None:
        """Reseed the noise.

        Raises:
            InputError: If the seed is not an integer of 0 or more.
        """
        self._rng = np.random.default_rng(check_seed(seed))

    def scan(self, pose: Pose2D, since: float, now: float) -> tuple[Scan, ...]:
        """Take the scans due after `since` and up to `now` [s], at most one per lidar, at `pose`."""
        if not self._lidars:
            return ()
        turn = math.cos(pose.yaw), math.sin(pose.yaw)
        return tuple(
            [
                self._take(name, lidar, angles, pose, turn, now)
                for name, lidar, angles in self._lidars
                if math.floor(now * lidar.rate + 1e-6) > math.floor(since * lidar.rate + 1e-6)
            ]
        )

    def _take(
        self, name: str, lidar: Lidar, angles: FloatArray, pose: Pose2D, turn: tuple[float, float], now: float
    ) -> Scan:
        mount, (cos, sin) = self._mounts[name], turn
        x, y = pose.x + cos * mount.x - sin * mount.y, pose.y + sin * mount.x + cos * mount.y
        ranges = self._cast(x, y, lidar.z, angles + wrap_angle(pose.yaw + mount.yaw), lidar.range_max)
        noise = self._rng.standard_normal(len(angles)) if lidar.noise > 0.0 else _NO_NOISE
        ranges = _core.measure_ranges(ranges, noise, lidar.noise, lidar.range_min, lidar.range_max)
        return make_scan(name, now, mount, lidar.z, angles, ranges, lidar.range_min, lidar.range_max)


class SceneBeams:
    """Casts beams against the outline of a world at their height, and against its movers where they are now.

    Args:
        world: The world.
        movers: Its movers; None without any.
    """

    def __init__(self, world: World, movers: MoverField | None) -> None:
        self._world, self._movers = world, movers
        self._outlines: dict[float, WorldOutline] = {}
        self._mover_outlines: dict[float, MoverOutline] = {}

    def prepare(self, heights: Iterable[float]) -> None:
        """Cut the world at these heights above the floor [m]; beams can be cast at no others."""
        for height in heights:
            if height not in self._outlines:
                self._outlines[height] = WorldOutline(self._world, height)
                if self._movers is not None:
                    self._mover_outlines[height] = MoverOutline(self._movers, height)

    def change_world(self, world: World) -> None:
        """Cast against another world with the same movers from now on."""
        self._world = world
        self._outlines = {height: WorldOutline(world, height) for height in self._outlines}

    def cast(self, x: float, y: float, z: float, angles: FloatArray, reach: float) -> FloatArray:
        """Distances [m] from (x, y, z) along level beams; see `trundle.sim.lidar.BeamCaster`."""
        ranges = self._outlines[z].cast(x, y, angles, reach)
        if self._movers is not None:
            np.minimum(ranges, self._mover_outlines[z].cast(x, y, angles, reach), out=ranges)
        return ranges


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
