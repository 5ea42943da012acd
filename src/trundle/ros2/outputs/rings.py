"""`RingPoints`: what a lidar of several rings sees."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trundle.geometry import FloatArray, Pose2D
from trundle.robots import Lidar
from trundle.ros2.role import BridgeContext
from trundle.sim import RobotState
from trundle.sim.lidar import beam_angles
from trundle.sim.mujoco.ring_beams import RingBeams
from trundle.worlds import World


class RingPoints:
    """Measures the points of a lidar whose rings rise and fall, in the simulated world, with its floor.

    Args:
        context: The bridge.
        lidar: Where it is mounted, its beams in each ring, and its range.
        rings: Elevation of each ring [deg].
    """

    def __init__(self, context: BridgeContext, lidar: Lidar, rings: Sequence[float]) -> None:
        self._sim, self._lidar = context.mission.sim, lidar
        rise, turn = np.meshgrid(np.radians(rings), beam_angles(lidar), indexing="ij")
        level = np.cos(rise)
        self._directions = np.stack([level * np.cos(turn), level * np.sin(turn), np.sin(rise)], axis=-1).reshape(-1, 3)
        self._world: World | None = None
        self._beams: RingBeams | None = None

    def measure(self, state: RobotState) -> FloatArray:
        """Points [m] in the frame of the lidar, ring by ring, shape (rings × beams, 3); NaN without a return."""
        world, lidar = self._sim.world, self._lidar
        if self._beams is None or world is not self._world:
            self._world = world
            self._beams = RingBeams(World("empty", ()) if world is None else world)
        sensor = state.pose @ Pose2D(lidar.x, lidar.y, lidar.yaw)
        cos, sin = np.cos(sensor.yaw), np.sin(sensor.yaw)
        turn = np.array([[cos, sin, 0.0], [-sin, cos, 0.0], [0.0, 0.0, 1.0]])
        origin = sensor.x, sensor.y, lidar.z
        ranges = self._beams.cast(origin, self._directions @ turn, lidar.range_max, state.movers)
        ranges[~np.isfinite(ranges) | (ranges < lidar.range_min)] = np.nan
        return self._directions * ranges[:, None]
