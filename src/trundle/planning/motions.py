"""Motions and poses of the robot along the vertices of a path, and the collision check of its footprint."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.costmap import Costmap
from trundle.geometry import FloatArray, wrap_angle, wrap_angles

CHECK_STEP_M = 0.025
"""Distance [m] between two poses of a straight line at which collisions are located: half a cell of a map of 5 cm."""

CHECK_STEP_RAD = math.radians(2.0)
"""Angle [rad] between two poses of a turn in place at which collisions are checked."""

_NO_TURN_RAD = 1e-9  # less is rounding
_LONGEST_TURN_RAD = math.radians(120.0)
"""A turn in a path is split into pieces below half a turn, so that its direction is unambiguous."""


@dataclass(frozen=True, slots=True)
class Motion:
    """A straight line from `start` to `end` at one yaw, or a turn in place by `turn` [rad], in either direction.

    Attributes:
        start: (x, y) [m], map frame.
        end: (x, y) [m], map frame.
        yaw: Yaw at the start [rad].
        turn: Angle that is turned [rad], counter-clockwise positive; 0 for a line.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    yaw: float
    turn: float = 0.0

    def opposite_turn(self) -> Motion:
        """Return the same turn in the other direction."""
        return Motion(self.start, self.end, self.yaw, self.turn - math.copysign(2.0 * math.pi, self.turn))


def motions_along(vertices: FloatArray, start_yaw: float, goal_yaw: float | None) -> list[Motion]:
    """Return lines between the vertices, with the turns at them and at both ends, each in the shorter direction.

    Args:
        vertices: (x, y) [m], map frame, shape (N, 2), N ≥ 1.
        start_yaw: [rad].
        goal_yaw: [rad]. If None, the yaw of arrival.
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


def sample(
    motions: Sequence[Motion], step_m: float, step_rad: float
) -> tuple[FloatArray, npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Return poses along motions, at most a step apart, both ends of each included.

    Returns:
        The poses (x, y, yaw), shape (N, 3), the motion that each belongs to, and how many each motion has.
    """
    return sample_between(*_ends_of(motions), step_m, step_rad)


def _ends_of(motions: Sequence[Motion]) -> tuple[FloatArray, FloatArray]:
    """Return first and last poses (x, y, yaw) of motions, shape (N, 3)."""
    first = np.array([(*motion.start, motion.yaw) for motion in motions]).reshape(-1, 3)
    last = np.array([(*motion.end, motion.yaw + motion.turn) for motion in motions]).reshape(-1, 3)
    return first, last


def sample_between(
    first: FloatArray, last: FloatArray, step_m: float, step_rad: float
) -> tuple[FloatArray, npt.NDArray[np.intp], npt.NDArray[np.intp]]:
    """Return poses along straight motions from each of `first` to each of `last`, shape (M, 3), as `sample` does."""
    change = last - first
    lengths = np.hypot(change[:, 0], change[:, 1])
    pieces = np.ceil(np.maximum(lengths / step_m, np.abs(change[:, 2]) / step_rad) - 1e-9)
    counts = np.maximum(pieces, 1.0).astype(np.intp) + 1
    owner = np.repeat(np.arange(len(first)), counts)
    ends = np.cumsum(counts)
    position = np.arange(ends[-1]) - np.repeat(ends - counts, counts)
    poses = first[owner] + (position / (counts[owner] - 1))[:, np.newaxis] * change[owner]
    poses[ends - 1] = last
    return poses, owner, counts


def fit_motions(costmap: Costmap, motions: list[Motion]) -> tuple[list[Motion], FloatArray, list[int]]:
    """Check all that the footprint sweeps over; turn in the other direction where the shorter one is blocked.

    Returns:
        The motions, poses where they are blocked (shape (K, 3)), and the index of the motion of each of them. Of each
        blocked motion those are the poses every 0.025 m and 2° that collide, or else the one up to which it is free.
    """
    if not motions:
        return [], np.empty((0, 3)), []
    shares = _free_shares(costmap, motions)
    chosen = list(motions)
    blocked: list[int] = []
    for index in np.flatnonzero(shares < math.inf).tolist():
        other = motions[index].opposite_turn() if motions[index].turn != 0.0 else None
        if other is not None and _free_shares(costmap, [other])[0] == math.inf:
            chosen[index] = other
        else:
            blocked.append(index)
    if not blocked:
        return chosen, np.empty((0, 3)), []
    first, last = _ends_of([motions[index] for index in blocked])
    poses, owner, _ = sample_between(first, last, CHECK_STEP_M, CHECK_STEP_RAD)
    colliding = costmap.footprint_collides(poses)
    free = np.bincount(owner[colliding], minlength=len(blocked)) == 0
    touching = (first + shares[blocked][:, np.newaxis] * (last - first))[free]
    hits, owners = (
        np.concatenate([poses[colliding], touching]),
        np.concatenate([owner[colliding], np.flatnonzero(free)]),
    )
    order = np.argsort(owners, kind="stable")
    return chosen, hits[order], [blocked[index] for index in owners[order].tolist()]


def _free_shares(costmap: Costmap, motions: Sequence[Motion]) -> FloatArray:
    first, last = _ends_of(motions)
    return costmap.footprint_sweeps(first, last)


def motions_before(costmap: Costmap, motions: list[Motion]) -> list[Motion]:
    """Return the part of the motions before the footprint first collides."""
    shares = _free_shares(costmap, motions)
    if not (shares < math.inf).any():
        return motions
    index = int(np.argmax(shares < math.inf))
    kept, line = motions[:index], motions[index]
    if line.turn == 0.0:
        # Stop before the contact.
        share = float(shares[index]) - CHECK_STEP_M / math.dist(line.start, line.end)
        if share > 0.0:
            end = tuple(a + share * (b - a) for a, b in zip(line.start, line.end, strict=True))
            kept.append(Motion(line.start, (end[0], end[1]), line.yaw))
    while kept and kept[-1].turn != 0.0:  # nothing is driven after that turn
        kept.pop()
    return kept


def poses_of(motions: list[Motion], start: FloatArray, goal: FloatArray, spacing_m: float) -> FloatArray:
    """Return poses of a `Path`: the vertices, points between them at most `spacing_m` apart, long turns in pieces."""
    if not motions:
        return np.stack([start, goal])
    poses, _, counts = sample(motions, spacing_m, _LONGEST_TURN_RAD)
    # A motion begins where the one before it ended; the first one where the path does.
    keep = np.ones(len(poses), dtype=np.bool_)
    keep[np.cumsum(counts) - counts] = False
    poses = np.concatenate([start.reshape(1, 3), poses[keep]])
    poses[:, 2] = wrap_angles(poses[:, 2])
    poses[0], poses[-1] = start, goal
    return poses
