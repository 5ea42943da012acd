"""`SensedPoints`: what the latest scans of a robot hit, where that is now, and how fast it moves."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap.layers.lone_hits import LoneHits
from trundle.geometry import FloatArray, Footprint, Pose2D
from trundle.observation import PoseBuffer, Scan

_COMPARE_S = 0.25  # movement is found between scans this far apart [s]
_KEPT_S = 1.0  # older scans are compared with none any more
_BEAMS_ASIDE = 3  # an edge may be seen by another beam in the next scan: ranges of so many on each side count
_BODY_M = 1e-6  # hits within the outline are the robot's own body
_NOTHING, _NO_TIMES = np.zeros((0, 2)), np.zeros(0)


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Points that scans hit.

    Attributes:
        places: [m], shape (N, 2).
        velocities: [m/s], shape (N, 2); 0 for what does not move.
        lidars: Index in `names` of the lidar that saw each, shape (N,).
        names: Of the lidars.
    """

    places: FloatArray
    velocities: FloatArray
    lidars: npt.NDArray[np.intp]
    names: tuple[str, ...]

    def within(self, low: FloatArray, high: FloatArray) -> Points:
        """Those in a box, and those that move."""
        x, y = self.places[:, 0], self.places[:, 1]
        kept = (x >= low[0]) & (x <= high[0]) & (y >= low[1]) & (y <= high[1])
        kept |= (self.velocities[:, 0] != 0.0) | (self.velocities[:, 1] != 0.0)
        return Points(self.places[kept], self.velocities[kept], self.lidars[kept], self.names)


@dataclass(slots=True, eq=False)
class _Seen:
    """The hits of one scan, odom frame, in the order of its beams; and how far each beam saw through.

    Edges are hits that have come to where an earlier scan saw through, with their own velocities.
    """

    scan: Scan
    sensor: Pose2D
    points: FloatArray
    velocities: FloatArray
    through: tuple[FloatArray, FloatArray]
    moves: bool = False
    edges: tuple[FloatArray, FloatArray] = (_NOTHING, _NOTHING)


class SensedPoints:
    """Keeps the scans of the last second and places them by the odometry at their own times.

    What moves is told from what stands by comparing two scans of a lidar that are a quarter of a second apart: where
    the first one saw through, and the second one hits something, something has moved in; and where the second one sees
    through what the first one hit, it has moved away. All of it, also what slides along the beams, gets the velocity of
    the middle of its points. What turns on the spot has none, and its end is fast: points that have moved in also count
    with their own velocity, from the nearest hit of the first scan. Lone hits (see `LoneHits`) are left out.

    Args:
        footprint: Of the robot. Points inside are its own body.

    Attributes:
        times: Of the latest scan of each lidar [s].
    """

    def __init__(self, footprint: Footprint) -> None:
        self._body = np.add(Edges(footprint).sides, (0.0, 0.0, _BODY_M))
        self._poses = PoseBuffer()
        self._lone = LoneHits()
        self.clear()

    def clear(self) -> None:
        """Forget all scans."""
        self._poses.clear()
        self._lone.clear()
        self._seen: dict[str, list[_Seen]] = {}
        self.times: dict[str, float] = {}

    def add(self, scans: Sequence[Scan], time: float, odometry: Pose2D) -> None:
        """Take the scans that arrived by now [s], with the pose of base_link in the odom frame.

        A scan that is older than the last one of its lidar, from the future or from before the first pose is left out.
        """
        last = self._poses.last_time
        if last is not None and time <= last:
            if time < last:
                self.clear()
                self._poses.add(time, odometry)
        else:
            self._poses.add(time, odometry)
        for scan in scans:
            base = self._poses.at(scan.time)
            if base is None or scan.time > time + 1e-6 or scan.time <= self.times.get(scan.lidar, -math.inf):
                continue
            self.times[scan.lidar] = scan.time
            seen = self._place(scan, base)
            kept = self._seen.setdefault(scan.lidar, [])
            kept.append(seen)
            while kept[0].scan.time < scan.time - _KEPT_S:
                del kept[0]
            before = next((old for old in reversed(kept) if old.scan.time <= scan.time - _COMPARE_S + 1e-6), None)
            if before is not None:
                _find_moved(seen, before)

    def around(self, time: float, odometry: Pose2D, reach: float, horizon: float, oldest: float) -> Points:
        """What the latest scans hit within `reach` [m] of base_link, where it is now: base_link, [m].

        What moves is continued at its velocity up to now, and counts farther away: by what it drives in `horizon` [s].
        Scans from before `oldest` [s] do not count.
        """
        places, velocities, lidars = [_NOTHING], [_NOTHING], [np.zeros(0, dtype=np.intp)]
        here = np.array(odometry.as_tuple())
        for index, kept in enumerate(self._seen.values()):
            seen = kept[-1]
            if seen.scan.time < oldest:
                continue
            moves = (seen.points, seen.velocities if seen.moves else _NOTHING)
            for points, moved in (moves, seen.edges) if len(seen.edges[0]) else (moves,):
                near, velocity = _core.points_around(points, moved, here, time - seen.scan.time, reach, horizon)
                places.append(near)
                velocities.append(velocity)
                lidars.append(np.full(len(near), index))
        return Points(np.concatenate(places), np.concatenate(velocities), np.concatenate(lidars), tuple(self._seen))

    def _place(self, scan: Scan, base: Pose2D) -> _Seen:
        sensor = base @ scan.mount
        scan = self._lone.without(scan, np.array([sensor.as_tuple()]), put=math.inf)  # saw through, as those beside it
        mount, at = np.array(scan.mount.as_tuple()), base.as_tuple()
        placed, _ = _core.pick_beams(
            *(scan.ranges, scan.angles, mount, np.array((at, at)), self._body),
            *(scan.range_min, math.nextafter(scan.range_max, math.inf), max(1, len(scan.ranges)), 0.0),
        )
        return _Seen(scan, sensor, placed, np.zeros_like(placed), _saw_through(scan))


class Edges:
    """The edges of a convex outline as half-planes, to measure how far many points are from it at many poses.

    Args:
        footprint: The outline.
    """

    def __init__(self, footprint: Footprint) -> None:
        self._outline = outline = footprint.outline
        along = np.roll(outline, -1, axis=0) - outline
        self._normals = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(along[:, 0], along[:, 1])[:, None]
        self._offsets: FloatArray = (self._normals * outline).sum(axis=1)
        self._sides = self.sides

    @property
    def sides(self) -> FloatArray:
        """The normal of each edge and how far the outline reaches along it [m], shape (N, 3)."""
        return np.column_stack([self._normals, self._offsets])

    def clearances(
        self, points: Points, poses: FloatArray, padding: float, rank: int, times: FloatArray = _NO_TIMES
    ) -> FloatArray:
        """Distance [m] of the `rank`-th nearest point at each pose, as `distances` has them, infinity where it is far.

        Those that move count, and those in the box round the outline at all poses, wider by a padding [m]. With times
        [s], shape (K,), they are where they will be then.

        Returns:
            Shape (K,).
        """
        given = points.places, points.velocities, poses, times
        return _core.outline_clearances(*given, self._outline, self._sides, padding, rank)

    def distances(
        self, points: FloatArray, poses: FloatArray, moved: FloatArray | None = None, times: FloatArray | None = None
    ) -> FloatArray:
        """Distance [m] of each point from the outline at each pose: negative inside, and at a corner a little short.

        Args:
            points: [m], shape (N, 2).
            poses: (x, y, yaw) of base_link in the frame of the points, shape (K, 3).
            moved: Velocities of the points [m/s], shape (N, 2), with
            times: at which the robot is at the poses [s], shape (K,).

        Returns:
            Shape (K, N).
        """
        cos, sin = np.cos(poses[:, 2]), np.sin(poses[:, 2])
        farthest: FloatArray | None = None
        for (x, y), offset in zip(self._normals.tolist(), self._offsets.tolist(), strict=True):
            across, up = cos * x - sin * y, sin * x + cos * y
            apart = np.multiply.outer(across, points[:, 0])
            apart += np.multiply.outer(up, points[:, 1])
            apart -= (across * poses[:, 0] + up * poses[:, 1] + offset)[:, None]
            if moved is not None and times is not None:
                apart += np.multiply.outer(across * times, moved[:, 0]) + np.multiply.outer(up * times, moved[:, 1])
            farthest = apart if farthest is None else np.maximum(farthest, apart, out=farthest)
        return np.zeros((len(poses), len(points))) if farthest is None else farthest


def box_around(footprint: Footprint, poses: FloatArray, padding: float) -> tuple[FloatArray, FloatArray]:
    """Least and greatest x and y [m] of a footprint at poses of shape (K, 3), wider by a padding [m]."""
    corners = footprint.at_poses(poses)
    return corners.min(axis=(0, 1)) - padding, corners.max(axis=(0, 1)) + padding


def _find_moved(seen: _Seen, before: _Seen) -> None:
    """Set the velocities and the edges of what has moved since an older scan."""
    seconds = seen.scan.time - before.scan.time
    own, old = np.array(seen.sensor.as_tuple()), np.array(before.sensor.as_tuple())
    found = _core.find_moved(seen.points, own, *seen.through, before.points, old, *before.through, seconds)
    seen.velocities, seen.moves, edges = found
    seen.edges = (np.ascontiguousarray(edges[:, :2]), np.ascontiguousarray(edges[:, 2:]))


def _saw_through(scan: Scan) -> tuple[FloatArray, FloatArray]:
    """Angles [rad], ascending, and how far the beam there and those beside it saw [m], both of shape (N,).

    It is minus infinity beside a beam that measured nothing.
    """
    angles, ranges = scan.angles, np.where(scan.ranges >= scan.range_min, scan.ranges, -np.inf)
    if len(angles) and angles[0] > angles[-1]:
        angles, ranges = angles[::-1], ranges[::-1]
    count = len(ranges)
    if count < _BEAMS_ASIDE:
        return angles, np.full_like(ranges, ranges.min(initial=np.inf))
    around = np.concatenate([ranges[-_BEAMS_ASIDE:], ranges, ranges[:_BEAMS_ASIDE]])
    of_two = np.minimum(around[:-1], around[1:])
    of_four = np.minimum(of_two[:-2], of_two[2:])
    return angles, np.minimum(of_four[:-3], of_four[3:])  # of 2 * _BEAMS_ASIDE + 1, from each on
