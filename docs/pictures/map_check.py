"""Make map_check.png: a map with planted mistakes, and what `trundle map check` reports.

python docs/pictures/map_check.py FOLDER
"""

from __future__ import annotations

import math
import sys
from pathlib import Path

from trundle.cli.entry import run_command
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid, convert_grid
from trundle.worlds import World

# Boxes (x, y, x end, y end) [m] and their value: -1 unknown, 0 free, 100 occupied.
PLANTED = (
    (-10.5, 2.5, -9.5, 3.5, -1),  # a hole
    (-10.0, -3.0, -9.95, -2.95, 100),  # a speck
    (-4.2, 2.5, -4.0, 4.1, 100),  # a narrow passage between two racks
    (14.9, 3.0, 15.3, 3.6, 0),  # a gap in the outer wall
    (8.0, 7.0, 9.2, 8.2, 100),  # walls around a place…
    (8.1, 7.1, 9.1, 8.1, 0),  # …that cannot be reached
)
TURNED = Pose2D(0.0, 0.0, math.radians(7.0))
"""Pose of the frame of the robot's first pose in the world's frame."""


def plant(grid: OccupancyGrid) -> OccupancyGrid:
    """Paint the mistakes, then turn the map as one that a robot made is turned."""
    data = grid.data.copy()
    for x, y, x_end, y_end, value in PLANTED:
        row, col = grid.world_to_cell(x + 1e-6, y + 1e-6)
        row_end, col_end = grid.world_to_cell(x_end - 1e-6, y_end - 1e-6)
        data[row : row_end + 1, col : col_end + 1] = value
    wrong = OccupancyGrid(data, grid.resolution, TURNED @ grid.origin)
    return convert_grid(wrong, align=True).grid


def main() -> int:
    """Write the map and the mended one into the folder, and the picture into docs/images."""
    folder = Path(sys.argv[1])
    world = World.generate("warehouse", seed=7)
    plant(OccupancyGrid.from_world(world)).save(folder / "slam.yaml")
    arguments = ["--world", "warehouse", "--seed", "7", "--robot", "nova_carter", "--start", "-12,-2"]
    picture = Path(__file__).parents[1] / "images" / "map_check.png"
    return run_command(
        ["map", "check", str(folder / "slam.yaml"), *arguments, "--fix", str(folder / "right.yaml"), "-o", str(picture)]
    )


if __name__ == "__main__":
    sys.exit(main())
