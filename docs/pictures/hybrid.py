"""Make hybrid_astar.png: a robot that parks in an aisle with its nose out, with arcs only and with turns in place.

python docs/pictures/hybrid.py
"""

from __future__ import annotations

import numpy as np
from stacked import save_stacked

from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.planning import create_planner
from trundle.record.overlay import draw_plan
from trundle.robots import Robot

START, GOAL = Pose2D(1.2, 1.0, 1.57), Pose2D(5.6, 2.0, 3.14)


def make_costmap(robot: Robot) -> Costmap:
    """A room of 7 x 4 m with an aisle of 0.8 m in it, where the robot would need 1.31 m to turn."""
    data = np.zeros((80, 140), np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    data[:32, 84:] = data[48:, 84:] = 100
    return Costmap.from_grid(OccupancyGrid(data, 0.05), robot)


def main() -> None:
    """Draw both, one above the other."""
    robot = Robot.load("nova_carter")
    costmap = make_costmap(robot)
    pictures = []
    for in_place, what in ((False, "arcs of 0.4 m, both directions"), (True, "the same, with turns in place")):
        path = create_planner("hybrid_astar", in_place=in_place).plan(costmap, START, GOAL)
        changes = int(np.count_nonzero(np.diff(path.backward)))
        back = float(np.hypot(*np.diff(path.poses[:, :2], axis=0).T)[path.backward].sum())
        facts = f"{path.length:.2f} m, {back:.2f} m of it backwards · {changes} change of direction"
        pictures.append(draw_plan(costmap, path, robot, title=f"hybrid_astar · {what}", lines=[facts]))
    save_stacked(pictures, "hybrid_astar.png")


if __name__ == "__main__":
    main()
