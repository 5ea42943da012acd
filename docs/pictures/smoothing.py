"""Make smoothing.png: what the constrained smoother makes of the paths of two planners, beside what they planned.

python docs/pictures/smoothing.py
"""

from __future__ import annotations

import numpy as np
from stacked import save_stacked

from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.path import Path as PlannedPath
from trundle.planning import create_planner, create_smoother
from trundle.record.overlay import draw_plan
from trundle.robots import Robot

START, GOAL = Pose2D(0.9, 0.9, 0.0), Pose2D(11.1, 5.2, 1.57)


def make_costmap(robot: Robot) -> Costmap:
    """A room of 12 x 6 m with two walls, a table and pillars between start and goal."""
    data = np.zeros((120, 240), np.int8)
    data[[0, -1], :] = data[:, [0, -1]] = 100
    data[:72, 62:66] = data[48:, 150:154] = 100
    data[88:100, 100:124] = data[24:32, 96:108] = data[66:70, 190:194] = data[30:34, 206:210] = 100
    return Costmap.from_grid(OccupancyGrid(data, 0.05), robot)


def turning(path: PlannedPath) -> float:
    """How far the robot turns in all [rad]."""
    return float(np.abs(np.diff(np.unwrap(path.poses[:, 2]))).sum())


def main() -> None:
    """Draw both, one above the other."""
    robot = Robot.load("nova_carter")
    costmap = make_costmap(robot)
    smoother = create_smoother("constrained", minimum_turning_radius=0.4)
    pictures = []
    for name, options in (("hybrid_astar", {"smooth": False}), ("astar", {})):
        planned = create_planner(name, **options).plan(costmap, START, GOAL)
        smooth = smoother.smooth(planned, costmap)
        facts = (
            f"{planned.length:.2f} m and {turning(planned):.1f} rad of turning planned, "
            f"{smooth.length:.2f} m and {turning(smooth):.1f} rad smoothed"
        )
        pictures.append(draw_plan(costmap, smooth, robot, title=f"{name} · smoothed", lines=[facts], before=planned))
    save_stacked(pictures, "smoothing.png")


if __name__ == "__main__":
    main()
