"""`scene_of`: a world, a robot and a map as the page draws them; robots have the same parts as in pictures."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.errors import WorldError
from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Box, Color, Cylinder, Mesh, OccupancyCells, Solid, Sphere, solids_bounds
from trundle.maps import OccupancyGrid
from trundle.page.encoding import grid_png, pack_array, rounded
from trundle.robots import Robot
from trundle.worlds import World
from trundle.worlds.map_look import DrawnSolid, drawn_solids, shown_bounds
from trundle.worlds.movers.crowd import each_body

_ACROSS_Y = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
_TYRE = [13, 13, 14, 255]
_STEEL = [158, 163, 168, 255]


def robot_of(robot: Robot) -> dict[str, Any]:
    """Return a robot: footprint, limits, wheels, lidars, and its visible parts in base_link.

    Without MuJoCo, as in Isaac Sim's own Python, the parts are a plain body and wheels.
    """
    try:
        from trundle.page.robot_parts import engine_parts
    except ImportError:
        parts = plain_parts(robot)
    else:
        parts = engine_parts(robot)
    limits = robot.limits
    return {
        "name": robot.name,
        "footprint": np.round(robot.outline, 4).tolist(),
        "height": robot.body.height,
        "limits": {
            "v": limits.linear_speed,
            "v_min": -(limits.linear_speed if limits.reverse_speed is None else limits.reverse_speed),
            "w": limits.angular_speed,
            "a": limits.linear_acceleration,
            "alpha": limits.angular_acceleration,
        },
        "wheel_radius": robot.drive.wheel_radius,
        "track": robot.drive.track_width,
        "parts": parts,
        "lidars": [
            {"name": name, "pose": rounded((lidar.x, lidar.y, lidar.z, lidar.yaw))}
            for name, lidar in robot.lidars.items()
        ],
    }


def plain_parts(robot: Robot) -> list[dict[str, Any]]:
    """Return the body as a prism of the footprint, and the wheels with a bar that shows how they turn."""
    drive = robot.drive
    radius, width = drive.wheel_radius, drive.wheel_width
    color = [round(255.0 * value) for value in robot.body.color]
    parts = [_prism(robot.outline, robot.body.clearance, robot.body.height, [*color, 255])]
    for wheel in drive.wheels:
        side = "left" if wheel.side > 0 else "right"
        at = (wheel.x, wheel.side * drive.track_width / 2.0, radius)
        bar = (1.2 * radius, 1.1 * width, 0.2 * radius)
        parts += [
            _part("cylinder", (*at, *_ACROSS_Y), (radius, radius, width), _TYRE, side),
            _part("box", (*at, 1.0, 0.0, 0.0, 0.0), bar, _STEEL, side),
        ]
    return parts


def _part(
    shape: str, pose: tuple[float, ...], size: tuple[float, ...], color: list[int], wheel: str | None
) -> dict[str, Any]:
    return {
        "shape": shape,
        "pose": rounded(pose, 5),
        "size": rounded(size, 5),
        "color": color,
        "wheel": wheel,
        "axis": None if wheel is None else [0, 1, 0],
    }


def _prism(outline: FloatArray, low: float, high: float, color: list[int]) -> dict[str, Any]:
    """Return a convex outline [m], counter-clockwise, from one height to another."""
    count = len(outline)
    vertices = np.vstack([np.c_[outline, np.full(count, z)] for z in (low, high)])
    triangles: list[tuple[int, int, int]] = []
    for i in range(count):
        j = (i + 1) % count
        triangles += [(i, j, count + j), (i, count + j, count + i)]
    for i in range(1, count - 1):
        triangles += [(0, i + 1, i), (count, count + i, count + i + 1)]
    size = tuple(np.ptp(vertices, axis=0).tolist())
    return {
        **_part("mesh", (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0), size, color, None),
        "vertices": pack_array(vertices, "f4"),
        "triangles": pack_array(np.array(triangles), "u4"),
    }


MOST_BYTES = 40_000_000
"""The largest scene, as it is sent."""

FLOOR_COLOR = (186, 188, 190, 255)

_MOST_COLORS = 40
"""Meshes are merged by colour; of more colours, the most alike are drawn as one."""

_AROUND_M = 5.0

MOST_BOXES = 40_000

WALL_WITH_TOP = 2.0
"""In an instance's "wall": a wall of a map, whose top is dark; 1 is another wall, 0 none."""


def scene_of(
    world: World | None,
    robot: Robot,
    grid: OccupancyGrid | None = None,
    *,
    most_bytes: int = MOST_BYTES,
) -> dict[str, Any]:
    """Return a world, a robot and a map as plain values; arrays are {"b64", "dtype", "shape"}.

    Solids that repeat a shape are instances of it, meshes are merged by colour: a world of any size takes few draw
    calls. Meshes that do not fit into `most_bytes`, the largest first, are drawn as their bounding boxes, and "note"
    says so.

    Args:
        world: The world. If None, only the map is drawn.
        robot: The robot.
        grid: The map. If None, no map is drawn.
        most_bytes: The most bytes for the solids.

    Raises:
        WorldError: If the scene is larger even so.
    """
    solids = () if world is None else world.solids
    instances, meshes, boxed = _draw(solids, most_bytes, "the world" if world is None else f"world {world.name!r}")
    note = f"{boxed} of {len(solids)} solids are drawn as boxes: their meshes are too large to send" if boxed else ""
    return {
        "name": "" if world is None else world.name,
        "bounds": _bounds(world, grid),
        "instances": instances,
        "meshes": meshes,
        "floor": {"color": list(FLOOR_COLOR)},
        "robot": robot_of(robot),
        "map": None if grid is None else grid_png(grid),
        "movers": [] if world is None else [_mover(name, parts) for name, parts in each_body(world.movers)],
        "note": note,
    }


def solid_instances(solids: Sequence[Solid]) -> list[dict[str, Any]]:
    """Return solids without meshes as instances, such as a box that is dropped into a run."""
    return _draw(solids, MOST_BYTES, "the world")[0]


def _draw(
    solids: Sequence[Solid], most_bytes: int, what: str
) -> tuple[list[dict[str, Any]], list[dict[str, Any]], int]:
    """Return instances, merged meshes, and how many solids are drawn as boxes instead of their meshes."""
    instances = _Instances()
    meshes: list[tuple[Solid, Mesh]] = []
    for drawn in drawn_solids(solids):
        if isinstance(drawn.solid.shape, Mesh):
            meshes.append((drawn.solid, drawn.solid.shape))
        else:
            instances.add(drawn)
    room = most_bytes * 3 // 4 - instances.size
    meshes.sort(key=lambda one: _size_of(one[1]))
    fits = np.cumsum([_size_of(mesh) for _, mesh in meshes]) <= room
    kept = int(fits.sum())
    if len(meshes) > kept:
        lows, highs = solids_bounds([solid for solid, _ in meshes[kept:]])
        for (solid, _), low, high in zip(meshes[kept:], lows, highs, strict=True):
            instances.add_box(solid, (low + high) / 2.0, np.maximum(high - low, 1e-3))
    if instances.size > most_bytes * 3 // 4:
        raise WorldError(
            f"{what} is too large to send: {len(solids)} solids take {instances.size * 4 / 3e6:.0f} MB, and the most "
            f"is {most_bytes / 1e6:.0f} MB; leave parts of it out with exclude"
        )
    return instances.packed(), _merge(meshes[:kept]), len(meshes) - kept


class _Instances:
    """Boxes, cylinders and spheres with their poses, sizes and colours."""

    def __init__(self) -> None:
        self._rows: dict[str, list[tuple[float, ...]]] = {"box": [], "cylinder": [], "sphere": []}
        self._colors: dict[str, list[tuple[int, ...]]] = {name: [] for name in self._rows}

    @property
    def size(self) -> int:
        """The arrays as bytes."""
        return 45 * sum(len(rows) for rows in self._rows.values())

    def add(self, drawn: DrawnSolid) -> None:
        """Add a solid that is no mesh."""
        solid = drawn.solid
        match solid.shape:
            case Box(size):
                self._add("box", solid, solid.pose, size, capped=drawn.capped)
            case Cylinder(radius, length):
                self._add("cylinder", solid, solid.pose, (radius, radius, length))
            case Sphere(radius):
                self._add("sphere", solid, solid.pose, (radius, radius, radius))
            case OccupancyCells() as cells:
                for x, y, width, depth in boxes_of(cells).tolist():
                    pose = solid.pose @ Pose3D((x, y, cells.height / 2.0))
                    self._add("box", solid, pose, (width, depth, cells.height), capped=drawn.capped)
            case Mesh():
                raise WorldError(f"the mesh {solid.name!r} is no box, cylinder or sphere")

    def add_box(self, solid: Solid, middle: FloatArray, size: FloatArray) -> None:
        """Add an upright box instead of a solid."""
        self._add("box", solid, Pose3D((float(middle[0]), float(middle[1]), float(middle[2]))), tuple(size.tolist()))

    def packed(self) -> list[dict[str, Any]]:
        """Return one entry for each shape that there is."""
        found: list[dict[str, Any]] = []
        for shape, rows in self._rows.items():
            if rows:
                table = np.array(rows)
                found.append(
                    {
                        "shape": shape,
                        "pose": pack_array(table[:, :7], "f4"),
                        "size": pack_array(table[:, 7:10], "f4"),
                        "color": pack_array(self._colors[shape], "u1"),
                        "wall": pack_array(table[:, 10], "u1"),
                    }
                )
        return found

    def _add(self, shape: str, solid: Solid, pose: Pose3D, size: Sequence[float], *, capped: bool = False) -> None:
        wall = WALL_WITH_TOP if capped else float(solid.kind == "wall" or isinstance(solid.shape, OccupancyCells))
        self._rows[shape].append((*pose.position, *pose.quaternion, *size, wall))
        self._colors[shape].append(color_bytes(solid.color))


def color_bytes(color: Color) -> tuple[int, int, int, int]:
    """Return red, green, blue and opacity from 0 to 255."""
    red, green, blue, alpha = (round(255.0 * min(1.0, max(0.0, value))) for value in color)
    return red, green, blue, alpha


def _size_of(mesh: Mesh) -> int:
    return 12 * (len(mesh.vertices) + len(mesh.faces))


def _merge(meshes: Sequence[tuple[Solid, Mesh]]) -> list[dict[str, Any]]:
    """Return meshes merged by colour, in the map frame."""
    groups: dict[tuple[int, ...], list[tuple[Solid, Mesh]]] = {}
    step = 1
    while True:
        groups.clear()
        for solid, mesh in meshes:
            color = tuple(min(255, round(value / step) * step) for value in color_bytes(solid.color))
            groups.setdefault(color, []).append((solid, mesh))
        if len(groups) <= _MOST_COLORS:
            break
        step *= 2
    return [_merged(color, members) for color, members in groups.items()]


def _merged(color: Sequence[int], members: Sequence[tuple[Solid, Mesh]]) -> dict[str, Any]:
    vertices: list[FloatArray] = []
    faces: list[npt.NDArray[np.int64]] = []
    count = 0
    for solid, mesh in members:
        vertices.append(solid.pose.transform_points(mesh.vertices))
        faces.append(mesh.faces.astype(np.int64) + count)
        count += len(mesh.vertices)
    return {
        "color": list(color),
        "vertices": pack_array(np.concatenate(vertices), "f4"),
        "triangles": pack_array(np.concatenate(faces), "u4"),
    }


def _mover(name: str, parts: Sequence[Solid]) -> dict[str, Any]:
    """Return a mover: its parts are in its own frame, x forward, origin on the floor."""
    instances, meshes, _ = _draw(parts, MOST_BYTES, f"the mover {name!r}")
    return {"name": name, "kind": parts[0].kind, "instances": instances, "meshes": meshes}


def _bounds(world: World | None, grid: OccupancyGrid | None) -> list[float]:
    """Return the lowest and highest corner [m] of what is drawn: the world, else the map, else some metres."""
    if world is not None and world.solids:
        low, high = shown_bounds(world.solids)
        return rounded([*low, *high])
    if grid is not None:
        rows, cols = grid.shape
        x, y = cols * grid.resolution, rows * grid.resolution
        corners = grid.origin.transform_points([(0.0, 0.0), (x, 0.0), (0.0, y), (x, y)])
        return rounded([*corners.min(axis=0), 0.0, *corners.max(axis=0), 1.0])
    return [-_AROUND_M, -_AROUND_M, 0.0, _AROUND_M, _AROUND_M, 1.0]


def boxes_of(cells: OccupancyCells) -> npt.NDArray[np.float64]:
    """Return boxes (x, y, width, depth) [m] in the frame of the cells, (x, y) the middle, that cover the blocked cells.

    Of a map that needs more than 40,000 boxes, cells are joined to larger ones until it does not.
    """
    blocked, edge = cells.blocked, cells.resolution
    while len(boxes := _rectangles(blocked)) > MOST_BOXES:
        blocked, edge = _halved(blocked), 2.0 * edge
    rows, cols, row_ends, col_ends = boxes.T * edge
    return np.c_[(cols + col_ends) / 2.0, (rows + row_ends) / 2.0, col_ends - cols, row_ends - rows]


def _rectangles(blocked: npt.NDArray[np.bool_]) -> npt.NDArray[np.int64]:
    """Join equal runs of blocked cells to disjoint rectangles (row, col, end of rows, end of columns)."""
    edges = np.diff(np.pad(blocked, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, starts = np.nonzero(edges == 1)
    ends = np.nonzero(edges == -1)[1]
    order = np.lexsort((rows, ends, starts))
    rows, starts, ends = rows[order], starts[order], ends[order]
    joined = np.zeros(len(rows), dtype=np.bool_)
    joined[1:] = (starts[1:] == starts[:-1]) & (ends[1:] == ends[:-1]) & (rows[1:] == rows[:-1] + 1)
    first = np.flatnonzero(~joined)
    last = np.append(first[1:], len(rows)) - 1 if len(first) else first
    return np.c_[rows[first], starts[first], rows[last] + 1, ends[first]]


def _halved(blocked: npt.NDArray[np.bool_]) -> npt.NDArray[np.bool_]:
    """Return cells of twice the size, blocked where one of the four is."""
    rows, cols = (math.ceil(count / 2) * 2 for count in blocked.shape)
    padded = np.zeros((rows, cols), dtype=np.bool_)
    padded[: blocked.shape[0], : blocked.shape[1]] = blocked
    return padded[::2, ::2] | padded[1::2, ::2] | padded[::2, 1::2] | padded[1::2, 1::2]
