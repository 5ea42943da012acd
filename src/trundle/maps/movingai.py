"""MovingAI benchmark maps (`.map`) and queries (`.scen`).

Formats: https://movingai.com/benchmarks/formats.html; N. Sturtevant, "Benchmarks for Grid-Based Pathfinding", 2012.
Their first row is the top; ours is the bottom, so rows are flipped.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path

from trundle.errors import MapError
from trundle.maps.grid import OccupancyGrid
from trundle.maps.movingai_cells import read_cells, read_content, write_cells
from trundle.values import as_path

_MAX_SCENARIO_BYTES = 200_000_000


@dataclass(frozen=True, slots=True)
class MovingAIQuery:
    """One line of a `.scen` file, with row 0 at the bottom.

    Attributes:
        bucket: Its group of path lengths.
        map_name: The map's file name as written in the file.
        width: Columns of the map.
        height: Rows of the map.
        start: Cell (row, col), row 0 at the bottom.
        goal: Cell (row, col), row 0 at the bottom.
        optimal_length: Length of the shortest 8-connected path [cells], diagonals √2, without corner cutting.
    """

    bucket: int
    map_name: str
    width: int
    height: int
    start: tuple[int, int]
    goal: tuple[int, int]
    optimal_length: float


def load_map(path: str | os.PathLike[str], *, resolution: float = 1.0, max_cells: int | None = None) -> OccupancyGrid:
    """Read a MovingAI map.

    Args:
        path: The `.map` file.
        resolution: Edge of a cell [m].
        max_cells: As for `OccupancyGrid.load`.

    Returns:
        A grid with `.`, `G` and `S` (swamp) free and `@`, `O`, `T`, `W` occupied; its origin is (0, 0, 0).

    Raises:
        MapError: If the file cannot be read, is truncated, or holds other terrain.
    """
    return OccupancyGrid(read_cells(path, max_cells), resolution)


def save_map(grid: OccupancyGrid, path: str | os.PathLike[str]) -> None:
    """Write a MovingAI map: `.` where a cell is free, `@` where it is occupied or unknown.

    The format has no unknown cells, intermediate values, resolution or origin: they are lost.

    Raises:
        OutputError: If the file cannot be written. No partial file is left.
    """
    write_cells(grid.data, path)


def load_scenarios(path: str | os.PathLike[str]) -> list[MovingAIQuery]:
    """Read the queries of a MovingAI `.scen` file, in file order.

    Raises:
        MapError: If the file cannot be read, or a line does not have the nine fields of the format.
    """
    source = Path(as_path(path, "a file of scenarios", MapError))
    queries: list[MovingAIQuery] = []
    for number, raw in enumerate(read_content(source, _MAX_SCENARIO_BYTES).split(b"\n"), start=1):
        try:
            line = raw.decode().strip()
        except UnicodeDecodeError as error:
            raise MapError(f"{source}:{number}:{error.start + 1}: not UTF-8 text; copy the file again") from error
        if line and not (number == 1 and line.startswith("version")):
            queries.append(_parse_query(line, f"{source}:{number}"))
    if not queries:
        raise MapError(f"{source}: the file contains no queries")
    return queries


def _parse_query(line: str, place: str) -> MovingAIQuery:
    fields = [field.strip() for field in line.split("\t")] if "\t" in line else line.split()
    if len(fields) != 9:
        raise MapError(
            f"{place}:1: a query has nine fields (bucket, map, width, height, start x, start y, goal x, goal y, "
            f"length), this line has {len(fields)}"
        )
    try:
        bucket, width, height, start_x, start_y, goal_x, goal_y = (int(fields[i]) for i in (0, 2, 3, 4, 5, 6, 7))
        length = float(fields[8])
    except ValueError as error:
        raise MapError(f"{place}:1: a field of this query is not a number ({error}); correct it") from error
    for what, x, y in (("start", start_x, start_y), ("goal", goal_x, goal_y)):
        if not (0 <= x < width and 0 <= y < height):
            raise MapError(f"{place}:1: the {what} ({x}, {y}) is outside the map of {width} x {height} cells")
    if not (math.isfinite(length) and length >= 0.0):
        raise MapError(f"{place}:1: the optimal length is {fields[8]}; it must be a finite number of at least 0")
    return MovingAIQuery(
        bucket=bucket,
        map_name=fields[1],
        width=width,
        height=height,
        start=(height - 1 - start_y, start_x),
        goal=(height - 1 - goal_y, goal_x),
        optimal_length=length,
    )
