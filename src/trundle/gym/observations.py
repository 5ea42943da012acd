"""What a policy observes, as a dictionary of arrays, and its spaces."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from trundle.gym.episodes import Episodes
from trundle.gym.lookup import POINT_SPACING

Observations = dict[str, Any]
"""Arrays by name: NumPy's, or PyTorch's on a GPU."""

FARTHEST = 200.0
"""Distances to a goal are observed up to this [m]."""

_DIRECTION_BOUNDS = np.array([0.0, -1.0, -1.0], dtype=np.float32), np.array([FARTHEST, 1.0, 1.0], dtype=np.float32)
"""Of a distance [m], and the cosine and sine of its direction."""


class Observer:
    """Observes the robots of some episodes.

    The observations, each in base_link:

    - `ranges`: Of all beams, one lidar after the other [m]; without a return `range_max`.
    - `goal`: Straight distance to the goal [m], up to 200, and the cosine and sine of its direction.
    - `velocity`: v [m/s] and w [rad/s].
    - `path`: Points of a path to the goal that keeps away from walls [m], 0.5 m apart, as (x, y), with `path_points`;
      on the map without `unmapped_boxes`.
    - `costmap`: Costs around the robot, uint8, its x axis along the columns, with `costmap_cells`.
    - `critic`: Length of the shortest path [m], and the cosine and sine of the direction of that path, with `critic`.

    Args:
        episodes: The episodes.
    """

    def __init__(self, episodes: Episodes) -> None:
        self._episodes = episodes
        settings, robot = episodes.settings, episodes.arena.robot
        lidars = list(robot.lidars.values())
        self._range_max = np.concatenate([np.full(each.beams, each.range_max, np.float32) for each in lidars])
        self._points, self._cells = settings.path_points, settings.costmap_cells
        self._critic = settings.critic
        arrays = episodes.arrays
        self._reach = arrays.put(self._range_max)
        self._least = arrays.put(np.array([1e-9]))  # a distance to divide by [m]
        self._bounds = tuple(arrays.put(bound) for bound in _DIRECTION_BOUNDS)
        self._offsets = arrays.put(self._costmap_offsets()) if self._cells else None

    def space(self) -> spaces.Dict:
        """Return the space of one robot's observation; all bounds are finite."""
        limits = self._episodes.arena.robot.limits
        fastest = np.array([limits.linear_speed, limits.angular_speed], dtype=np.float32)
        slowest = np.array([-(limits.reverse_speed or limits.linear_speed), -limits.angular_speed], dtype=np.float32)
        found: dict[str, spaces.Space] = {
            "ranges": spaces.Box(np.zeros_like(self._range_max), self._range_max),
            "goal": spaces.Box(*_DIRECTION_BOUNDS),
            "velocity": spaces.Box(slowest - np.float32(1e-3), fastest + np.float32(1e-3)),
        }
        if self._points:
            far = (self._points + 1) * POINT_SPACING * 2.0
            found["path"] = spaces.Box(-far, far, (self._points, 2), np.float32)
        if self._cells:
            found["costmap"] = spaces.Box(0, 255, (self._cells, self._cells), np.uint8)
        if self._critic:
            found["critic"] = spaces.Box(*_DIRECTION_BOUNDS)
        return spaces.Dict(found)

    def observe(self) -> Observations:
        """Return what the robots observe now, without a new scan; arrays of the device, of shape (N, …)."""
        episodes, arrays = self._episodes, self._episodes.arrays
        sim, goals = episodes.sim, episodes.goals
        poses = sim.poses
        x, y, cos, sin = poses[:, 0], poses[:, 1], arrays.lib.cos(poses[:, 2]), arrays.lib.sin(poses[:, 2])
        found: Observations = {
            "ranges": arrays.lib.minimum(sim.ranges, self._reach),
            "goal": self._direction(goals[:, 0] - x, goals[:, 1] - y, cos, sin),
            "velocity": arrays.cast(sim.twists, "float32"),
        }
        path = None
        if self._points:
            far = (self._points + 1) * POINT_SPACING * 2.0
            path = [(to_x - x, to_y - y) for to_x, to_y in episodes.lookup.path(poses, self._points, known=True)]
            parts = [part for dx, dy in path for part in (cos * dx + sin * dy, cos * dy - sin * dx)]
            local = arrays.columns(*parts).reshape(len(poses), self._points, 2)
            found["path"] = arrays.cast(arrays.clip(local, -far, far), "float32")
        if self._critic:
            if path is None or episodes.arena.known is not episodes.arena.grids:
                path = [(to_x - x, to_y - y) for to_x, to_y in episodes.lookup.path(poses, 1, known=False)]
            ahead = self._direction(*path[0], cos, sin)
            ahead[:, 0] = arrays.clip(episodes.distances, 0.0, FARTHEST)
            found["critic"] = ahead
        if self._cells:
            costs = episodes.lookup.costs_around(poses, self._offsets)
            found["costmap"] = costs.reshape(len(poses), self._cells, self._cells)
        return found

    def scan(self, robots: Any = None) -> None:
        """Take a new scan of these robots, by their indices, or of all."""
        self._episodes.sim.scan(robots=robots)

    def _costmap_offsets(self) -> npt.NDArray[np.float64]:
        """Return where cells of a local costmap are, base_link [m], shape (cells², 2)."""
        middle = (np.arange(self._cells, dtype=np.float64) - (self._cells - 1) / 2.0) * self._episodes.arena.resolution
        return np.stack(np.meshgrid(middle, middle), axis=-1).reshape(-1, 2)

    def _direction(self, x: Any, y: Any, cos: Any, sin: Any) -> Any:
        """Return the length of an offset (x, y), and cosine and sine of its direction in base_link, shape (N, 3)."""
        arrays = self._episodes.arrays
        distance = arrays.lib.hypot(x, y)
        scale = arrays.lib.maximum(distance, self._least)
        found = arrays.columns(distance, (cos * x + sin * y) / scale, (cos * y - sin * x) / scale, kind="float32")
        return arrays.clip(found, *self._bounds)  # rounding may lead past 1
