"""`trundle map build`: the occupancy map of a world."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import App, Parameter

from trundle.cli.shared import isaac, options, output, sources
from trundle.errors import InputError

if TYPE_CHECKING:
    from trundle.maps.from_world import Bounds

app = App(
    name="build",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle map build warehouse -o map.yaml\n"
        "  trundle map build warehouse --seed 7 --set aisle_width=1.6 --resolution 0.025 --out maps\n"
        "  trundle map build scene.usd --exclude /World/Robot --exclude ceiling\n"
        "  trundle map build hall.glb --free 2,1.5 --bounds -10,-5,30,25\n"
        "  trundle map build site.sdf --floor floor.npz --max-slope 0.14\n"
        "  trundle map build warehouse_with_forklifts --assets-root Assets/Isaac/5.1 --exclude ceiling"
    ),
)


@app.default
def build(
    world: str,
    /,
    *,
    out: Annotated[Path, Parameter(name=["--out", "-o"])] = Path("map.yaml"),
    resolution: float = 0.05,
    z_min: options.Height = None,
    z_max: options.Height = None,
    robot: options.RobotName = "nova_carter",
    assets_root: isaac.AssetsRoot = None,
    floor_z: options.FloorZ = None,
    floor: Path | None = None,
    max_slope: options.Angle | None = None,
    bounds: Annotated[str | None, Parameter(allow_leading_hyphen=True, metavar="X0,Y0,X1,Y1")] = None,
    margin: float = 0.0,
    free: Annotated[list[str] | None, Parameter(allow_leading_hyphen=True, negative="", metavar="X,Y|largest")] = None,
    coverage: Literal["any", "centre"] = "any",
    style: Literal["exact", "isaac"] = "exact",
    half_cell_origin: options.Flag = False,
    max_cells: options.Integer | None = None,
    seed: options.Seed = 0,
    settings: options.Settings = None,
    exclude: options.Exclude = None,
    paths: options.Paths = None,
    overwrite: options.OverwriteMap = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Make the occupancy map of a world.

    Cells are free, occupied or unknown: unknown cells cannot be reached from the world's free seeds.

    A height field for --floor is a .npz file, as HeightField.save writes it: heights (samples [m], one row per y,
    the lowest first, NaN where unknown), resolution (between samples [m]) and origin (x, y of the first sample [m]).

    Args:
        world: A world by name, or its file: USD, SDF, MJCF, URDF, a mesh, or the YAML of a map to rebuild. With
            --assets-root, an environment of Isaac Sim.
        out: The map's YAML, with its image beside it; or a folder for map.yaml.
        resolution: Cell size [m].
        z_min: Lower end of the height band above the floor [m]; default: the robot's.
        z_max: Upper end of the height band above the floor [m]; default: the robot's.
        floor: A height field, for a floor with ramps.
        max_slope: The maximum slope of a height field that is not an obstacle [rad, or 10deg]; default: 10deg.
        bounds: The area of the map [m]; the upper corner is moved out to whole cells; default: the world.
        margin: Added around the bounds [m].
        free: A point that is free and reachable, such as the robot's start [m], or largest, for the largest free area;
            repeatable; default: the world's own.
        coverage: Which cells a solid occupies: all that it overlaps, or those whose centre is inside it.
        style: isaac marks the same cells as Isaac Sim's generator, for comparison.
        half_cell_origin: Give the centre of the corner cell as the origin, as Isaac Sim does; ROS gives its corner.
        max_cells: Limit on the number of cells; default: 400 million.
    """
    from trundle.maps import FREE, MAX_CELLS, UNKNOWN, HeightField, OccupancyGrid

    machine = sources.load_robot(robot, paths)
    low, high = machine.z_range
    band = (low if z_min is None else z_min, high if z_max is None else z_max)
    area, seeds = _parse_bounds(bounds), _parse_free(free)
    heights = HeightField.load(floor) if floor is not None else None
    scene = isaac.find_environment(world, assets_root)
    kept = sources.read_settings(world, settings, exclude, paths, robot=robot)
    place = sources.load_world(str(scene or world), seed=seed, settings=kept)
    target = options.output_file(out, "map.yaml", (".yaml", ".yml"))
    if not overwrite:
        options.check_map_replaceable(target)
    if heights is None:
        level = sources.find_floor_z(place, str(scene or world), machine, seeds[0] if seeds else None, floor_z)
    else:
        level = floor_z or 0.0
    grid = OccupancyGrid.from_world(
        place,
        resolution=resolution,
        z_range=band,
        floor_z=level,
        floor=heights,
        max_slope=max_slope,
        bounds=area,
        seeds=seeds,
        coverage=coverage,
        style=style,
        half_cell_origin=half_cell_origin,
        margin=margin,
        max_cells=MAX_CELLS if max_cells is None else max_cells,
    )
    grid.save(target)
    rows, cols = grid.shape
    reached, unknown = int((grid.data == FREE).sum()), int((grid.data == UNKNOWN).sum())
    width, height = cols * grid.resolution, rows * grid.resolution
    facts = {
        "world": place.name,
        "map": str(target),
        "rows": rows,
        "cols": cols,
        "resolution_m": grid.resolution,
        "width_m": width,
        "height_m": height,
        "origin": grid.origin.as_tuple(),
        "z_range_m": band,
        "floor_z_m": level,
        "free_cells": reached,
        "unknown_cells": unknown,
        "occupied_cells": rows * cols - reached - unknown,
    }
    if json:
        output.print_json(facts)
        return 0
    output.print_facts(
        {
            "world": place.name,
            "size": f"{width:.2f} x {height:.2f} m ({cols} x {rows} cells of {grid.resolution:g} m)",
            "heights": f"{band[0]:g} to {band[1]:g} m above {_describe_floor(floor, level)}",
            "cells": f"{reached} free, {facts['occupied_cells']} occupied, {unknown} unknown",
            "map": target,
        }
    )
    return 0


def _parse_bounds(text: str | None) -> Bounds | None:
    if text is None:
        return None
    x0, y0, x1, y1 = options.parse_numbers("--bounds", text, "X0,Y0,X1,Y1", at_least=4, at_most=4)
    return (x0, y0), (x1, y1)


def _parse_free(texts: list[str] | None) -> list[tuple[float, float]] | None:
    """Return the seeds of the flood fill; an empty list stands for the largest area, None for the world's own seeds."""
    if texts is None:
        return None
    if "largest" in texts:
        if len(texts) > 1:
            raise InputError("--free largest cannot be combined with points X,Y")
        return []
    points = [options.parse_numbers("--free", text, "X,Y, or largest,", at_least=2, at_most=2) for text in texts]
    return [(x, y) for x, y in points]


def _describe_floor(floor: Path | None, floor_z: float) -> str:
    if floor is not None:
        return f"the floor of {floor}"
    return "the floor" if floor_z == 0.0 else f"a floor at {floor_z:g} m"
