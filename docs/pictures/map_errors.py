"""Make map_errors.png: the true map of an office, and what is wrong on the robot's.

python docs/pictures/map_errors.py
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from PIL import Image

from trundle.maps import FREE, UNKNOWN
from trundle.mission import Scenario

SCALE = 2
FREE_COLOR, WALL, OUTSIDE = (255, 255, 255), (70, 74, 80), (225, 227, 230)
MISSING, GHOST = (214, 69, 65), (47, 111, 191)


def main() -> None:
    """Draw the difference of the two maps into docs/images."""
    office = {"world": "office", "seed": 3, "backend": "kinematic"}
    true = Scenario.make(**office).prepare().grid.data
    wrong = Scenario.make(**office, map_errors={"missing": 0.25, "ghosts": 12}).prepare().grid.data
    colors = np.empty((*true.shape, 3), np.uint8)
    colors[:] = WALL
    colors[true == FREE] = FREE_COLOR
    colors[true == UNKNOWN] = OUTSIDE
    colors[(true != FREE) & (wrong == FREE)] = MISSING
    colors[(true == FREE) & (wrong != FREE)] = GHOST
    picture = Image.fromarray(np.flipud(colors)).resize((SCALE * true.shape[1], SCALE * true.shape[0]), Image.NEAREST)
    picture.save(Path(__file__).parents[1] / "images" / "map_errors.png", optimize=True)


if __name__ == "__main__":
    main()
