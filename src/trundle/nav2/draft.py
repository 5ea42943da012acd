"""`Draft`: parameters that are being written, and what of the scenario they leave out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeAlias, cast

from trundle.files.yaml_config import Plain
from trundle.messages.codec import Distro
from trundle.mission import Scenario
from trundle.nav2.names import plugin_for
from trundle.nav2.notes import Remark
from trundle.robots import Robot

Block: TypeAlias = dict[str, Plain]

NOT_IN_CONTROLLER = "Nav2's controller has nothing like it"

_GOAL = "a program sends goals: /goal_pose, or an action"
_WORLD = "of the simulation, not of Nav2"
_TREE = "Nav2's behavior tree says when it plans again"
_PATIENCE = "Nav2 plans again and recovers as its behavior tree says"

REASONS = {
    "goal": _GOAL,
    "goals": _GOAL,
    "through": _GOAL,
    "through_tolerance": "Nav2's behavior tree has the radius at which a goal is passed",
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
    "lidar_errors": _WORLD,
    "map_errors": _WORLD,
    "start_error": _WORLD,
    "rules": _WORLD,
    "directives": _WORLD,
    "record": _WORLD,
    "seed": _WORLD,
    "time_limit_s": _WORLD,
}
"""Fields without counterpart, and why."""


class Draft:
    """Collects parameters by node, for one scenario.

    Args:
        scenario: The scenario.
        robot: The robot as its software takes it.
        distro: The distribution whose names are written.

    Attributes:
        nodes: The parameters, by node.
        remarks: What has no counterpart, or has another meaning.
    """

    def __init__(self, scenario: Scenario, robot: Robot, distro: Distro) -> None:
        self.scenario, self.robot = scenario, robot
        self.distro: Distro = distro
        self.nodes: dict[str, Block] = {}
        self.remarks: list[Remark] = []

    @property
    def lidars(self) -> tuple[str, ...]:
        """Names of the lidars that are in use: all of the robot's, where the scenario does not choose some.

        A scenario without lidars knows the robot's true pose; Nav2 has nothing else to go by.
        """
        chosen = self.scenario.lidar
        return tuple(self.robot.lidars) if isinstance(chosen, bool) else chosen

    def plugin(self, name: str) -> str:
        """Return a plugin's name as the distribution writes it."""
        return plugin_for(name, self.distro)

    def changed(self, name: str, value: object, text: str) -> None:
        """Note that a setting means something else in Nav2."""
        self.remarks.append(Remark("changed", "", name, cast("Plain", value), text))

    def left_out(self, name: str, value: object, text: str) -> None:
        """Note that a setting has no counterpart."""
        self.remarks.append(Remark("no counterpart", "", name, cast("Plain", value), text))

    def leave_options(
        self, what: str, options: Mapping[str, object], written: set[str], defaults: Mapping[str, object], text: str
    ) -> None:
        """Note the options that were not written, except for those that have their default."""
        for name, value in options.items():
            if name not in written and value != defaults.get(name, object()):
                self.left_out(f"{what}.{name}", value, text)


def note_leftovers(draft: Draft) -> None:
    """Note each of the `REASONS` whose setting does not have its default."""
    plain = draft.scenario.plain()
    for name, reason in REASONS.items():
        if getattr(draft.scenario, name) != Scenario.model_fields[name].get_default(call_default_factory=True):
            draft.left_out(name, str(plain.get(name)), reason)
