"""MovingAI benchmark maps (`.map`) and queries (`.scen`).

Formats: https://movingai.com/benchmarks/formats.html; N. Sturtevant, "Benchmarks for Grid-Based Pathfinding", 2012.
Their first row is the top; ours is the bottom, so rows are flipped here.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from trundle.errors import MapError
from trundle.files.opening import open_file, read_up_to
from trundle.files.writing import write_bytes
from trundle.maps.grid import FREE, MAX_CELLS, OCCUPIED, UNKNOWN, OccupancyGrid
from trundle.maps.values import round_trinary
from trundle.values import as_path

_FREE_TERRAIN = b".GS"
_BLOCKED_TERRAIN = b"@OTW"
_MAX_SCENARIO_BYTES = 200_000_000


@dataclass(frozen=True, slots=True)
class MovingAIQuery:
    """One line of a `.scen` file, in our rows.

    Attributes:
        bucket: Its group of path lengths.
        map_name: The map's file name as it stands there.
        width: Columns of the map.
        height: Rows of the map.
        start: Cell (row, col), row 0 at the bottom.
        goal: Cell (row, col), row 0 at the bottom.
        optimal_length: Length of the shortest 8-connected path [cells], diagonals √2, no corner cut.
    """

    bucket: int
    map_name: str
    width: int
    height: int
    start: tuple[int, int]
    goal: tuple[int, int]
    optimal_length: float


def load_map(path: str | os.PathLike[str], *, resolution: float = 1.0) -> OccupancyGrid:
    """Read a MovingAI map.

    Args:
        path: The `.map` file.
        resolution: Edge of a cell [m].

    Returns:
        A grid with `.`, `G` and `S` (swamp) free and `@`, `O`, `T`, `W` occupied; its origin is (0, 0, 0).

    Raises:
        MapError: If the file cannot be read, is truncated, or holds other terrain.
    """
    source = Path(path)
    lines = _read(source, MAX_CELLS + 1_000_000).split(b"\n")
    if lines and lines[-1] == b"":
        lines.pop()
    lines = [line.removesuffix(b"\r") for line in lines]
    height, width, first = _parse_header(lines, source)
    if height * width > MAX_CELLS:
        raise MapError(f"{source}: {width} x {height} cells are more than a map may have ({MAX_CELLS})")
    rows = lines[first : first + height]
    if len(rows) < height:
        raise MapError(f"{source}:{len(lines)}:1: the map ends after {len(rows)} of {height} rows; copy it again")
    for number, row in enumerate(rows, start=first + 1):
        if len(row) != width:
            raise MapError(
                f"{source}:{number}:{min(len(row), width) + 1}: the row has {len(row)} cells, the header says "
                f"{width}; correct the row or the header"
            )
    terrain = np.frombuffer(b"".join(rows), dtype=np.uint8).reshape(height, width)
    table = np.full(256, UNKNOWN, dtype=np.int8)
    table[list(_FREE_TERRAIN)] = FREE
    table[list(_BLOCKED_TERRAIN)] = OCCUPIED
    cells = table[terrain]
    if (cells == UNKNOWN).any():
        row, col = np.argwhere(cells == UNKNOWN)[0]
        raise MapError(
            f"{source}:{first + 1 + row}:{col + 1}: unknown terrain {chr(terrain[row, col])!r}; "
            "there are . G S (free) and @ O T W (blocked)"
        )
    return OccupancyGrid(cells[::-1], resolution)


def save_map(grid: OccupancyGrid, path: str | os.PathLike[str]) -> None:
    """Write a MovingAI map: `.` where a cell is free, `@` where it is occupied or unknown.

    The format has no unknown cells, no values between, no resolution and no origin: they are lost.

    Raises:
        OutputError: If the file cannot be written. No half file is left.
    """
    rows, cols = grid.shape
    text = np.full((rows, cols + 1), ord("\n"), dtype=np.uint8)
    text[:, :-1] = np.where(round_trinary(grid.data)[::-1] == FREE, ord("."), ord("@"))
    write_bytes(path, f"type octile\nheight {rows}\nwidth {cols}\nmap\n".encode() + text.tobytes())


def load_scenarios(path: str | os.PathLike[str]) -> list[MovingAIQuery]:
    """Read the queries of a MovingAI `.scen` file, in its order.

    Raises:
        MapError: If the file cannot be read, or a line has other fields than the nine of the format.
    """
    source = Path(as_path(path, "a file of scenarios", MapError))
    queries: list[MovingAIQuery] = []
    for number, raw in enumerate(_read(source, _MAX_SCENARIO_BYTES).split(b"\n"), start=1):
        try:
            line = raw.decode().strip()
        except UnicodeDecodeError as error:
            raise MapError(f"{source}:{number}:{error.start + 1}: not text in UTF-8; copy the file again") from error
        if line and not (number == 1 and line.startswith("version")):
            queries.append(_parse_query(line, f"{source}:{number}"))
    if not queries:
        raise MapError(f"{source}: there is no query in this file")
    return queries


def _read(source: Path, max_bytes: int) -> bytes:
    try:
        with open_file(source) as stream:
            content = read_up_to(stream, max_bytes + 1)
    except OSError as error:
        raise MapError(f"cannot read {source}: {error.strerror or error}") from error
    if len(content) > max_bytes:
        raise MapError(f"{source}: larger than {max_bytes} bytes; this is no MovingAI file")
    return content


def _parse_header(lines: list[bytes], source: Path) -> tuple[int, int, int]:
    """Height, width and the index of the first row of cells."""
    sizes: dict[bytes, int] = {}
    for index, line in enumerate(lines[:16]):
        words = line.split()
        if words == [b"map"]:
            missing = [what.decode() for what in (b"height", b"width") if what not in sizes]
            if missing:
                raise MapError(f"{source}:{index + 1}:1: the header has no {' and no '.join(missing)}; add it")
            return sizes[b"height"], sizes[b"width"], index + 1
        if len(words) == 2 and words[0] in (b"height", b"width"):
            if not (words[1].isdigit() and len(words[1]) < 10 and int(words[1]) > 0):
                raise MapError(
                    f"{source}:{index + 1}:{len(words[0]) + 2}: {words[0].decode()} must be a whole number of at "
                    f"least 1, got {words[1][:20]!r}; correct it"
                )
            sizes[words[0]] = int(words[1])
        elif words[:1] != [b"type"]:
            break
    raise MapError(f"{source}:1:1: not a MovingAI map: it begins with the lines type, height, width and map")


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
        raise MapError(f"{place}:1: a field of this query is no number ({error}); correct it") from error
    for what, x, y in (("start", start_x, start_y), ("goal", goal_x, goal_y)):
        if not (0 <= x < width and 0 <= y < height):
            raise MapError(f"{place}:1: the {what} ({x}, {y}) is outside the map of {width} x {height} cells")
    if not (math.isfinite(length) and length >= 0.0):
        raise MapError(f"{place}:1: the optimal length is {fields[8]}, it must be a finite number of at least 0")
    return MovingAIQuery(
        bucket=bucket,
        map_name=fields[1],
        width=width,
        height=height,
        start=(height - 1 - start_y, start_x),
        goal=(height - 1 - goal_y, goal_x),
        optimal_length=length,
    )
