"""Lidar beams through a MuJoCo model."""

from __future__ import annotations

import mujoco
import numpy as np

from trundle._core import cast_grid_rays
from trundle.errors import WorldError
from trundle.geometry import FloatArray, Pose2D
from trundle.sim.mujoco.world_parts import GROUP_WORLD
from trundle.solids import OccupancyCells, Solid
from trundle.worlds import World


class MujocoRays:
    """Casts level beams at a world: MuJoCo at its geoms, our own grid traversal at blocked cells.

    Args:
        model: The compiled world and robot.
        data: Its state; solids do not move, so it need not be up to date.
        world: What the model was built from.
    """

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, world: World) -> None:
        self._model, self._data = model, data
        self._groups = np.zeros(mujoco.mjNGROUP, dtype=np.uint8)
        self._groups[GROUP_WORLD] = 1
        self._cells = [_Cells(solid, solid.shape) for solid in world.solids if isinstance(solid.shape, OccupancyCells)]
        self._has_geoms = len(world.solids) > len(self._cells)

    def cast(self, x: float, y: float, z: float, angles: FloatArray, reach: float) -> FloatArray:
        """Measure distances; see `trundle.sim.lidar.BeamCaster`."""
        count = len(angles)
        distances = np.full(count, np.inf)
        if self._has_geoms:
            beams = np.stack([np.cos(angles), np.sin(angles), np.zeros(count)], axis=1).ravel()
            geoms = np.empty(count, dtype=np.int32)
            hits = np.empty(count)
            origin = np.array([x, y, z])
            mujoco.mj_multiRay(
                self._model, self._data, origin, beams, self._groups, True, -1, geoms, hits, None, count, reach
            )
            # The cutoff leaves out far geoms, not far hits on near ones.
            distances = np.where((geoms >= 0) & (hits <= reach), hits, np.inf)
        for cells in self._cells:
            np.minimum(distances, cells.cast(x, y, z, angles, reach), out=distances)
        return distances


class _Cells:
    def __init__(self, solid: Solid, shape: OccupancyCells) -> None:
        if not solid.pose.is_upright():
            raise WorldError(f"blocked cells {solid.name!r} must lie level for a lidar; its pose is tilted")
        x, y, self._low = solid.pose.position
        self._high = self._low + shape.height
        self._inverse = Pose2D(x, y, solid.pose.yaw()).inverse()
        self._blocked = shape.blocked.view(np.uint8)
        self._resolution = shape.resolution

    def cast(self, x: float, y: float, z: float, angles: FloatArray, reach: float) -> FloatArray:
        if not self._low <= z <= self._high:
            return np.full(len(angles), np.inf)
        local = self._inverse @ Pose2D(x, y)
        scale = self._resolution
        turned = angles + self._inverse.yaw
        return cast_grid_rays(self._blocked, local.x / scale, local.y / scale, turned, reach / scale) * scale
