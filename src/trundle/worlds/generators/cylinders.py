"""The `cylinders` generator: a walled lane full of thin posts, similar to the BARN worlds.

Posts are on a square grid. Its cells are filled at random and then smoothed by a cellular automaton, which makes
clusters with gaps between them: the method of Perille, Truong, Xiao and Stone, "Benchmarking Metric Ground Navigation"
(2020), with the posts of the BARN challenge (radius 0.075 m on a pitch of 0.15 m). These worlds resemble BARN's but are
not among its 300.
"""

from __future__ import annotations

import heapq
import math

import numpy as np
import numpy.typing as npt

from trundle.errors import WorldError
from trundle.geometry import FloatArray, Pose3D
from trundle.geometry.solids import Color, Cylinder, Solid
from trundle.worlds.generators.props import Part, box, place
from trundle.worlds.options import check_number, check_seed, check_whole
from trundle.worlds.world import World

RADIUS = 0.075  # of a post, as in the BARN worlds [m]
PITCH = 2.0 * RADIUS
RUN_IN = 2.0
"""Length of the free floor before and behind the posts [m]."""

_WALL = 0.15  # thickness [m]
_FILL_AT, _CLEAR_AT = 5, 1  # numbers of filled neighbours that fill and clear a cell
_GRAZE = 0.01  # [m]: the guaranteed path is wider by this on either side, for the rounding of maps
_WALL_COLOR: Color = (0.80, 0.81, 0.82, 1.0)
_BASE_COLOR: Color = (0.40, 0.45, 0.52, 1.0)

BoolArray = npt.NDArray[np.bool_]


def generate_cylinders(
    *,
    seed: int = 0,
    density: float = 0.2,
    smoothing: int = 3,
    length: float = 10.0,
    width: float = 4.5,
    passable_radius: float = 0.5,
    height: float = 0.8,
) -> World:
    """Generate a walled lane along x, with posts between its free ends.

    The field of posts spans x = 0 to x = `length`, y about 0; RUN_IN of free floor lies before and behind it. The
    seed point is in the middle of the free floor at the west end, and a mission goes to (length + 1, 0).

    Args:
        seed: The same seed and options make the same world.
        density: Share of cells that are filled before smoothing, 0 to 0.4.
        smoothing: Steps of the automaton, 0 (posts scattered evenly) to 10.
        length: Length of the field [m], 2 to 100.
        width: Between the side walls [m], 1 to 50.
        passable_radius: A disc of this radius [m] can pass from the west end to the east end: if it could not, posts
            are removed, as few as the search finds. 0 gives no guarantee: the lane may be blocked.
        height: Height of the posts [m], 0.2 to 5.

    Raises:
        WorldError: If a value is out of range, or the lane is too narrow for the passable radius.
    """
    rng = np.random.default_rng(check_seed("cylinders", seed))
    density = check_number("cylinders", "density", density, 0.0, 0.4)
    smoothing = check_whole("cylinders", "smoothing", smoothing, 0, 10)
    length = check_number("cylinders", "length", length, 2.0, 100.0)
    width = check_number("cylinders", "width", width, 1.0, 50.0)
    radius = check_number("cylinders", "passable_radius", passable_radius, 0.0, 5.0)
    height = check_number("cylinders", "height", height, 0.2, 5.0)
    if 2.0 * (radius + _GRAZE) > width - PITCH:
        raise WorldError(
            f"cylinders: a lane of {width:g} m is too narrow for a disc of radius {radius:g} m; make width at least "
            f"{2.0 * (radius + _GRAZE) + PITCH:.2f} m, or passable_radius smaller"
        )
    rows, columns = int(width / PITCH), int(length / PITCH)
    filled = _smooth(rng.random((rows, columns)) < density, smoothing)
    if radius > 0.0:
        filled = _open_passage(filled, radius + _GRAZE, width)
    solids = _walls(length, width, height)
    row, col = np.nonzero(filled)
    for number, (x, y) in enumerate(_centres(row, col, rows).tolist(), start=1):
        pose = Pose3D((x, y, height / 2.0))
        solids.append(Solid(f"post_{number}", Cylinder(RADIUS, height), pose, _color(x / length), "post"))
    return World("cylinders", tuple(solids), ((-RUN_IN / 2.0, 0.0),))


def _smooth(filled: BoolArray, steps: int) -> BoolArray:
    """Fill cells with many filled neighbours out of eight, and clear those with hardly any."""
    for _ in range(steps):
        padded = np.pad(filled, 1).astype(np.int8)
        rows, columns = filled.shape
        around = sum(padded[i : i + rows, j : j + columns] for i in range(3) for j in range(3)) - filled
        filled = (filled | (around >= _FILL_AT)) & (around > _CLEAR_AT)
    return filled


def _centres(row: npt.NDArray[np.int64], col: npt.NDArray[np.int64], rows: int) -> FloatArray:
    """Return centres of cells [m], shape (N, 2)."""
    return np.column_stack([(col + 0.5) * PITCH, (row + 0.5 - rows / 2.0) * PITCH]).astype(np.float64)


def _open_passage(filled: BoolArray, radius: float, width: float) -> BoolArray:
    """Remove posts so that a disc can pass from the west end to the east end.

    Dijkstra's search finds the path over cell centres with the fewest posts near it. Its cost counts a post once for
    every cell of the path near it, so the number of removed posts may not be the minimum.
    """
    rows, columns = filled.shape
    reach = radius + RADIUS
    across = np.abs((np.arange(rows) + 0.5 - rows / 2.0) * PITCH)
    inside = np.broadcast_to((across <= width / 2.0 - radius)[:, None], filled.shape)
    # The middle of a step is half a step from its ends, so the radius grows by that much.
    disc = _disc(math.hypot(reach, PITCH / math.sqrt(2.0)))
    near = _count_near(filled, disc)
    path = _cheapest_path(np.where(inside, 1.0 + 100.0 * near, np.inf))
    keep_out = np.zeros((rows, columns), dtype=np.bool_)
    keep_out[tuple(np.transpose(path))] = True
    return filled & (_count_near(keep_out, disc) == 0)


def _disc(reach: float) -> list[tuple[int, int]]:
    """Return offsets (rows, columns) of the cells whose centres are nearer than `reach` [m]."""
    most = int(reach / PITCH)
    steps = range(-most, most + 1)
    return [(i, j) for i in steps for j in steps if math.hypot(i, j) * PITCH < reach]


def _count_near(cells: BoolArray, disc: list[tuple[int, int]]) -> npt.NDArray[np.int64]:
    rows, columns = cells.shape
    most = max(i for i, _ in disc)
    padded = np.pad(cells, most).astype(np.int64)
    count = np.zeros((rows, columns), dtype=np.int64)
    for i, j in disc:
        count += padded[most + i : most + i + rows, most + j : most + j + columns]
    return count


def _cheapest_path(costs: FloatArray) -> list[tuple[int, int]]:
    """Find the cheapest path from the first column to the last, as cells (row, column).

    It is 8-connected; a step costs its length times the cost of its cell.
    """
    rows, columns = costs.shape
    best = np.full(costs.shape, np.inf)
    best[:, 0] = costs[:, 0]
    before: dict[tuple[int, int], tuple[int, int]] = {}
    queue = [(float(costs[row, 0]), row, 0) for row in range(rows) if math.isfinite(costs[row, 0])]
    heapq.heapify(queue)
    while queue:
        cost, row, col = heapq.heappop(queue)
        if cost > best[row, col]:
            continue
        if col == columns - 1:
            path = [(row, col)]
            while path[-1] in before:
                path.append(before[path[-1]])
            return path
        for i in (-1, 0, 1):
            for j in (-1, 0, 1):
                to = (row + i, col + j)
                if not (0 <= to[0] < rows and 0 <= to[1] < columns):
                    continue
                total = cost + math.hypot(i, j) * float(costs[to])
                if total < best[to]:
                    best[to] = total
                    before[to] = (row, col)
                    heapq.heappush(queue, (total, *to))
    raise WorldError("cylinders: the lane is too narrow for passable_radius; make it smaller")


def _walls(length: float, width: float, height: float) -> list[Solid]:
    base = 0.35 * height
    whole = length + 2.0 * RUN_IN
    parts: list[Part] = []
    for name, x, y, size in (
        ("north", length / 2.0, (width + _WALL) / 2.0, (whole + 2.0 * _WALL, _WALL)),
        ("south", length / 2.0, -(width + _WALL) / 2.0, (whole + 2.0 * _WALL, _WALL)),
        ("west", -RUN_IN - _WALL / 2.0, 0.0, (_WALL, width)),
        ("east", length + RUN_IN + _WALL / 2.0, 0.0, (_WALL, width)),
    ):
        parts.append(box(f"{name}_base", (*size, base), (x, y, base / 2.0), _BASE_COLOR, "wall"))
        parts.append(box(name, (*size, height - base), (x, y, (height + base) / 2.0), _WALL_COLOR, "wall"))
    return place(parts, "wall", 0.0, 0.0, 0.0)


def _color(along: float) -> Color:
    """Return a colour from ochre in the west to blue in the east: pictures show how far the robot got."""
    stops = np.array([(0.85, 0.52, 0.20), (0.72, 0.36, 0.40), (0.22, 0.38, 0.62)])
    red, green, blue = (float(np.interp(along, (0.0, 0.5, 1.0), channel)) for channel in stops.T)
    return (red, green, blue, 1.0)
