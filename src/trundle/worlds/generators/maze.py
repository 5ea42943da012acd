"""The `maze` generator: a perfect maze on square cells, with optional loops."""

from __future__ import annotations

import itertools

import numpy as np
import numpy.typing as npt

from trundle.errors import WorldError
from trundle.geometry.solids import Color, Solid
from trundle.worlds.generators.props import Part, box, place
from trundle.worlds.options import check_number, check_seed, check_whole
from trundle.worlds.world import World

NARROWEST = 0.3
"""Least clear width of a passage [m]."""

_WALL: Color = (0.90, 0.90, 0.88, 1.0)
_RIM: Color = (0.36, 0.42, 0.48, 1.0)
_CAP: Color = (0.80, 0.25, 0.20, 1.0)
_CAP_HEIGHT = 0.06  # [m]

BoolArray = npt.NDArray[np.bool_]


def generate_maze(
    *,
    seed: int = 0,
    rows: int = 6,
    columns: int = 9,
    cell: float = 2.2,
    loops: float = 0.0,
    wall_thickness: float = 0.15,
    wall_height: float = 1.0,
) -> World:
    """Generate a maze: exactly one path joins any two cells, or more with `loops`.

    The passages are cut by a depth-first walk with random turns (recursive backtracking), which makes them long and
    winding. The maze is centred on the origin; the seed point is the middle of its south-west cell.

    Args:
        seed: The same seed and options make the same maze.
        rows: Cells along y, 1 to 80.
        columns: Cells along x, 1 to 80; at least two cells in all.
        cell: Distance between wall centres [m], up to 20; passages are narrower by the wall thickness.
        loops: Share of inner walls that are removed, 0 (a perfect maze) to 1 (an empty hall).
        wall_thickness: Thickness of the walls [m], 0.02 to 2.
        wall_height: Height of the walls [m], 0.2 to 10.

    Raises:
        WorldError: If a value is out of range, or the passages would be narrower than 0.3 m.
    """
    seed = check_seed("maze", seed)
    rows = check_whole("maze", "rows", rows, 1, 80)
    columns = check_whole("maze", "columns", columns, 1, 80)
    cell = check_number("maze", "cell", cell, 0.3, 20.0)
    loops = check_number("maze", "loops", loops, 0.0, 1.0)
    thick = check_number("maze", "wall_thickness", wall_thickness, 0.02, 2.0)
    height = check_number("maze", "wall_height", wall_height, 0.2, 10.0)
    if rows * columns < 2:
        raise WorldError("maze: a maze needs at least two cells: give more rows or columns")
    if cell - thick < NARROWEST:
        raise WorldError(
            f"maze: cells of {cell:g} m with walls of {thick:g} m leave passages of {cell - thick:.2f} m; leave at "
            f"least {NARROWEST:g} m"
        )
    along_x, along_y = _carve(np.random.default_rng(seed), rows, columns, loops)
    solids = _walls(along_x, along_y, cell, thick, height)
    return World("maze", tuple(solids), (((1 - columns) * cell / 2.0, (1 - rows) * cell / 2.0),))


def _carve(rng: np.random.Generator, rows: int, columns: int, loops: float) -> tuple[BoolArray, BoolArray]:
    """Return the walls that remain: along x, shape (rows + 1, columns), and along y, shape (rows, columns + 1)."""
    along_x = np.ones((rows + 1, columns), dtype=np.bool_)
    along_y = np.ones((rows, columns + 1), dtype=np.bool_)
    seen = np.zeros((rows, columns), dtype=np.bool_)
    seen[0, 0] = True
    stack = [(0, 0)]
    while stack:
        row, col = stack[-1]
        steps = [
            (row + dr, col + dc)
            for dr, dc in ((1, 0), (-1, 0), (0, 1), (0, -1))
            if 0 <= row + dr < rows and 0 <= col + dc < columns and not seen[row + dr, col + dc]
        ]
        if not steps:
            stack.pop()
            continue
        to_row, to_col = steps[int(rng.integers(len(steps)))]
        if to_col == col:
            along_x[max(row, to_row), col] = False
        else:
            along_y[row, max(col, to_col)] = False
        seen[to_row, to_col] = True
        stack.append((to_row, to_col))
    for walls in (along_x[1:-1], along_y[:, 1:-1]):
        walls &= rng.random(walls.shape) >= loops
    return along_x, along_y


def _walls(along_x: BoolArray, along_y: BoolArray, cell: float, thick: float, height: float) -> list[Solid]:
    """Return straight runs of wall as one box each. Runs along x own the corners, so that no two boxes overlap."""
    rows, columns = along_y.shape[0], along_x.shape[1]
    corners = np.zeros((rows + 1, columns + 1), dtype=np.bool_)
    parts: list[Part] = []
    for line in range(rows + 1):
        for begin, end in _runs(along_x[line]):
            corners[line, begin : end + 1] = True
            centre = ((begin + end - columns) * cell / 2.0, (line - rows / 2.0) * cell)
            name = f"x_{line}_{begin}"
            parts += _wall(name, ((end - begin) * cell + thick, thick), centre, height, rim=line in (0, rows))
    for line in range(columns + 1):
        for begin, end in _runs(along_y[:, line]):
            # Split at corners that a run along x owns; elsewhere the corner belongs to this run.
            cuts = [begin, *(row for row in range(begin + 1, end) if corners[row, line]), end]
            for low, high in itertools.pairwise(cuts):
                south = (low - rows / 2.0) * cell + (thick if corners[low, line] else -thick) / 2.0
                north = (high - rows / 2.0) * cell - (thick if corners[high, line] else -thick) / 2.0
                centre = ((line - columns / 2.0) * cell, (south + north) / 2.0)
                name = f"y_{line}_{low}"
                parts += _wall(name, (thick, north - south), centre, height, rim=line in (0, columns))
    return place(parts, "wall", 0.0, 0.0, 0.0)


def _runs(walls: BoolArray) -> list[tuple[int, int]]:
    """Begin and end of each run of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], walls, [False]]).astype(np.int8)))
    return [(int(begin), int(end)) for begin, end in edges.reshape(-1, 2)]


def _wall(name: str, size: tuple[float, float], centre: tuple[float, float], height: float, *, rim: bool) -> list[Part]:
    body = height - _CAP_HEIGHT
    return [
        box(name, (*size, body), (*centre, body / 2.0), _WALL, "wall"),
        box(f"{name}_cap", (*size, _CAP_HEIGHT), (*centre, height - _CAP_HEIGHT / 2.0), _RIM if rim else _CAP, "wall"),
    ]
