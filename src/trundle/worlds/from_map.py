"""Map files as worlds."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Literal

from trundle.maps import OccupancyGrid
from trundle.worlds.options import Unknown
from trundle.worlds.world import World


def load_map(
    path: Path,
    *,
    height: float = 1.0,
    unknown: Unknown = "solid",
    compat: Literal["humble"] | None = None,
    max_cells: int | None = None,
) -> World:
    """Read a map (a ROS YAML or a MovingAI .map) as a world of walls.

    Args:
        path: The YAML, or the .map.
        height: Height of the walls [m].
        unknown: Treat unknown cells as "solid" or "free".
        compat: "humble" reads a YAML as ROS 2 Humble does.
        max_cells: As for `OccupancyGrid.load`.

    Raises:
        MapError: If the file cannot be used.
        WorldError: As `World.from_map`.
    """
    world = World.from_map(OccupancyGrid.load(path, compat=compat, max_cells=max_cells), height=height, unknown=unknown)
    return replace(world, name=path.stem)
