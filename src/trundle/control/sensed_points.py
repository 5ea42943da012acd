"""`SensedPoints`: what the latest scans of a robot hit, where that is now, and how fast it moves."""

from __future__ import annotations

import bisect
import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trundle import _core
from trundle.geometry import FloatArray, Footprint, Pose2D
from trundle.observation import PoseBuffer, Scan

_COMPARE_S = 0.25  # movement is found between scans this far apart [s]
_KEPT_S = 1.0  # older scans are compared with none any more
_BODY_M = 1e-6  # hits within the outline are the robot's own body
_NOTHING, _NO_TIMES, _NO_BEAMS = np.zeros((0, 2)), np.zeros(0), np.zeros(0)


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Points that scans hit.

    Attributes:
        places: [m], shape (N, 2), those of one lidar after the other.
        velocities: [m/s], shape (N, 2); 0 for what does not move.
        counts: Number of points of each lidar, in the order of `names`.
        names: Names of the lidars.
        moves: Whether any of them moves.
    """

    places: FloatArray
    velocities: FloatArray
    counts: tuple[int, ...]
    names: tuple[str, ...]
    moves: bool

    def within(self, low: FloatArray, high: FloatArray) -> Points:
        """Return those in a box, and those that move."""
        x, y = self.places[:, 0], self.places[:, 1]
        kept = (x >= low[0]) & (x <= high[0]) & (y >= low[1]) & (y <= high[1])
        kept |= (self.velocities[:, 0] != 0.0) | (self.velocities[:, 1] != 0.0)
        ends = itertools.accumulate(self.counts)
        counts = tuple(int(kept[end - count : end].sum()) for count, end in zip(self.counts, ends, strict=True))
        return Points(self.places[kept], self.velocities[kept], counts, self.names, self.moves)

    def lidar_of(self, index: int) -> str:
        """Return the name of the lidar that saw a point."""
        return self.names[bisect.bisect_right(list(itertools.accumulate(self.counts)), index)]


@dataclass(slots=True, eq=False)
class _Seen:
    """The hits of one scan, odom frame, in the order of its beams; and how far each beam saw through.

    Where some of them move, their velocities follow. Edges are hits that have come to where an earlier scan saw
    through, with their own velocities.
    """

    scan: Scan
    sensor: FloatArray
    points: FloatArray
    angles: FloatArray
    through: FloatArray
    moves: tuple[FloatArray, ...] = ()
    edges: tuple[FloatArray, ...] = ()

    def find_moved(self, before: _Seen) -> None:
        """Find what has moved since an older scan."""
        velocities, moves, edges = _core.find_moved(
            *(self.points, self.sensor, self.angles, self.through),
            *(before.points, before.sensor, before.angles, before.through, self.scan.time - before.scan.time),
        )
        self.moves = (velocities,) if moves else ()
        self.edges = (np.ascontiguousarray(edges[:, :2]), np.ascontiguousarray(edges[:, 2:])) if len(edges) else ()


class SensedPoints:
    """Keeps the scans of the last second and places them by the odometry at their own times.

    What moves is told from what stands by comparing two scans of a lidar that are a quarter of a second apart: where
    the first one saw through, and the second one hits something, something has moved in; and where the second one sees
    through what the first one hit, it has moved away. All of it, also what slides along the beams, gets the velocity of
    the middle of its points. What turns on the spot has none, and its end is fast: points that have moved in also count
    with their own velocity, from the nearest hit of the first scan. Lone hits (see `PlacedScan`) are left out.

    Args:
        footprint: Footprint of the robot. Points inside are its own body.

    Attributes:
        times: Times of the latest scan of each lidar [s].
    """

    def __init__(self, footprint: Footprint) -> None:
        self._body = np.add(Edges(footprint).sides, (0.0, 0.0, _BODY_M))
        self._poses = PoseBuffer()
        self.clear()

    def clear(self) -> None:
        """Forget all scans."""
        self._poses.clear()
        self._seen: dict[str, list[_Seen]] = {}
        self.times: dict[str, float] = {}

    def add(self, scans: Sequence[Scan], time: float, odometry: Pose2D) -> None:
        """Add the scans that arrived by now [s], with the pose of base_link in the odom frame.

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
            kept = self._seen.setdefault(scan.lidar, [])
            kept.append(self._place(scan, base, kept[-1] if kept else None))
            while kept[0].scan.time < scan.time - _KEPT_S:
                del kept[0]
            latest = scan.time - _COMPARE_S + 1e-6
            for before in reversed(kept):
                if before.scan.time <= latest:
                    kept[-1].find_moved(before)
                    break

    def around(self, time: float, odometry: Pose2D, reach: float, horizon: float, oldest: float) -> Points:
        """Return what the latest scans hit within `reach` [m] of base_link, where it is now: base_link, [m].

        What moves is continued at its velocity up to now, and counts farther away: by what it drives in `horizon` [s].
        Scans from before `oldest` [s] do not count.
        """
        places, velocities, counts, moves = list[FloatArray](), list[FloatArray](), list[int](), False
        here = np.array(odometry.as_tuple())
        for kept in self._seen.values():
            seen, count = kept[-1], 0
            if seen.scan.time >= oldest:
                moves = moves or bool(seen.moves or seen.edges)
                hits = (seen.points, *(seen.moves or (_NOTHING,)))
                for points, moved in (hits, seen.edges) if seen.edges else (hits,):
                    near, velocity = _core.points_around(points, moved, here, time - seen.scan.time, reach, horizon)
                    places.append(near)
                    velocities.append(velocity)
                    count += len(near)
            counts.append(count)
        if len(places) <= 1:
            place, velocity = (places[0], velocities[0]) if places else (_NOTHING, _NOTHING)
            return Points(place, velocity, tuple(counts), tuple(self._seen), moves)
        return Points(np.concatenate(places), np.concatenate(velocities), tuple(counts), tuple(self._seen), moves)

    def _place(self, scan: Scan, base: Pose2D, before: _Seen | None) -> _Seen:
        mount = scan.mount
        sensor = np.array((base @ mount).as_tuple())
        earlier = (_NO_BEAMS, _NO_BEAMS, sensor)
        if before is not None:
            earlier = before.scan.ranges, before.scan.angles, before.sensor
        placed = _core.place_scan(
            *(scan.ranges, scan.angles, np.array(mount.as_tuple()), np.array(base.as_tuple()), self._body),
            *(scan.range_min, scan.range_max, sensor, *earlier),
        )
        return _Seen(scan, sensor, *placed)


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
        """Return the distance [m] of points from the outline at poses: negative inside, a little short at a corner.

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
