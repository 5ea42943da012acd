"""Worlds as occupancy maps: a ROS map YAML with its image."""

from __future__ import annotations

from pathlib import Path

from trundle.maps import OccupancyGrid
from trundle.worlds import World


def export_world(
    world: World, path: Path, *, resolution: float = 0.05, z_range: tuple[float, float] = (0.10, 0.62)
) -> None:
    """Write the map of a world.

    Args:
        world: The world.
        path: The YAML; its image lies beside it.
        resolution: Cell size [m].
        z_range: Height band of obstacles [m].

    Raises:
        MapError: If the map cannot be made; see `OccupancyGrid.from_world`.
        OutputError: If the files cannot be written.
    """
    OccupancyGrid.from_world(world, resolution=resolution, z_range=z_range).save(path)
