"""Make masks.png: a run around a zone to keep out of and slowly through another.

python docs/pictures/masks.py FOLDER
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

import numpy as np

from trundle.cli.entry import run_command
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid

KEEPOUT = (-3.3, -0.7, -1.2, 0.8)
"""x, y, x end, y end [m]."""
SLOW = (1.0, -8.6, 5.0, 3.2)
CELL = 0.1
"""Of the masks [m]; the map's are smaller."""


def save_zone(path: Path, zone: tuple[float, float, float, float], value: int, extra: str) -> None:
    """Write a mask of one zone, and what its values mean."""
    x, y, x_end, y_end = zone
    shape = round((y_end - y) / CELL), round((x_end - x) / CELL)
    OccupancyGrid(np.full(shape, value, dtype=np.int8), CELL, Pose2D(x, y)).save(path, mode="raw")
    path.write_text(path.read_text() + extra)


def main() -> int:
    """Write the masks into the folder, drive, and put the picture into docs/images."""
    folder = Path(sys.argv[1])
    save_zone(folder / "keepout.yaml", KEEPOUT, 100, "type: 0\n")
    save_zone(folder / "slow.yaml", SLOW, 30, "type: 1\nbase: 0.0\nmultiplier: 1.0\n")
    ends = ["--start", "-11,0,0", "--goal", "11.5,0"]
    masks = ["--keepout", str(folder / "keepout.yaml"), "--speed-mask", str(folder / "slow.yaml")]
    place = ["warehouse", "--seed", "7", "--backend", "kinematic"]
    code = run_command(["run", *place, *ends, *masks, "--no-video", "--out", str(folder / "run")])
    shutil.copy(folder / "run" / "overlay.png", Path(__file__).parents[1] / "images" / "masks.png")
    return code


if __name__ == "__main__":
    sys.exit(main())
