"""What a policy observes, as a dictionary of arrays, and its spaces."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from trundle.costmap import Costmap
from trundle.gym.episodes import Episodes

Observations = dict[str, npt.NDArray]

FARTHEST = 200.0
"""Distances to a goal are observed up to this [m]."""

_POINT_SPACING = 0.5  # [m]


class Observer:
    """Observes the robots of some episodes.

    The observations, each in base_link:

    - `ranges`: Of all beams, one lidar after the other [m]; without a return `range_max`.
    - `goal`: Straight distance to the goal [m], up to 200, and the cosine and sine of its direction.
    - `velocity`: v [m/s] and w [rad/s].
    - `path`: Points of a path to the goal that keeps away from walls [m], 0.5 m apart, as (x, y), with `path_points`.
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
        self._costs = [Costmap.from_grid(grid, robot).data for grid in episodes.arena.grids] if self._cells else []
        self._offsets = self._costmap_offsets() if self._cells else np.zeros((0, 2))

    def space(self) -> spaces.Dict:
        """Return the space of one robot's observation; all bounds are finite."""
        limits = self._episodes.arena.robot.limits
        fastest = np.array([limits.linear_speed, limits.angular_speed], dtype=np.float32)
        slowest = np.array([-(limits.reverse_speed or limits.linear_speed), -limits.angular_speed], dtype=np.float32)
        direction = np.array([FARTHEST, 1.0, 1.0], dtype=np.float32)
        found: dict[str, spaces.Space] = {
            "ranges": spaces.Box(np.zeros_like(self._range_max), self._range_max),
            "goal": spaces.Box(np.array([0.0, -1.0, -1.0], dtype=np.float32), direction),
            "velocity": spaces.Box(slowest - np.float32(1e-3), fastest + np.float32(1e-3)),
        }
        if self._points:
            far = (self._points + 1) * _POINT_SPACING * 2.0
            found["path"] = spaces.Box(-far, far, (self._points, 2), np.float32)
        if self._cells:
            found["costmap"] = spaces.Box(0, 255, (self._cells, self._cells), np.uint8)
        if self._critic:
            found["critic"] = spaces.Box(np.array([0.0, -1.0, -1.0], dtype=np.float32), direction)
        return spaces.Dict(found)

    def observe(self) -> Observations:
        """Return what the robots observe now, without a new scan; arrays of shape (N, …)."""
        episodes = self._episodes
        sim = episodes.sim
        poses = sim.poses
        cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        found: Observations = {
            "ranges": np.minimum(sim.ranges, self._range_max),
            "goal": _direction(episodes.goals[:, 0] - poses[:, 0], episodes.goals[:, 1] - poses[:, 1], cos, sin),
            "velocity": sim.twists.astype(np.float32),
        }
        if self._points or self._critic:
            path = self._path(max(self._points, 1))
            local = _into_base(path - poses[:, None, :2], cos[:, None], sin[:, None])
            if self._points:
                far = (self._points + 1) * _POINT_SPACING * 2.0
                found["path"] = np.clip(local, -far, far).astype(np.float32)
            if self._critic:
                ahead = _direction(path[:, 0, 0] - poses[:, 0], path[:, 0, 1] - poses[:, 1], cos, sin)
                ahead[:, 0] = np.minimum(episodes.distances, FARTHEST)
                found["critic"] = ahead
        if self._cells:
            found["costmap"] = self._local_costs(cos, sin)
        return found

    def scan(self, robots: npt.ArrayLike | None = None) -> None:
        """Take a new scan of these robots, or of all."""
        self._episodes.sim.scan(robots=robots)

    def _path(self, points: int) -> npt.NDArray[np.float64]:
        """Points of the path ahead, map frame [m], shape (N, points, 2): descent on the costs to go to the goal."""
        episodes = self._episodes
        arena, maps = episodes.arena, episodes.sim.places[:, 0]
        row, col = arena.cells_of(episodes.sim.poses[:, :2], maps)
        steps = max(1, round(_POINT_SPACING / arena.resolution))
        best = arena.field_at(row, col, maps, episodes.fields, guide=True)
        out = np.empty((episodes.count, points, 2))
        around = [(i, j) for i in (-1, 0, 1) for j in (-1, 0, 1) if (i, j) != (0, 0)]
        for point in range(points):
            for _ in range(steps):
                here_row, here_col = row, col
                for down, right in around:
                    value = arena.field_at(here_row + down, here_col + right, maps, episodes.fields, guide=True)
                    better = value < best
                    row, col = np.where(better, here_row + down, row), np.where(better, here_col + right, col)
                    best = np.where(better, value, best)
            out[:, point] = arena.points_of(row, col, maps)
        return out

    def _costmap_offsets(self) -> npt.NDArray[np.float64]:
        middle = (np.arange(self._cells, dtype=np.float64) - (self._cells - 1) / 2.0) * self._episodes.arena.resolution
        return np.stack(np.meshgrid(middle, middle), axis=-1).astype(np.float64)

    def _local_costs(self, cos: npt.NDArray, sin: npt.NDArray) -> npt.NDArray[np.uint8]:
        """Costs of the map around each robot, its x axis to the right and its y axis up; beyond the map 255."""
        sim, arena = self._episodes.sim, self._episodes.arena
        out = np.full((sim.count, self._cells, self._cells), 255, dtype=np.uint8)
        x, y = self._offsets[..., 0], self._offsets[..., 1]
        for robot in range(sim.count):
            number = sim.places[robot, 0]
            points = np.stack([cos[robot] * x - sin[robot] * y, sin[robot] * x + cos[robot] * y], axis=-1)
            maps = np.full(x.shape, number)
            row, col = arena.cells_of(points + sim.poses[robot, :2], maps)
            costs = self._costs[number]
            inside = (row >= 0) & (row < costs.shape[0]) & (col >= 0) & (col < costs.shape[1])
            out[robot][inside] = costs[row[inside], col[inside]]
        return out


def _into_base(offset: npt.NDArray, cos: npt.NDArray, sin: npt.NDArray) -> npt.NDArray:
    x, y = offset[..., 0], offset[..., 1]
    return np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1)


def _direction(x: npt.NDArray, y: npt.NDArray, cos: npt.NDArray, sin: npt.NDArray) -> npt.NDArray[np.float32]:
    """Distance of an offset (x, y), map frame, and the cosine and sine of its direction in base_link, shape (N, 3)."""
    distance = np.hypot(x, y)
    scale = np.maximum(distance, 1e-9)
    out = np.empty((len(x), 3), dtype=np.float32)
    np.minimum(distance, FARTHEST, out=out[:, 0])
    # Rounding may lead past 1, which is a bound.
    np.clip((cos * x + sin * y) / scale, -1.0, 1.0, out=out[:, 1])
    np.clip((cos * y - sin * x) / scale, -1.0, 1.0, out=out[:, 2])
    return out
