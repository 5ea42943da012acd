"""`trundle map build`: the occupancy map of a world."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from trundle.cli import isaac, options, output, sources

app = App(
    name="build",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle map build warehouse -o map.yaml\n"
        "  trundle map build warehouse --seed 7 --set aisle_width=1.6 --resolution 0.025 --out maps\n"
        "  trundle map build scene.usd --exclude /World/Robot --exclude ceiling\n"
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
    z_min: Annotated[float | None, Parameter(allow_leading_hyphen=True)] = None,
    z_max: Annotated[float | None, Parameter(allow_leading_hyphen=True)] = None,
    robot: options.RobotName = "nova_carter",
    assets_root: str | None = None,
    seed: options.Seed = 0,
    settings: options.Settings = None,
    exclude: options.Exclude = None,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Make the occupancy map of a world.

    Cells are free, occupied or unknown: unknown is what cannot be reached from the world's free seeds.

    Args:
        world: A world by name, or its file: USD, SDF, MJCF, URDF, a mesh, or the YAML of a map to build again. With
            --assets-root, an environment of Isaac Sim.
        out: The map's YAML, with its image beside it; or a folder for map.yaml.
        resolution: Edge of a cell [m].
        z_min: Lower end of the band of heights that counts [m]; left out: the robot's.
        assets_root: Folder of Isaac Sim's asset packs, the one that holds Isaac/Environments.
        z_max: Upper end of the band of heights that counts [m]; left out: the robot's.
    """
    from trundle.maps import FREE, UNKNOWN, OccupancyGrid
    from trundle.robots import Robot

    low, high = Robot.load(robot).z_range
    band = (low if z_min is None else z_min, high if z_max is None else z_max)
    scene = isaac.find_environment(world, assets_root)
    place = sources.load_world(str(scene or world), seed=seed, settings=options.parse_settings(settings, exclude))
    target = options.output_file(out, "map.yaml", (".yaml", ".yml"))
    grid = OccupancyGrid.from_world(place, resolution=resolution, z_range=band)
    grid.save(target)
    rows, cols = grid.shape
    free, unknown = int((grid.data == FREE).sum()), int((grid.data == UNKNOWN).sum())
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
        "free_cells": free,
        "unknown_cells": unknown,
        "occupied_cells": rows * cols - free - unknown,
    }
    if json:
        output.print_json(facts)
        return 0
    output.print_facts(
        {
            "world": place.name,
            "size": f"{width:.2f} x {height:.2f} m ({cols} x {rows} cells of {grid.resolution:g} m)",
            "heights": f"{band[0]:g} to {band[1]:g} m",
            "cells": f"{free} free, {facts['occupied_cells']} occupied, {unknown} unknown",
            "map": target,
        }
    )
    return 0
