"""The cells of a MovingAI map (`.map`), read and written.

Their first row is the top; ours is the bottom, so rows are flipped here.
"""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from trundle.errors import MapError
from trundle.files.opening import read_limited
from trundle.files.writing import write_bytes
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN, Cells, cell_limit, round_trinary

_FREE_TERRAIN = b".GS"
_BLOCKED_TERRAIN = b"@OTW"


def read_cells(path: str | os.PathLike[str], max_cells: int | None = None) -> Cells:
    """Read the cells of a `.map` file, row 0 at the bottom; see `trundle.maps.movingai.load_map`."""
    source = Path(path)
    most = cell_limit(max_cells)
    lines = read_content(source, most + 1_000_000).split(b"\n")
    if lines and lines[-1] == b"":
        lines.pop()
    lines = [line.removesuffix(b"\r") for line in lines]
    height, width, first = _parse_header(lines, source)
    if height * width > most:
        raise MapError(
            f"{source}: {width} x {height} cells need max_cells={height * width}, and the limit is {most}: raise "
            f"it (--max-cells {height * width}), or crop the map"
        )
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
    return cells[::-1]


def write_cells(cells: Cells, path: str | os.PathLike[str]) -> None:
    """Write cells as a `.map` file; see `trundle.maps.movingai.save_map`."""
    write_bytes(path, encode_cells(cells))


def encode_cells(cells: Cells) -> bytes:
    """Return the bytes of a `.map` file."""
    rows, cols = cells.shape
    text = np.full((rows, cols + 1), ord("\n"), dtype=np.uint8)
    text[:, :-1] = np.where(round_trinary(cells)[::-1] == FREE, ord("."), ord("@"))
    return f"type octile\nheight {rows}\nwidth {cols}\nmap\n".encode() + text.tobytes()


def read_content(source: Path, max_bytes: int) -> bytes:
    """Read a MovingAI file.

    Raises:
        MapError: If it cannot be read, or is larger than `max_bytes`.
    """
    too_large = f"larger than {max_bytes} bytes; this is not a MovingAI file"
    return read_limited(source, max_bytes, too_large, error=MapError)


def _parse_header(lines: list[bytes], source: Path) -> tuple[int, int, int]:
    """Return the height, width and the index of the first row of cells."""
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
                    f"{source}:{index + 1}:{len(words[0]) + 2}: {words[0].decode()} must be an integer of at "
                    f"least 1, got {words[1][:20]!r}; correct it"
                )
            sizes[words[0]] = int(words[1])
        elif words[:1] != [b"type"]:
            break
    raise MapError(f"{source}:1:1: not a MovingAI map: it must begin with the lines type, height, width and map")
