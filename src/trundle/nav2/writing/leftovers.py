"""The settings of a scenario that Nav2 has no parameters for."""

from __future__ import annotations

from trundle.mission import Scenario
from trundle.nav2.writing.draft import Draft

_GOAL = "a program sends goals: /goal_pose, or an action"
_WORLD = "of the simulation, not of Nav2"
_TREE = "Nav2's behavior tree says when it plans again"
_PATIENCE = "Nav2 plans again and recovers as its behavior tree says"

REASONS = {
    "goal": _GOAL,
    "goals": _GOAL,
    "through": _GOAL,
    "through_tolerance": "Nav2's behavior tree has the radius at which a goal is passed",
    "localizer": "Nav2 has AMCL",
    "replan_interval_s": _TREE,
    "replan_margin": _TREE,
    "planning_deadline_s": "Nav2's Smac planners have max_planning_time",
    "replan_rate": "Nav2's Smac planners have max_iterations, for each plan alone",
    "replan_expansions": "Nav2's Smac planners have max_iterations, for each plan alone",
    "wait_s": _PATIENCE,
    "patience_s": _PATIENCE,
    "mover_patience_s": _PATIENCE,
    "map_options": _WORLD,
    "unmapped": _WORLD,
    "movers": _WORLD,
    "backend": _WORLD,
    "actuation": _WORLD,
    "latency": _WORLD,
    "odometry": _WORLD,
    "rules": _WORLD,
    "directives": _WORLD,
    "record": _WORLD,
    "seed": _WORLD,
    "time_limit_s": _WORLD,
}
"""Fields without counterpart, and why."""


def note_leftovers(draft: Draft) -> None:
    """Note each of them that does not have its default."""
    plain = draft.scenario.plain()
    for name, reason in REASONS.items():
        if getattr(draft.scenario, name) != Scenario.model_fields[name].get_default(call_default_factory=True):
            draft.left_out(name, str(plain.get(name)), reason)
