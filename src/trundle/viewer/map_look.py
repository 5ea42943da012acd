"""Geometry of a map's walls that is only drawn: dark tops, a dark foot, and the walls of maps that are one solid."""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray
from trundle.geometry.solids import Box, Color, OccupancyCells, Solid
from trundle.sim.mujoco.world_parts import GROUP_WORLD
from trundle.worlds.map_look import CAP_COLOR, FOOT_COLOR, DrawnSolid
from trundle.worlds.walls import merge_cells

GROUP_MARKS = 4
"""Geom group of what is drawn only; lines of sight ignore it."""

_CAP_M, _FOOT_M = 0.05, 0.07  # heights of the dark top and of the foot
_PROUD_M = 0.012  # how far both stand out from the wall
_NORMALS = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], dtype=np.float64)
_TANGENTS = np.roll(_NORMALS, 1, axis=1)
_SIDES, _WITH_TOP = 4, 5  # how many faces of a box are drawn: nobody sees those below


def add_edges(spec: mujoco.MjSpec, name: str, drawn: Sequence[DrawnSolid]) -> list[str]:
    """Add the edges of a map's solids, and the walls of those that are fields of cells; return the geoms' names.

    Args:
        spec: The model to add to.
        name: Beginning of the names.
        drawn: Solids, of which those of a map count.
    """
    added: list[str] = []
    caps: list[FloatArray] = []
    feet: list[FloatArray] = []
    for one in drawn:
        boxes = _boxes(one.solid)
        if not one.of_map or not len(boxes):
            continue
        if isinstance(one.solid.shape, OccupancyCells):
            added.append(_add_faces(spec, f"{name}:{one.solid.name}", [boxes], _WITH_TOP, one.solid.color, GROUP_WORLD))
        high = float(boxes[0, 5])
        feet.append(_between(boxes, 0.0, min(_FOOT_M, high)))
        if one.capped:
            caps.append(_between(boxes, high - min(_CAP_M, high), high + 0.1 * _PROUD_M))
    if caps:
        added.append(_add_faces(spec, f"{name}:tops", caps, _WITH_TOP, CAP_COLOR, GROUP_MARKS))
    if feet:
        added.append(_add_faces(spec, f"{name}:feet", feet, _SIDES, FOOT_COLOR, GROUP_MARKS))
    return added


def _boxes(solid: Solid) -> FloatArray:
    """Return boxes (x, y, half width, half depth, yaw, top) [m, rad] that a map's solid consists of, shape (N, 6)."""
    match solid.shape:
        case Box((width, depth, height)):
            x, y, _ = solid.pose.position
            return np.array([(x, y, width / 2.0, depth / 2.0, solid.pose.yaw(), height)])
        case OccupancyCells(blocked, resolution, height):
            found = merge_cells(blocked.view(np.uint8), most=blocked.size)
            if found is None:
                return np.zeros((0, 6))
            row, row_end, col, col_end = (resolution * edge.astype(np.float64) for edge in found[:4])
            middle = np.c_[(col + col_end) / 2.0, (row + row_end) / 2.0, np.zeros(len(row))]
            places = solid.pose.transform_points(middle)[:, :2]
            half = np.c_[(col_end - col) / 2.0, (row_end - row) / 2.0]
            return np.c_[places, half, np.full(len(row), solid.pose.yaw()), np.full(len(row), height)]
        case _:
            return np.zeros((0, 6))


def _between(boxes: FloatArray, low: float, high: float) -> FloatArray:
    """Return slightly wider boxes between two heights [m]: x, y, half width, half depth, yaw, low, high."""
    wider = boxes[:, :5].copy()
    wider[:, 2:4] += _PROUD_M
    return np.c_[wider, np.full(len(boxes), low), np.full(len(boxes), high)]


def _add_faces(
    spec: mujoco.MjSpec, name: str, boxes: Sequence[FloatArray], faces: int, color: Color, group: int
) -> str:
    """Add the first so many faces of boxes as one mesh, which renders faster than so many geoms."""
    parts = [part if part.shape[1] == 7 else np.insert(part, 5, 0.0, axis=1) for part in boxes]
    x, y, half_x, half_y, yaw, low, high = np.concatenate(parts).T
    half = np.c_[half_x, half_y, (high - low) / 2.0]
    middle = np.c_[x, y, (high + low) / 2.0]
    normals, across = _NORMALS[:faces], _TANGENTS[:faces]
    up = np.cross(normals, across)
    square = [normals - across - up, normals + across - up, normals + across + up, normals - across + up]
    corners = np.stack(square, axis=1)[None] * half[:, None, None, :]
    cos, sin = np.cos(yaw), np.sin(yaw)
    turn = np.zeros((len(x), 3, 3))
    turn[:, 0, 0], turn[:, 0, 1], turn[:, 1, 0], turn[:, 1, 1], turn[:, 2, 2] = cos, -sin, sin, cos, 1.0
    points = np.einsum("nij,nfkj->nfki", turn, corners) + middle[:, None, None, :]
    outward = np.broadcast_to(np.einsum("nij,fj->nfi", turn, normals)[:, :, None, :], points.shape)
    first = 4 * np.arange(len(x) * faces)[:, None]
    triangles: npt.NDArray[np.int64] = np.concatenate(
        [first + np.array([0, 1, 2]), first + np.array([0, 2, 3])], axis=1
    )
    mesh = spec.add_mesh(name=name, inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
    mesh.uservert, mesh.usernormal = points.ravel().tolist(), outward.ravel().tolist()
    mesh.userface = mesh.userfacenormal = triangles.ravel().tolist()
    spec.worldbody.add_geom(
        name=name,
        type=mujoco.mjtGeom.mjGEOM_MESH,
        meshname=name,
        rgba=color,
        contype=0,
        conaffinity=0,
        mass=0.0,
        group=group,
    )
    return name
