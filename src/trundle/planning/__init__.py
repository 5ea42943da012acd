"""Planners: from a costmap, a start and a goal to a `Path`; and searches over cells."""

from trundle.planning.fields import cost_field
from trundle.planning.grid_search import Cancellation, GridPath, GridPaths, GridSearch
from trundle.planning.planner import Planner, create_planner, planner_names

__all__ = [
    "Cancellation",
    "GridPath",
    "GridPaths",
    "GridSearch",
    "Planner",
    "cost_field",
    "create_planner",
    "planner_names",
]
