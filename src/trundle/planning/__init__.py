"""Planners: from a costmap, a start and a goal to a `Path`."""

from trundle.planning.planner import Planner, create_planner, planner_names

__all__ = ["Planner", "create_planner", "planner_names"]
