"""`SceneBeams`: beams through a world and its movers, at the heights of a robot's lidars."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from trundle.geometry import FloatArray
from trundle.sim.beams import WorldOutline
from trundle.sim.movers import MoverField, MoverOutline
from trundle.worlds import World


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
