"""Make crowd.png and crowd.gif: mppi among forklifts and people in a generated warehouse.

python docs/pictures/crowd.py FOLDER
"""

from __future__ import annotations

import sys
from pathlib import Path

from public import View, film

from trundle.mission import Scenario


def main() -> None:
    scenario = Scenario.make(
        world={"name": "warehouse", "seed": 3, "options": {"forklifts": 4, "people": 8, "low_objects": False}},
        start=(-9.0, -7.0, 1.57),
        goal=(12.5, 2.5),
        controller="mppi",
        lidar=True,
        seed=1,
    )
    film(scenario.build(), View((-15.2, -10.2), (15.2, 10.2), 30.0), "crowd", Path(sys.argv[1]), 12.0, every=2)


if __name__ == "__main__":
    main()
