"""Planners: from a costmap, a start and a goal to a `Path`."""

from trundle.planning.fields import cost_field
from trundle.planning.planner import Planner, create_planner, planner_names

__all__ = ["Planner", "cost_field", "create_planner", "planner_names"]
