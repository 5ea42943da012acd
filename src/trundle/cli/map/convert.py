"""`trundle map convert`: convert, resample, align, crop or merge maps."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import App, Parameter

from trundle.cli.shared import options, output
from trundle.cli.shared.sources import check_given
from trundle.errors import InputError
from trundle.files.kinds import MAP
from trundle.files.opening import is_file

if TYPE_CHECKING:
    from trundle.maps import OccupancyGrid
    from trundle.maps.convert import Crop, Loss
    from trundle.maps.occupancy import Compat, Mode

app = App(
    name="convert",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle map convert map.yaml -o coarse.yaml --resolution 0.1\n"
        "  trundle map convert turned.yaml -o map.yaml --align --crop content\n"
        "  trundle map convert east.yaml west.yaml -o both.yaml --image pgm\n"
        "  trundle map convert arena.map -o arena.yaml --source-resolution 0.5\n"
        "  trundle map convert map.yaml -o part.map --crop -5,-5,5,5"
    ),
)

_MOVINGAI = ".map"


@app.default
def convert(
    map_file: Path,
    second: Path | None = None,
    /,
    *,
    out: Annotated[Path, Parameter(name=["--out", "-o"])],
    mode: Literal["trinary", "scale", "raw"] | None = None,
    image: Literal["png", "pgm"] = "png",
    resolution: float | None = None,
    align: options.Flag = False,
    crop: Annotated[str | None, Parameter(allow_leading_hyphen=True, metavar="X0,Y0,X1,Y1|content")] = None,
    prefer: Literal["occupied", "free", "first", "second"] = "occupied",
    source_resolution: float | None = None,
    source_origin: Annotated[str | None, Parameter(allow_leading_hyphen=True, metavar="X,Y[,YAW]")] = None,
    max_cells: options.Integer | None = None,
    compat: options.Compat = None,
    overwrite: options.OverwriteMap = False,
    json: options.Json = False,
) -> int:
    """Convert a map to another format, resample, align or crop it, or merge two maps.

    Any information that is lost is reported. No obstacle is lost, except by --prefer: a new cell is occupied if it
    overlaps an occupied one, and free only if all of it was free.

    Args:
        map_file: The YAML of a ROS map, or a MovingAI map (.map).
        second: A map to merge into it; their cells need not be aligned.
        out: The new map's YAML, with its image beside it; a .map for MovingAI; or a folder for map.yaml.
        mode: The mode of a ROS map; default: trinary if that is lossless, else raw.
        image: The image format of a ROS map.
        resolution: New cell size [m]; default: the map's.
        align: Rotate the map so that its origin has no yaw, for software that ignores it, such as Nav2's costmaps.
        crop: Keep this rectangle of the map frame [m], moved out to whole cells; or content: all known cells.
        prefer: Which map wins if both know a cell: the occupied one, the free one, the first or the second. Cells
            unknown in one map are taken from the other.
        source_resolution: Cell size of a MovingAI map [m], which its file does not contain; default: 1.
        source_origin: The lower-left corner of a MovingAI map [m, m, rad]; default: 0,0.
        max_cells: Largest number of cells; default: 20 million for a map that is read, 400 million for the new one.
    """
    from trundle.maps import MAX_CELLS
    from trundle.maps.convert import convert_grid, find_file_losses
    from trundle.maps.movingai_cells import encode_cells
    from trundle.maps.ros_writer import choose_mode

    sources = [map_file] if second is None else [map_file, second]
    for source in sources:
        check_given(source, MAP)
    rectangle = _parse_crop(crop)
    grids = _load(sources, compat, source_resolution, source_origin, max_cells)
    target = options.output_file(out, "map.yaml", (".yaml", ".yml", _MOVINGAI))
    is_movingai = target.suffix.lower() == _MOVINGAI
    if is_movingai and mode is not None:
        raise InputError("--mode is for ROS maps: a MovingAI map has only free and blocked cells")
    _refuse_sources(sources, target, None if is_movingai else target.with_suffix(f".{image}"))
    if not overwrite and not is_movingai:
        options.check_map_replaceable(target)
    made = convert_grid(
        grids[0],
        other=grids[1] if second is not None else None,
        prefer=prefer,
        align=align,
        resolution=resolution,
        crop=rectangle,
        max_cells=MAX_CELLS if max_cells is None else max_cells,
    )
    if not overwrite and is_movingai and is_file(target):  # its format has no place for a hash
        same = target.read_bytes() == encode_cells(made.grid.data)
        options.check_replaceable(target, is_as_written=same)
    chosen: Mode = "trinary" if is_movingai else mode or choose_mode(made.grid)
    losses = [*made.losses, *find_file_losses(made.grid, "movingai" if is_movingai else "ros", chosen)]
    made.grid.save(target, mode=chosen, image_format=image)
    _report(sources, grids, target, made.grid, losses, None if is_movingai else chosen, json=json)
    return 0


def _parse_crop(text: str | None) -> Crop | None:
    if text is None or text == "content":
        return text
    form = 'X0,Y0,X1,Y1, or "content",'
    left, bottom, right, top = options.parse_numbers("--crop", text, form, at_least=4, at_most=4)
    return (left, bottom), (right, top)


def _load(
    sources: list[Path], compat: Compat | None, resolution: float | None, origin: str | None, max_cells: int | None
) -> list[OccupancyGrid]:
    from dataclasses import replace

    from trundle.geometry import Pose2D
    from trundle.maps import OccupancyGrid
    from trundle.maps.movingai import load_map as load_movingai_map

    corner = Pose2D(0.0, 0.0, 0.0) if origin is None else options.parse_pose("--source-origin", origin)
    silent = [source for source in sources if source.suffix.lower() == _MOVINGAI]
    if not silent and (resolution is not None or origin is not None):
        raise InputError(
            "--source-resolution and --source-origin are for MovingAI maps (.map): a ROS map has both in its YAML"
        )
    return [
        replace(
            load_movingai_map(source, resolution=1.0 if resolution is None else resolution, max_cells=max_cells),
            origin=corner,
        )
        if source in silent
        else OccupancyGrid.load(source, compat=compat, max_cells=max_cells)
        for source in sources
    ]


def _refuse_sources(sources: list[Path], target: Path, image: Path | None) -> None:
    """Refuse to overwrite a source map."""
    from trundle.maps.ros_reader import find_image
    from trundle.maps.ros_yaml import load_description

    for source in sources:
        read = {source.resolve()}
        if source.suffix.lower() != _MOVINGAI:
            read.add(find_image(source, load_description(source), allow_outside=True))
        for written in (target, image):
            if written is not None and written.resolve() in read:
                raise InputError(f"--out {target}: {written} is a file of the source map {source}; give another name")


def _report(
    sources: list[Path],
    grids: list[OccupancyGrid],
    target: Path,
    grid: OccupancyGrid,
    losses: list[Loss],
    mode: Mode | None,
    *,
    json: bool,
) -> None:
    facts = {
        "map": target,
        "format": "movingai" if mode is None else "ros",
        "mode": mode,
        **_measure(grid),
        "sources": [{"map": source, **_measure(read)} for source, read in zip(sources, grids, strict=True)],
        "lossless": not losses,
        "losses": losses,
    }
    if json:
        output.print_json(facts)
        return
    lines = {str(source): _describe(read) for source, read in zip(sources, grids, strict=True)}
    lines[str(target)] = _describe(grid)
    lines["format"] = "MovingAI" if mode is None else f"ROS, mode {mode}"
    output.print_facts(lines)
    if not losses:
        print("nothing is lost")
    for loss in losses:
        print(f"lost: {loss.kind}: {loss.message}")


def _measure(grid: OccupancyGrid) -> dict[str, object]:
    from trundle.maps import FREE, OCCUPIED, UNKNOWN
    from trundle.maps.cells import count_values

    rows, cols = grid.shape
    counts = count_values(grid.data)
    free, occupied, unknown = (int(counts[value - UNKNOWN]) for value in (FREE, OCCUPIED, UNKNOWN))
    return {
        "rows": rows,
        "cols": cols,
        "resolution_m": grid.resolution,
        "width_m": cols * grid.resolution,
        "height_m": rows * grid.resolution,
        "origin": grid.origin.as_tuple(),
        "free_cells": free,
        "occupied_cells": occupied,
        "unknown_cells": unknown,
        "between_cells": rows * cols - free - occupied - unknown,
    }


def _describe(grid: OccupancyGrid) -> str:
    facts = _measure(grid)
    area = grid.resolution**2
    x, y, yaw = grid.origin.as_tuple()
    parts = [f"{facts[f'{name}_cells']} {name}" for name in ("free", "occupied", "unknown", "between")]
    cells = ", ".join(part for part in parts if not part.startswith("0 between"))
    free = float(str(facts["free_cells"])) * area
    return (
        f"{grid.shape[1]} x {grid.shape[0]} cells of {grid.resolution:g} m at ({x:g}, {y:g}, {yaw:g}): {cells}; "
        f"{free:.2f} m² free"
    )
