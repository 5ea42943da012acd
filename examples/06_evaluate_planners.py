"""Compare a planner of your own with trundle's default on the same missions: which one arrives, and how well.

Writes the folder evaluation: the rows, and report.html, which shows where robots fail.
"""

import numpy as np

import trundle
from trundle.planning import create_planner


def straight_or_astar(costmap, start, goal):
    """A planner is any function from (costmap, start, goal) to a path: here a straight line where nothing is on it."""
    x, y = np.linspace(start.x, goal.x, 200), np.linspace(start.y, goal.y, 200)
    line = np.column_stack([x, y, np.full(200, np.arctan2(goal.y - start.y, goal.x - start.x))])
    if costmap.footprint_collides(line).any():
        return create_planner("astar").plan(costmap, start, goal)
    return line


if __name__ == "__main__":  # worker processes import this file, too
    evaluation = trundle.evaluate(
        {
            "worlds": {"name": "office", "seed": 3},
            "planners": ["auto", straight_or_astar],
            "backends": "kinematic",
            "missions": 8,
        },
        out="evaluation",
    )
    print(evaluation)
    for group in evaluation.summary()["by_group"].values():
        print(group["labels"]["planner"], group["outcomes"], "median SPL", group["medians"]["spl"])
    print("wrote evaluation/report.html")
