"""How the members of a crowd react to others: the forces of the social force model, and the rules that override them.

The model is that of Helbing and Molnár, Social Force Model for Pedestrian Dynamics, Phys. Rev. E 51 (1995). Whatever
its forces push them to, members do not run into each other, or into a robot that they see.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray
from trundle.worlds.movers.walk import RobotMotion

# How near those who see the robot come to it [m], and to the line that it drives in the next seconds [s]: more holds
# them up far from its path, less lets them touch it before either has braked.
MARGIN_M, _LOOK_S = 0.5, 1.5
# Kept from the robot's circle by what turns beside it [m]: the tail of a forklift swings out where its middle stands.
_SWING_MARGIN = 0.1

# The parameters of the paper, by its symbols.
TAU_S = 0.5  # relaxation time tau
_SOCIAL, _SOCIAL_M = 2.1, 0.3  # V0 [m²/s²] and sigma
_BORDER, _BORDER_M = 10.0, 0.2  # U0 [m²/s²] and R
_STEP_S = 2.0  # time of another's step, delta t
_SEEN = math.cos(math.radians(100.0))  # half of the angle of sight, 2 phi = 200°
_UNSEEN = 0.5  # c: share of a force from behind
_PEDESTRIAN_M = 0.3
"""Radius of the model's pedestrians; distances to what is wider are shortened by how much it is."""


def driving(velocities: FloatArray, directions: FloatArray, speeds: FloatArray) -> FloatArray:
    """Return the accelerations towards the preferred velocities (equation 2) [m/s²], shape (N, 2)."""
    return (speeds[:, None] * directions - velocities) / TAU_S


def repulsion(
    points: FloatArray,
    radii: FloatArray,
    directions: FloatArray,
    others: FloatArray,
    other_velocities: FloatArray,
    other_radii: FloatArray,
) -> FloatArray:
    """Return the forces away from others, by the elliptical potential that lies ahead of each (equations 3, 4 and 7).

    Args:
        points: Positions of the members [m], shape (N, 2).
        radii: Their radii [m], shape (N,).
        directions: Unit vectors towards where they want to go, shape (N, 2).
        others: Positions of all others [m], shape (M, 2); one at the same point has no effect.
        other_velocities: Their velocities [m/s], shape (M, 2).
        other_radii: Their radii [m], shape (M,).

    Returns:
        The forces of each on each [m/s²], shape (N, M, 2).
    """
    apart = points[:, None] - others
    distance = np.sqrt((apart**2).sum(axis=2))
    step = other_velocities * _STEP_S
    beyond = apart - step
    reached = np.sqrt((beyond**2).sum(axis=2))
    whole = distance + reached
    minor = np.sqrt(np.maximum(whole**2 - (step**2).sum(axis=1), 1e-6)) / 2.0
    wide = np.maximum(0.0, radii[:, None] + other_radii - 2.0 * _PEDESTRIAN_M)
    strength = _SOCIAL / _SOCIAL_M * np.exp(-np.maximum(0.0, minor - wide) / _SOCIAL_M)
    strength *= whole / (4.0 * minor)
    away = apart / np.maximum(distance, 1e-9)[..., None] + beyond / np.maximum(reached, 1e-9)[..., None]
    forces = np.minimum(strength, 1e3)[..., None] * away
    forces[distance < 1e-9] = 0.0
    # A force from behind counts less: the one who makes it is not seen.
    ahead = -(forces * directions[:, None]).sum(axis=2) >= _SEEN * np.sqrt((forces**2).sum(axis=2))
    return forces * np.where(ahead, 1.0, _UNSEEN)[..., None]


def border_force(distances: FloatArray, away: FloatArray, radii: FloatArray) -> FloatArray:
    """Return the forces away from the nearest solid (equation 5) [m/s²], shape (N, 2).

    Args:
        distances: Distances of the members from it [m], shape (N,).
        away: Unit vectors away from it, shape (N, 2).
        radii: Radii of the members [m], shape (N,).
    """
    gap = np.maximum(0.0, distances - (radii - _PEDESTRIAN_M))
    return (_BORDER / _BORDER_M * np.exp(-gap / _BORDER_M))[:, None] * away


def give_way(
    points: FloatArray,
    velocities: FloatArray,
    radii: FloatArray,
    sees: npt.NDArray[np.bool_],
    robot: RobotMotion,
    dt: float,
) -> FloatArray:
    """Return velocities without what leads into the robot, or into where it is about to be [m/s], shape (N, 2).

    Around the straight line that the robot drives in the next 1.5 s nobody comes nearer than 0.5 m; who is nearer
    already does not approach it.
    """
    start, along = np.array([robot.x, robot.y]), np.array([robot.vx, robot.vy]) * _LOOK_S
    away, _ = _from_line(points, start, along)
    inward = np.minimum(0.0, (velocities * away).sum(axis=1))
    stops = sees & enters_path(points, points + velocities * dt, radii, robot)
    return np.where(stops[:, None], velocities - inward[:, None] * away, velocities)


def enters_path(
    points: FloatArray, reached: FloatArray, radii: FloatArray, robot: RobotMotion
) -> npt.NDArray[np.bool_]:
    """Return which members would come too near to the robot, or to where it is about to be; shape (N,)."""
    start, along = np.array([robot.x, robot.y]), np.array([robot.vx, robot.vy]) * _LOOK_S
    _, gap = _from_line(points, start, along)
    _, then = _from_line(reached, start, along)
    return (then < radii + robot.radius + MARGIN_M) & (then < gap - 1e-12)


def swings_into(
    points: FloatArray, yaws: FloatArray, turned: FloatArray, outlines: Sequence[FloatArray], robot: RobotMotion
) -> npt.NDArray[np.bool_]:
    """Return which members' bodies would come too near to the robot by turning; shape (N,).

    Beside a robot that is within its turning circle, a turn away from the middle may still meet a corner: none is made.

    Args:
        points: Positions of the members [m], shape (N, 2).
        yaws: Their yaws [rad], shape (N,).
        turned: The yaws that they would have [rad], shape (N,).
        outlines: The outline of each one's body in its frame [m].
        robot: The robot.
    """
    return np.array(
        [
            after < robot.radius + _SWING_MARGIN and (after < before or before < robot.radius)
            for point, outline, angles in zip(points, outlines, np.column_stack([yaws, turned]).tolist(), strict=True)
            for before, after in [[_from_outline(outline, point, angle, robot) for angle in angles]]
        ],
        dtype=bool,
    )


def _from_outline(outline: FloatArray, point: FloatArray, yaw: float, robot: RobotMotion) -> float:
    """Return the distance of the robot's centre from an outline at a place [m], 0 inside."""
    cos, sin = math.cos(yaw), math.sin(yaw)
    x, y = np.array([[cos, sin], [-sin, cos]]) @ (np.array([robot.x, robot.y]) - point)
    along = np.roll(outline, -1, axis=0) - outline
    offset = np.array([x, y]) - outline
    if (along[:, 0] * offset[:, 1] >= along[:, 1] * offset[:, 0]).all():
        return 0.0
    share = np.clip((offset * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    return float(np.hypot(*(offset - share[:, None] * along).T).min())


def _from_line(points: FloatArray, start: FloatArray, along: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return directions from a straight line to points, and their distances from it [m]."""
    share = np.clip((points - start) @ along / max(float(along @ along), 1e-12), 0.0, 1.0)
    offset = points - (start + share[:, None] * along)
    distance = np.hypot(offset[:, 0], offset[:, 1])
    return offset / np.maximum(distance, 1e-9)[:, None], distance


def keep_apart(points: FloatArray, reached: FloatArray, others: FloatArray, radii: FloatArray) -> FloatArray:
    """Return where members get without overlapping others [m]: past the one in the way, or nowhere.

    Args:
        points: Positions of the members [m], shape (N, 2).
        reached: Positions that they would reach [m], shape (N, 2).
        others: Positions of the members and of all others [m], shape (M, 2), the members first.
        radii: Radii of all of these [m], shape (M,).
    """
    count = len(points)
    least = radii[:count, None] + radii
    offset = points[:, None] - others
    now = np.sqrt((offset**2).sum(axis=2))
    away = offset / np.maximum(now, 1e-9)[..., None]
    slid = False
    for _ in range(3):
        closer = _approaches(reached, np.vstack([reached, others[count:]]), now, least)
        closer |= _approaches(reached, others, now, least)
        stopped = np.asarray(closer.any(axis=1))
        if not stopped.any():
            break
        if not slid:  # Past the nearest one in the way; then those who still approach someone stay.
            nearest = np.where(closer, now - least, np.inf).argmin(axis=1)
            direction = away[np.arange(count), nearest]
            inward = np.minimum(0.0, ((reached - points) * direction).sum(axis=1))
            reached = np.where(stopped[:, None], reached - inward[:, None] * direction, reached)
            slid = True
        else:
            reached = np.where(stopped[:, None], points, reached)
    return reached


def _approaches(reached: FloatArray, others: FloatArray, now: FloatArray, least: FloatArray) -> npt.NDArray[np.bool_]:
    """Return which members would overlap which others, and be nearer to them than now; shape (N, M)."""
    offset = reached[:, None] - others
    then = np.sqrt((offset**2).sum(axis=2))
    overlap = (then < least) & (then < now - 1e-12)
    np.fill_diagonal(overlap, False)
    return overlap
