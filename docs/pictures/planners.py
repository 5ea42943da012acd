"""Make planners.png and each_planner.png: one query under all planners, in the built-in warehouse.

python docs/pictures/planners.py
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from stacked import save_stacked

from trundle.cli.entry import run_command
from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.planning import create_planner
from trundle.record.overlay import draw_plan
from trundle.robots import Robot

START, GOAL = Pose2D(-13.0, 0.0), Pose2D(13.0, 4.0, 1.57)
QUERY = ["--start=-13,0", "--goal", "13,4.0,1.57", "--compare"]
EACH = ("manhattan_astar", "astar", "any_angle", "hybrid_astar", "least_cost", "auto")


def draw_each(map_file: str) -> None:
    """Draw the path of each planner in a separate picture, side by side."""
    robot = Robot.load("nova_carter")
    costmap = Costmap.from_grid(OccupancyGrid.load(map_file), robot)
    pictures = []
    for name in EACH:
        path = create_planner(name).plan(costmap, START, GOAL)
        clearance = float(costmap.clearance(path.poses).min())
        facts = f"{path.length:.2f} m · smallest clearance {clearance:.2f} m"
        pictures.append(draw_plan(costmap, path, robot, title=name, lines=[facts]))
    save_stacked(pictures, "each_planner.png", columns=2)


def main() -> int:
    """Build the map, compare on it, and draw each planner's path."""
    picture = Path(__file__).parents[1] / "images" / "planners.png"
    with tempfile.TemporaryDirectory() as folder:
        map_file = f"{folder}/map.yaml"
        made = run_command(["map", "build", "warehouse", "--seed", "7", "-o", map_file, "--json"])
        made = made or run_command(["plan", map_file, *QUERY, "-o", str(picture)])
        if made == 0:
            draw_each(map_file)
        return made


if __name__ == "__main__":
    sys.exit(main())
