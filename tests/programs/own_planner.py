import numpy as np

import trundle
from trundle import Costmap, Goal, PlanningError, Pose2D


def straight(costmap: Costmap, start: Pose2D, goal: Goal) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    path = np.linspace((start.x, start.y), (goal.x, goal.y), 200)
    if (costmap.data[costmap.world_to_cell(path[:, 0], path[:, 1])] > 252).any():
        raise PlanningError("something is in the way")
    return path


with trundle.Scenario.make(world="warehouse", planner=straight, start=(8.0, 7.4), goal=(12.0, 7.4)).build() as mission:
    print(mission.run().outcome)
