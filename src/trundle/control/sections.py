"""A path cut into sections: stretches between the places where a differential robot stops and turns in place."""

from __future__ import annotations

import bisect
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from trundle.geometry import FloatArray, integrate_twist, wrap_angle
from trundle.path import Path

_SAME_PLACE_M = 1e-6
_STRAIGHT_RAD = 1e-4
SECTION_DONE_M = 0.01
"""A section is done so near its end [m]."""
_PURSUIT_STEP_M = 0.05  # of the curve that an ideal robot drives

Motion = tuple[tuple[float, float, float], tuple[float, float, float]]
"""The first and the last pose (x, y, yaw) [m, m, rad] of a straight line or a turn in place, its yaw not wrapped."""


@dataclass(frozen=True, slots=True)
class Vertex:
    """A place on the path where its direction changes.

    Attributes:
        x, y: [m], map frame.
        turn: Angle to turn by there [rad], counter-clockwise, in the direction that the planner chose, so it may be
            beyond ±π.
        backward: Whether the robot drives on from there backwards.
    """

    x: float
    y: float
    turn: float
    backward: bool = False


class Section:
    """A polyline that is driven without stopping, and the turn in place at its end.

    Args:
        points: (x, y) [m] of its corners, map frame, at least two, no two neighbours at one place.
        end_turn: Angle [rad] to turn by at its end.
        backward: Whether it is driven backwards: its headings are where it leads, not where the robot looks.
    """

    __slots__ = ("backward", "end_turn", "headings", "length", "points", "starts")

    def __init__(self, points: Sequence[tuple[float, float]], end_turn: float, *, backward: bool = False) -> None:
        self.points = list(points)
        self.end_turn = end_turn
        self.backward = backward
        self.starts = [0.0]
        self.headings: list[float] = []
        for (x0, y0), (x1, y1) in zip(self.points, self.points[1:], strict=False):
            self.starts.append(self.starts[-1] + math.hypot(x1 - x0, y1 - y0))
            self.headings.append(math.atan2(y1 - y0, x1 - x0))
        self.length = self.starts[-1]

    def motions(self) -> list[Motion]:
        """Return the lines along it and the turn at its end, as a robot drives them."""
        turn = math.pi if self.backward else 0.0
        motions: list[Motion] = []
        for (x0, y0), (x1, y1), heading in zip(self.points, self.points[1:], self.headings, strict=False):
            motions.append(((x0, y0, heading + turn), (x1, y1, heading + turn)))
        end = motions[-1][1]
        return [*motions, turn_by(end, self.end_turn)]

    def point_at(self, s: float) -> tuple[float, float]:
        """Return the point (x, y) at arc length `s` [m]; past the end it goes on straight."""
        leg = self._leg_at(s)
        (x, y), heading, along = self.points[leg], self.headings[leg], s - self.starts[leg]
        return x + along * math.cos(heading), y + along * math.sin(heading)

    def heading_at(self, s: float) -> float:
        """Return the direction [rad] of the polyline at arc length `s` [m]."""
        return self.headings[self._leg_at(s)]

    def project(self, x: float, y: float, s: float, window: float) -> float:
        """Return the arc length [m] of the point nearest to (x, y) between `s` and `s + window`."""
        best, best_distance = s, math.inf
        for leg in range(self._leg_at(s), len(self.headings)):
            start, end = self.starts[leg], self.starts[leg + 1]
            if start > s + window:
                break
            (x0, y0), heading = self.points[leg], self.headings[leg]
            along = (x - x0) * math.cos(heading) + (y - y0) * math.sin(heading)
            along = min(max(start + along, start, s), end, s + window)
            px, py = self.point_at(along)
            distance = math.hypot(x - px, y - py)
            if distance < best_distance - 1e-12:
                best, best_distance = along, distance
        return best

    def travel_yaw(self, yaw: float) -> float:
        """Return the direction of travel [rad] of a robot with this yaw, and the yaw for a direction of travel."""
        return yaw + math.pi if self.backward else yaw

    def curvature(self, x: float, y: float, yaw: float, s: float, lookahead: float) -> tuple[float, float]:
        """Curvature [1/m] of the arc to the point `lookahead` ahead of arc length `s` [m], and the bearing [rad] to it.

        The arc begins at (x, y) [m], map frame, in the direction of travel `yaw` [rad].
        """
        carrot_x, carrot_y = self.point_at(s + lookahead)
        dx, dy = carrot_x - x, carrot_y - y
        cos, sin = math.cos(yaw), math.sin(yaw)
        ahead, left = cos * dx + sin * dy, cos * dy - sin * dx
        return 2.0 * left / max(dx * dx + dy * dy, 1e-6), math.atan2(left, ahead)

    def pursue(self, yaw: float, lookahead: float) -> tuple[FloatArray, list[float]]:
        """Drive it from its start by an ideal pure pursuit.

        Args:
            yaw: Direction of travel at the start [rad].
            lookahead: [m].

        Returns:
            Poses (x, y, yaw) of the robot, shape (N, 3), and how far along the section each is [m].
        """
        (x, y), s = self.points[0], 0.0
        poses: list[tuple[float, float, float]] = []
        along: list[float] = []
        for _ in range(int(1.5 * self.length / _PURSUIT_STEP_M) + 1):
            if self.length - s <= SECTION_DONE_M:
                break
            curvature = self.curvature(x, y, yaw, s, lookahead)[0]
            x, y, yaw = integrate_twist(x, y, yaw, 1.0, curvature, _PURSUIT_STEP_M)
            s = self.project(x, y, s, 2.0 * _PURSUIT_STEP_M)
            poses.append((x, y, self.travel_yaw(yaw)))
            along.append(s)
        return np.array(poses).reshape(-1, 3), along

    def _leg_at(self, s: float) -> int:
        return min(max(bisect.bisect_right(self.starts, s) - 1, 0), len(self.headings) - 1)


def turn_by(pose: tuple[float, float, float], turn: float) -> Motion:
    """Return a turn in place from a pose (x, y, yaw) by an angle [rad]."""
    x, y, yaw = pose
    return pose, (x, y, yaw + turn)


def path_vertices(path: Path) -> list[Vertex]:
    """Return places where a path starts, bends and ends, with the turn at each; straight stretches have none inside.

    The first vertex's turn is from the start's yaw to the first direction, the last one's from the last direction to
    the goal's yaw. A path that stays at one place is a single vertex.
    """
    poses: list[list[float]] = path.poses.tolist()
    driven_back: list[bool] = path.backward.tolist()
    places: list[list[float]] = []  # x, y, sum of the turns in place there
    backward: list[bool] = []  # of the leg there
    for i, (x, y, yaw) in enumerate(poses):
        if places and math.hypot(x - places[-1][0], y - places[-1][1]) <= _SAME_PLACE_M:
            places[-1][2] += wrap_angle(yaw - poses[i - 1][2])
        else:
            places.append([x, y, 0.0])
            backward.append(i > 0 and driven_back[i - 1])
    yaw = poses[0][2]
    last = len(places) - 1
    vertices: list[Vertex] = []
    for i, (x, y, turned) in enumerate(places):
        heading = poses[-1][2] if i == last else _robot_yaw(places[i], places[i + 1], backward=backward[i + 1])
        # The turns in place give the direction of rotation; the exact angle is from leg to leg.
        turn = turned + wrap_angle(heading - yaw - turned)
        cusp = 0 < i < last and backward[i] != backward[i + 1]
        if i in (0, last) or cusp or abs(turn) > _STRAIGHT_RAD:
            vertices.append(Vertex(x, y, turn, i < last and backward[i + 1]))
            yaw = heading
    return vertices


def _robot_yaw(here: Sequence[float], there: Sequence[float], *, backward: bool) -> float:
    """Return the yaw [rad] of a robot that drives straight from one place to the next."""
    heading = math.atan2(there[1] - here[1], there[0] - here[0])
    return heading + math.pi if backward else heading


def changes_direction(vertices: Sequence[Vertex], i: int) -> bool:
    """Return whether the robot changes between driving forward and backward at an inner vertex of the path."""
    return 0 < i < len(vertices) - 1 and vertices[i].backward != vertices[i - 1].backward


def cut_sections(vertices: Sequence[Vertex], stops: Sequence[bool]) -> list[Section]:
    """Join the vertices to sections that end where `stops` is true, where the direction changes, and at the end."""
    sections: list[Section] = []
    points = [(vertices[0].x, vertices[0].y)]
    for i, vertex in enumerate(vertices[1:], start=1):
        points.append((vertex.x, vertex.y))
        if stops[i] or changes_direction(vertices, i) or i == len(vertices) - 1:
            sections.append(Section(points, vertex.turn, backward=vertices[i - 1].backward))
            points = [points[-1]]
    return sections
