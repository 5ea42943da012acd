"""`LoopFinder`: places that the robot has come back to; `seen_through`: whether such a match can be true.

A key frame is compared with old submaps, within what the drift since then leaves open: correlative search where that is
little, branch and bound where it is much (Hess, Kohler, Rapp and Andor 2016). One match in a large window proves
nothing: there, several of different key frames must agree with each other along the odometry between them (pairwise
consistency: Mangelson, Dominic, Eustice and Vasudevan 2018).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from trundle._core import search_poses
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.localization.amcl.search import thin_out
from trundle.mapping.nodes import Nodes, Surface
from trundle.mapping.submaps import Submaps
from trundle.mapping.window import match_surface

_APART = 45  # nodes: what is nearer is in the window of the front end
_VIEW_M = 6.0  # how far apart two places are that see the same
# Where the drift since then leaves no more open than this, correlative search is quick enough; else branch and bound.
_NEAR_M, _NEAR_RAD = 0.6, math.radians(8.0)
_WIDEST_M = 25.0  # the widest window that is searched, however far the robot may have drifted
_NEAR_TRIES, _FAR_TRIES = 3, 6  # submaps that are compared with one key frame, which bounds the time of a loop
# What a match is at least. benchmarks/mapping/slam.py shows what other values do to five public logs.
_NEAR_FIT, _FAR_FIT = 0.55, 0.55
_FAR_OVERLAP = 0.65
_POINTS = 120  # of a key frame that are searched with, at most one in each square of
_POINT_CELL_M = 0.15
_YAW_STEP = math.radians(1.0)
_LEAST_SCORE = 130.0  # of 255
# Other places are kept that reach this share of the best score and are so far apart; the search has a limit of nodes.
_SHARE, _APART_M, _APART_RAD, _MOST, _MOST_NODES = 0.93, 0.6, 0.2, 3, 300_000
_AGREE = 3  # matches of different key frames
# How much better than elsewhere the right place fits at least. Than nearer to where the poses say, it has to be more,
# and what is seen through counts against it: in a hall of 100 m with equal racks, the next bay fitted better by 0.08
# than the right one, which less of was seen; 0.038 of its points were seen through, and 0.011 of the right one's.
_RIVAL, _NEARER_RIVAL, _THROUGH_COUNTS = 0.04, 0.08, 2.0
_BESIDE_M, _BESIDE_RAD = 1.0, math.radians(3.0)  # where the poses say, about
_MOST_THROUGH = 0.1  # of what parts saw that are joined, so much may contradict
_LEAST_PART = 2  # key frames: what is seen from one place alone, such as a corner of a room, fits too many others
_LAST_EVERY = 8  # key frames that are compared with old ones at the end
_KEPT, _MOST_PENDING = 150, 100  # key frames, and matches
_FARTHEST_M = 60.0  # between matches that are compared: over more the odometry proves nothing
# Added to the covariance of a match [m², rad²]: no loop is surer.
_FLOOR = np.diag((0.02**2, 0.02**2, math.radians(0.25) ** 2))


@dataclass(frozen=True, slots=True)
class Loop:
    """A match of a key frame with an old submap.

    Attributes:
        a, b: The submap's middle node, and the key frame.
        transform: Pose of the key frame seen from the middle node.
        covariance: Covariance of the transform.
        fit: How well it fits, 0 to 1.
    """

    a: int
    b: int
    transform: Pose2D
    covariance: FloatArray
    fit: float


class LoopFinder:
    """Looks for loops from the newest key frames, and keeps those that are not proven yet."""

    def __init__(self, nodes: Nodes, submaps: Submaps) -> None:
        self._nodes = nodes
        self._submaps = submaps
        self._pending: list[Loop] = []
        self._tried: dict[int, int] = {}
        # What beams pass through, of each match that was asked for: those that wait are asked for again and again.
        self._passed: dict[tuple[int, int, tuple[float, float, float]], float] = {}

    def search(self, node: int, surface: Surface, cloud: Surface, *, tries: int = _FAR_TRIES) -> list[Loop]:
        """Return loops of a key frame that count from now on: near ones, and far ones that agree with others.

        Args:
            node: The key frame.
            surface: What it saw.
            cloud: What it and those before saw, seen from it.
            tries: The most far ones to try.
        """
        here, lengths = self._nodes.pose(node), self._submaps.lengths_from(node)
        near, far = [], []
        for index, submap in enumerate(self._submaps.all[:-1]):
            if submap.last > node - _APART and submap.part == self._nodes.parts[node]:
                continue
            length = lengths.get(index, math.inf)
            metres, radians = compute_drift(length)
            distance = here.distance_to(self._nodes.pose(submap.middle)) if length < math.inf else 0.0
            if distance > min(metres, _WIDEST_M) + _VIEW_M:
                continue
            if metres <= _NEAR_M and radians <= _NEAR_RAD:
                near.append((distance, index, metres, radians))
            else:
                far.append((self._tried.get(index, -1), distance, index, metres, radians))
        found = []
        for _, index, metres, radians in sorted(near)[:_NEAR_TRIES]:
            loop = self._match_near(node, surface, index, metres, radians)
            if loop is not None:
                found.append(loop)
        matches: list[Loop] = []
        for _, _, index, metres, radians in sorted(far)[:tries]:
            self._tried[index] = node
            matches += self._match_far(node, cloud, index, metres, radians)
        for loop in sorted(matches, key=lambda one: one.fit):
            proven = self._prove(loop)
            found += [one for one in proven if one not in found]
        return found

    def search_again(self) -> Iterator[Loop]:
        """Return near loops of one in eight of all key frames; each is to be added before the next one is asked for."""
        nodes = self._nodes
        known = {(a, b) for a, b, _ in nodes.edges}
        for node in range(0, len(nodes), _LAST_EVERY):
            surface = nodes.key_surface(node)
            if len(surface.points):
                found = self.search(node, surface, surface, tries=0)
                yield from (loop for loop in found if (loop.a, loop.b) not in known)

    def _match_near(self, node: int, surface: Surface, index: int, metres: float, radians: float) -> Loop | None:
        submap = self._submaps.all[index]
        predicted = self._submaps.seen_from_middle(submap, node)
        spread = np.diag(((0.5 * metres) ** 2, (0.5 * metres) ** 2, (0.5 * radians) ** 2))
        match = match_surface(self._submaps.surface(index).surface, surface, predicted, spread, (metres, radians))
        moved = match.pose.distance_to(predicted)
        if match.fit < _NEAR_FIT or moved > 1.2 * metres:
            return None
        return Loop(submap.middle, node, match.pose, match.covariance + _FLOOR, match.fit)

    def _match_far(self, node: int, cloud: Surface, index: int, metres: float, radians: float) -> list[Loop]:
        submap = self._submaps.all[index]
        known = self._submaps.surface(index)
        points = thin_out(cloud.points, _POINT_CELL_M, _POINTS)
        if len(points) < 20:
            return []
        rows, cols = known.table.shape
        width, height = cols * known.resolution, rows * known.resolution
        if metres == math.inf:
            window = (0.0, width, 0.0, height, -math.pi, math.pi - 1e-6)
        else:
            metres, radians = min(metres, _WIDEST_M), min(radians, math.pi - 1e-6)
            at = self._submaps.seen_from_middle(submap, node)
            x, y = at.x - known.corner[0], at.y - known.corner[1]
            window = (
                max(0.0, x - metres),
                min(width, x + metres),
                max(0.0, y - metres),
                min(height, y + metres),
                at.yaw - radians,
                at.yaw + radians,
            )
            if window[0] >= window[1] or window[2] >= window[3]:
                return []
        settings = np.array((_YAW_STEP, _LEAST_SCORE, _SHARE, _APART_M, _APART_RAD))
        allowed = np.ones_like(known.table)
        poses, _, _ = search_poses(
            known.table, allowed, known.resolution, points, np.array(window), settings, _MOST, _MOST_NODES
        )
        near = (0.1, math.radians(1.0))
        starts = [(Pose2D(x + known.corner[0], y + known.corner[1], yaw), near) for x, y, yaw in poses.tolist()]
        if starts and metres < math.inf:
            # Where the poses say may fit less than elsewhere, and be right: it is a rival of what is found.
            starts.append((self._submaps.seen_from_middle(submap, node), (min(metres, _BESIDE_M), _BESIDE_RAD)))
        loops: list[Loop] = []
        spread = np.diag((0.3**2, 0.3**2, math.radians(5.0) ** 2))
        for start, reach in starts:
            match = match_surface(known.surface, cloud, start, spread, reach)
            is_new = not any(_is_same(match.pose, one.transform) for one in loops)
            if match.fit >= _FAR_FIT and match.overlap >= _FAR_OVERLAP and is_new:
                loops.append(Loop(submap.middle, node, match.pose, match.covariance + _FLOOR, match.fit))
        return loops

    def _prove(self, loop: Loop) -> list[Loop]:
        """Return the loop and those that agree with it, if they are enough; keep it otherwise."""
        self._pending = [one for one in self._pending if one.b > loop.b - _KEPT][-_MOST_PENDING:]
        self._passed = {key: share for key, share in self._passed.items() if key[1] > loop.b - _KEPT}
        clique = self._clique(loop)
        self._pending.append(loop)
        if len(clique) < _AGREE or not self._beats_rivals(clique) or not self._is_possible(clique):
            return []
        self._pending = [one for one in self._pending if one not in clique]
        return clique

    def _clique(self, loop: Loop) -> list[Loop]:
        """Return a match, and those of other key frames that agree with it and with each other."""
        clique = [loop]
        for one in sorted(self._pending, key=lambda each: -each.fit):
            if all(one.b != other.b and self._agree(one, other) for other in clique):
                clique.append(one)
        return clique

    def _beats_rivals(self, clique: list[Loop]) -> bool:
        """Return whether no other place fits these key frames nearly as well: symmetric rooms have several."""
        nodes, moved, score = {one.b for one in clique}, self._moved_by(clique), None
        for one in self._pending:
            if one.b in nodes and one not in clique and not any(self._agree(one, other) for other in clique):
                rivals = self._clique(one)
                if len(rivals) < 2:
                    continue
                score = self._score(clique) if score is None else score
                margin = _NEARER_RIVAL if self._moved_by(rivals) < moved else _RIVAL
                if self._score(rivals) > score - margin:
                    return False
        return True

    def _score(self, loops: list[Loop]) -> float:
        """Return how well key frames fit in the mean, less what their beams pass through."""
        return sum(one.fit - _THROUGH_COUNTS * self._through(one) for one in loops) / len(loops)

    def _through(self, loop: Loop) -> float:
        key = loop.a, loop.b, loop.transform.as_tuple()
        if key not in self._passed:
            self._passed[key] = seen_through(self._nodes, self._submaps, loop.a, loop.b, loop.transform)
        return self._passed[key]

    def _moved_by(self, loops: list[Loop]) -> float:
        """Return how far from where the poses say key frames are matched, in the mean [m]; 0 in another part."""
        nodes = self._nodes
        if nodes.parts[loops[0].a] != nodes.parts[loops[0].b]:
            return 0.0
        places = [nodes.pose(one.a).inverse() @ nodes.pose(one.b) for one in loops]
        return sum(at.distance_to(one.transform) for at, one in zip(places, loops, strict=True)) / len(loops)

    def _is_possible(self, clique: list[Loop]) -> bool:
        """Return whether two parts can be joined like that: in a large building, unlike rooms may fit all too well."""
        nodes = self._nodes
        old = nodes.parts[clique[0].a]
        if old == nodes.parts[clique[0].b]:
            return True
        if nodes.parts.count(old) < _LEAST_PART:
            return False
        return sum(self._through(one) for one in clique) / len(clique) <= _MOST_THROUGH

    def _agree(self, first: Loop, second: Loop) -> bool:
        """Return whether the two matches close to nearly nothing with the way between their ends."""
        nodes, (a, b), (c, d) = self._nodes, (first.a, first.b), (second.a, second.b)
        if nodes.parts[a] != nodes.parts[c] or nodes.parts[b] != nodes.parts[d]:
            return False
        along = abs(nodes.travelled[a] - nodes.travelled[c]), abs(nodes.travelled[b] - nodes.travelled[d])
        if max(along) > _FARTHEST_M:
            return False
        metres, radians = compute_drift(sum(along))
        ends = nodes.poses
        one = chain(between(ends[a], ends[c]), second.transform.as_tuple())
        other = chain(first.transform.as_tuple(), between(ends[b], ends[d]))
        off = math.hypot(one[0] - other[0], one[1] - other[1])
        return off <= 0.15 + 0.5 * metres and abs(wrap_angle(one[2] - other[2])) <= 0.5 * radians

    def forget(self, node: int) -> None:
        """Forget what was found for a node that is removed."""
        self._pending = [one for one in self._pending if node not in (one.a, one.b)]


def _is_same(one: Pose2D, other: Pose2D) -> bool:
    return one.distance_to(other) <= _APART_M and abs(wrap_angle(one.yaw - other.yaw)) <= _APART_RAD


def between(a: FloatArray, b: FloatArray) -> tuple[float, float, float]:
    """Return pose b seen from a; many thousand a second, so without objects."""
    (ax, ay, at), (bx, by, bt) = a.tolist(), b.tolist()
    cos, sin, dx, dy = math.cos(at), math.sin(at), bx - ax, by - ay
    return cos * dx + sin * dy, cos * dy - sin * dx, bt - at


def chain(a: tuple[float, float, float], b: tuple[float, float, float]) -> tuple[float, float, float]:
    """Return pose b, seen from a, in the frame of a."""
    cos, sin = math.cos(a[2]), math.sin(a[2])
    return a[0] + cos * b[0] - sin * b[1], a[1] + sin * b[0] + cos * b[1], a[2] + b[2]


def compute_drift(length: float) -> tuple[float, float]:
    """Return how far a pose may be off after a drive of a length [m]: metres and radians, two standard deviations.

    Turns drift as a random walk; positions by a share of the length, and by the turns.
    """
    if length == math.inf:
        return math.inf, math.pi
    radians = math.radians(0.5 + 0.25 * math.sqrt(length))
    return 0.1 + 0.01 * length + 0.3 * length * radians, min(math.pi, radians)


_TOLERANCE_M, _TOLERANCE_SHARE = 0.3, 0.03  # so far behind a point a beam has to end
_ASIDE_RAD = math.radians(1.5)  # between a point and the beams beside it
_LIDARS_APART_M = 0.2
_COMPARED = 360  # points of a key frame: at least so many are compared, where there are as many
_COMPARED_FRAMES = 4  # key frames of a submap, likewise
_FEWEST = 100  # of what is compared, so many points are where the other place's beams reach


@dataclass(frozen=True, slots=True)
class _Beams:
    """Beams of one lidar: where they began (2,), and directions [rad] and lengths [m] in the order of directions."""

    origin: FloatArray
    bearings: FloatArray
    lengths: FloatArray


@dataclass(frozen=True, slots=True)
class _View:
    """A key frame: some of its points, seen from it, shape (N, 2), and the beams of each lidar."""

    points: FloatArray
    lidars: tuple[_Beams, ...]


def seen_through(nodes: Nodes, submaps: Submaps, a: int, b: int, transform: Pose2D) -> float:
    """Return the share of points that the other place's beams pass through, of those that they reach; 1 without any.

    Rooms that look alike fit each other, but not to the last thing in them: beams of one pass through what the other
    saw.

    In an office with six people, it was at most 0.11 for 9 right matches, and at least 0.10 for 52 wrong ones, of which
    48 were above 0.13.

    Args:
        nodes: The graph.
        submaps: Its submaps.
        a: The middle node of a submap.
        b: A key frame.
        transform: Pose of the key frame seen from the middle node.
    """
    submap, seen = submaps.all[submaps.of_node[a]], _view(nodes, b)
    reached = through = 0
    for node in range(submap.first, submap.last + 1, max(1, (submap.last + 1 - submap.first) // _COMPARED_FRAMES)):
        known = _view(nodes, node)
        T_node_b = submaps.seen_from_middle(submap, node).inverse() @ transform
        for viewer, other, pose in ((known, seen, T_node_b), (seen, known, T_node_b.inverse())):
            points = pose.transform_points(other.points)
            for beams in viewer.lidars:
                counts = _count(beams, points)
                reached, through = reached + counts[0], through + counts[1]
    return through / reached if reached >= _FEWEST else 1.0


def _view(nodes: Nodes, node: int) -> _View:
    """Return what a key frame saw; the points of one lidar come after those of another."""
    points, sensors = nodes.key_points(node)
    if not len(points):
        return _View(points, ())
    lidars = []
    apart = np.hypot(*np.diff(sensors, axis=0).T)
    for part in np.split(np.arange(len(points)), np.flatnonzero(apart > _LIDARS_APART_M) + 1):
        origin = sensors[part].mean(axis=0)
        bearings, lengths = _polar(points[part] - origin)
        order = np.argsort(bearings, kind="stable")
        lidars.append(_Beams(origin, bearings[order], lengths[order]))
    return _View(points[:: max(1, len(points) // _COMPARED)], tuple(lidars))


def _count(beams: _Beams, points: FloatArray) -> tuple[int, int]:
    """Return how many points the beams beside them reach, and through how many of these they pass."""
    bearings, lengths = _polar(points - beams.origin)
    index, count = np.searchsorted(beams.bearings, bearings), len(beams.bearings)
    sides = np.stack([(index - 1) % count, index % count])
    aside = np.abs(np.remainder(bearings - beams.bearings[sides] + math.pi, 2.0 * math.pi) - math.pi).min(axis=0)
    ends = beams.lengths[sides]
    reached = (aside < _ASIDE_RAD) & (lengths <= ends.max(axis=0) + _TOLERANCE_M)
    through = reached & (lengths < ends.min(axis=0) - _TOLERANCE_M - _TOLERANCE_SHARE * lengths)
    return int(reached.sum()), int(through.sum())


def _polar(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    return np.arctan2(points[:, 1], points[:, 0]), np.hypot(points[:, 0], points[:, 1])
