"""From the corners of a way to the poses that the robot drives through, and the check that its footprint fits there."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np

from trundle.costmap import Costmap
from trundle.geometry import FloatArray, wrap_angle, wrap_angles

CHECK_STEP_M = 0.025
"""Distance [m] between two checked poses on a straight line."""

CHECK_STEP_RAD = math.radians(2.0)
"""Angle [rad] between two checked poses of a turn in place."""

_NO_TURN_RAD = 1e-9
_LONG_TURN_POSES = 4


@dataclass(frozen=True, slots=True)
class Motion:
    """A straight line from `start` to `end` at one yaw, or a turn in place by `turn` [rad], either way round.

    Attributes:
        start: (x, y) [m], map frame.
        end: (x, y) [m], map frame.
        yaw: At the start [rad].
        turn: Angle that is turned [rad], counter-clockwise positive; 0 for a line.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    yaw: float
    turn: float = 0.0

    def poses(self, step_m: float, step_rad: float) -> FloatArray:
        """Poses (x, y, yaw), shape (N, 3), at most a step apart, both ends included."""
        length = math.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1])
        pieces = max(1, math.ceil(length / step_m - 1e-9), math.ceil(abs(self.turn) / step_rad - 1e-9))
        t = np.linspace(0.0, 1.0, pieces + 1)
        poses = np.empty((pieces + 1, 3))
        poses[:, 0] = self.start[0] + t * (self.end[0] - self.start[0])
        poses[:, 1] = self.start[1] + t * (self.end[1] - self.start[1])
        poses[:, 2] = self.yaw + t * self.turn
        poses[-1, :2] = self.end
        return poses

    def other_way_round(self) -> Motion:
        """The same turn in the other direction."""
        return Motion(self.start, self.end, self.yaw, self.turn - math.copysign(2.0 * math.pi, self.turn))


def motions_along(vertices: FloatArray, start_yaw: float, goal_yaw: float | None) -> list[Motion]:
    """Lines between the vertices, with the turns between them and at both ends, each the short way round.

    Args:
        vertices: (x, y) [m], map frame, shape (N, 2), N ≥ 1.
        start_yaw: [rad].
        goal_yaw: [rad]; none means as the robot arrives.
    """
    motions: list[Motion] = []
    yaw = start_yaw
    points = [(float(x), float(y)) for x, y in vertices]
    for here, there in itertools.pairwise(points):
        if here == there:
            continue
        heading = math.atan2(there[1] - here[1], there[0] - here[0])
        _append_turn(motions, here, yaw, heading)
        motions.append(Motion(here, there, heading))
        yaw = heading
    if goal_yaw is not None:
        _append_turn(motions, points[-1], yaw, goal_yaw)
    return motions


def _append_turn(motions: list[Motion], place: tuple[float, float], yaw: float, heading: float) -> None:
    turn = wrap_angle(heading - yaw)
    if abs(turn) > _NO_TURN_RAD:
        motions.append(Motion(place, place, yaw, turn))


def fit_motions(costmap: Costmap, motions: list[Motion]) -> tuple[list[Motion], FloatArray, list[int]]:
    """Check motions with the oriented footprint, turning the other way round where the short way is blocked.

    Returns:
        The motions, the poses that collide (shape (K, 3)), and the index of the motion of each of them.
    """
    if not motions:
        return [], np.empty((0, 3)), []
    samples = [motion.poses(CHECK_STEP_M, CHECK_STEP_RAD) for motion in motions]
    owner = np.repeat(np.arange(len(motions)), [len(poses) for poses in samples])
    every = np.concatenate(samples)
    hit = costmap.footprint_collides(every)
    chosen = list(motions)
    for index in np.unique(owner[hit]).tolist():
        if motions[index].turn == 0.0:
            continue
        other = motions[index].other_way_round()
        if not costmap.footprint_collides(other.poses(CHECK_STEP_M, CHECK_STEP_RAD)).any():
            chosen[index] = other
            hit[owner == index] = False
    return chosen, every[hit], owner[hit].tolist()


def poses_of(motions: list[Motion], start: FloatArray, goal: FloatArray, spacing_m: float) -> FloatArray:
    """Poses of a `Path`: the vertices exactly, points between them at most `spacing_m` apart, long turns in pieces."""
    rows: list[FloatArray] = [start.reshape(1, 3)]
    for motion in motions:
        step_rad = abs(motion.turn) / _LONG_TURN_POSES if abs(motion.turn) > math.pi else math.pi
        rows.append(motion.poses(spacing_m, step_rad)[1:])
    rows[-1][-1] = goal
    if len(rows) == 1:
        rows.append(goal.reshape(1, 3))
    poses = np.concatenate(rows)
    poses[:, 2] = wrap_angles(poses[:, 2])
    poses[-1, 2] = goal[2]
    return poses
