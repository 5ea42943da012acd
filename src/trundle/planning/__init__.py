"""Planners: from a costmap, a start and a goal to a `Path`; and searches over cells."""

from trundle.planning.cancellation import Cancellation
from trundle.planning.grid.cells import cost_field
from trundle.planning.grid.grid_paths import GridPath, GridPaths, PointPath, PointPaths
from trundle.planning.grid.grid_search import GridSearch, any_angle_path
from trundle.planning.many import plan_many
from trundle.planning.path_check import PathCheck, PathHit
from trundle.planning.planner import Planner, PlannerLike, create_planner, planner_names
from trundle.planning.smoother import Smoother, create_smoother, smoother_names

__all__ = [
    "Cancellation",
    "GridPath",
    "GridPaths",
    "GridSearch",
    "PathCheck",
    "PathHit",
    "Planner",
    "PlannerLike",
    "PointPath",
    "PointPaths",
    "Smoother",
    "any_angle_path",
    "cost_field",
    "create_planner",
    "create_smoother",
    "plan_many",
    "planner_names",
    "smoother_names",
]
