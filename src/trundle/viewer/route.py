"""A path and a goal as marks on the floor."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D

PATH_COLOR = (0.05, 0.55, 0.95, 1.0)
DRIVEN_COLOR = (0.90, 0.36, 0.04, 1.0)
GOAL_COLOR = (0.10, 0.72, 0.35, 1.0)
PATH_RADIUS_M = 0.02
PATH_HEIGHT_M = 0.012
GOAL_HALF_HEIGHT_M = 0.004
_MAX_PIECES = 500
_BEND_RAD, _PIECE_M = 0.06, 2.0
_UPRIGHT = np.eye(3).ravel()


@dataclass(frozen=True, slots=True, eq=False)
class FloorLine:
    """A flat line on the floor, in straight pieces.

    Attributes:
        pieces: Ends (x, y) of each piece [m], map frame, shape (N, 2, 2).
        color: Red, green, blue, alpha, each 0..1.
        width: Its width [m].
        height: Its height above the floor [m]; the higher of two lines covers the other.
    """

    pieces: FloatArray
    color: tuple[float, float, float, float] = PATH_COLOR
    width: float = 0.06
    height: float = 0.006


def draw_line(scene: mujoco.MjvScene, line: FloorLine) -> None:
    """Add a line to a scene, as far as there is room."""
    color = np.array(line.color, dtype=np.float32)
    along = line.pieces[:, 1] - line.pieces[:, 0]
    lengths = np.hypot(along[:, 0], along[:, 1])
    middles = line.pieces.mean(axis=1)
    for (x, y), (dx, dy), length in zip(middles.tolist(), along.tolist(), lengths.tolist(), strict=True):
        geom = _next_geom(scene) if length > 0.0 else None
        if geom is None:
            continue
        # Longer by half its width at both ends, so that bends have no gap.
        size = np.array([(length + 0.5 * line.width) / 2.0, line.width / 2.0, 0.002])
        cos, sin = dx / length, dy / length
        turn = np.array([cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0])
        kind = mujoco.mjtGeom.mjGEOM_BOX.value
        mujoco.mjv_initGeom(geom, kind, size, np.array([x, y, line.height]), turn, color)
        geom.emission, geom.specular = 0.3, 0.0


def path_pieces(path: npt.ArrayLike) -> list[tuple[FloatArray, FloatArray]]:
    """Return the ends (x, y) [m] of the straight pieces of a path, at most 500 of them.

    Args:
        path: Waypoints [m], shape (N, 2) or more columns.

    Raises:
        InputError: If it is not a path.
    """
    points = np.asarray(path, dtype=np.float64)
    if points.ndim != 2 or points.shape[1] < 2 or not np.isfinite(points[:, :2]).all():
        raise InputError(f"a path to draw needs finite waypoints of shape (N, 2), got {points.shape}")
    points = _corners(points[:, :2])
    keep = np.linspace(0, len(points) - 1, min(len(points), _MAX_PIECES + 1)).round().astype(int)
    return list(itertools.pairwise(points[keep]))


def bends(poses: FloatArray) -> FloatArray:
    """Return those of driven poses [m, m, rad], shape (N, 3), between which the robot went about straight."""
    kept = [0]
    for row in range(1, len(poses) - 1):
        step = poses[row] - poses[kept[-1]]
        if abs(step[2]) > _BEND_RAD or np.hypot(step[0], step[1]) > _PIECE_M:
            kept.append(row)
    return poses[[*kept, len(poses) - 1]] if len(poses) > 1 else poses


def goal_radius(circumscribed_radius: float) -> float:
    """Return the radius [m] of the disc that marks a goal of a robot."""
    return max(0.08, 0.5 * circumscribed_radius)


def mark_route(scene: mujoco.MjvScene, path: npt.ArrayLike | None, goal: Pose2D | None, radius: float) -> None:
    """Replace the marks of a scene by those of a path and of a goal, each of which may be None.

    Args:
        scene: The scene whose geoms are the marks.
        path: Waypoints [m], map frame, shape (N, 2) or more columns.
        goal: Drawn as a disc.
        radius: Radius of that disc [m].
    """
    scene.ngeom = 0
    no_size, no_place = np.zeros(3), np.zeros(3)
    for start, end in [] if path is None else path_pieces(path):
        geom = _next_geom(scene)
        if geom is None:
            return
        kind = mujoco.mjtGeom.mjGEOM_CAPSULE.value
        mujoco.mjv_initGeom(geom, kind, no_size, no_place, _UPRIGHT, np.array(PATH_COLOR, dtype=np.float32))
        ends = np.append(start, PATH_HEIGHT_M), np.append(end, PATH_HEIGHT_M)
        mujoco.mjv_connector(geom, kind, PATH_RADIUS_M, *ends)
    geom = None if goal is None else _next_geom(scene)
    if goal is not None and geom is not None:
        size = np.array([radius, radius, GOAL_HALF_HEIGHT_M])
        place = np.array([goal.x, goal.y, 0.005])
        kind = mujoco.mjtGeom.mjGEOM_CYLINDER.value
        mujoco.mjv_initGeom(geom, kind, size, place, _UPRIGHT, np.array(GOAL_COLOR, dtype=np.float32))


def _next_geom(scene: mujoco.MjvScene) -> mujoco.MjvGeom | None:
    """Return the next geom of a scene, or None if it is full."""
    if scene.ngeom >= scene.maxgeom:
        return None
    scene.ngeom += 1
    return scene.geoms[scene.ngeom - 1]


def _corners(points: FloatArray) -> FloatArray:
    """Return points [m] of a line without repeated ones and those on a straight part, shape (N, 2)."""
    steps = np.diff(points, axis=0)
    moved = np.hypot(steps[:, 0], steps[:, 1]) > 1e-6
    points = np.concatenate([points[:1], points[1:][moved]])
    steps = np.diff(points, axis=0)
    before, after = steps[:-1], steps[1:]
    bent = np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]) > 1e-6 * np.hypot(*before.T)
    back = (before * after).sum(axis=1) < 0.0
    ends = np.ones(1, dtype=np.bool_)
    return points if len(points) < 3 else points[np.concatenate([ends, bent | back, ends])]
