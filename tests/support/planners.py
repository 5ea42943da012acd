"""Planners that do what a planner should not."""

import numpy as np

from trundle.geometry import Pose2D
from trundle.path import Path


class StraightPlanner:
    """Drives in a straight line through whatever is in between."""

    def plan(self, costmap, start, goal, *, deadline_s=None, cancel=None):
        """The line."""
        goal = Pose2D.of(goal)
        return Path(np.array([start.as_tuple(), goal.as_tuple()]), cost=1.0)
