"""The parameters of Nav2 that are settings of trundle under another name or in another unit: one row for both ways.

What needs more than that, such as a remark or a value of the robot, is code in the file of its part of Nav2.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import NamedTuple

from trundle.nav2.parameters import NodeParameters


class Row(NamedTuple):
    """A number of Nav2 and the setting that it stands for.

    Attributes:
        parameter: Its name in Nav2.
        setting: Name of the setting, or of the option of a planner or controller.
        default: Nav2's default, which counts where a file does not give the parameter.
        least, above, most: What a file may give: at least, above, and at most this.
    """

    parameter: str
    setting: str
    default: float
    least: float = -math.inf
    above: float = -math.inf
    most: float = math.inf


class Weight(NamedTuple):
    """A critic's weight and its counterpart, each with the value that means as much as the other's.

    Nav2's weights are for costs of many units, trundle's for metres of path. So they are converted by their share of
    the value that each has in the parameters that Nav2 ships and in trundle's defaults: twice as much stays so.

    Attributes:
        critic: Nav2's critic.
        parameter: Name of its weight.
        usual: The weight in the parameters that Nav2 ships.
        setting: Name of the option of `mppi`.
        default: The option's default.
    """

    critic: str
    parameter: str
    usual: float
    setting: str
    default: float

    def to_setting(self, value: float) -> float:
        """Return trundle's weight for Nav2's."""
        return round(value / self.usual * self.default, DIGITS)

    def to_parameter(self, value: float) -> float:
        """Return Nav2's weight for trundle's."""
        return round(value / self.default * self.usual, DIGITS)


class Switched(NamedTuple):
    """A distance of Nav2 that a flag switches off, and the setting that is 0 then.

    Attributes:
        parameter: Its name in Nav2, and that of the setting.
        switch: The flag, on by default.
        default: Nav2's default.
    """

    parameter: str
    switch: str
    default: float


DIGITS = 9
"""Converted weights are rounded to so many digits, so that they come back as they were."""

PURSUIT = (
    Row("lookahead_dist", "lookahead_dist", 0.6, least=0.0),
    Row("rotate_to_heading_min_angle", "rotate_to_heading_min_angle", 0.785, least=0.0),
    Row("rotate_to_heading_angular_vel", "rotate_to_heading_angular_vel", 1.8, least=0.0),
    Row("regulated_linear_scaling_min_speed", "regulated_linear_scaling_min_speed", 0.25, least=0.0),
    Row("approach_velocity_scaling_dist", "approach_velocity_scaling_dist", 0.6, least=0.0),
    Row("min_approach_linear_velocity", "min_approach_linear_velocity", 0.05, least=0.0),
)
"""Regulated pure pursuit."""

PURSUIT_SWITCHED = (
    Switched("regulated_linear_scaling_min_radius", "use_regulated_linear_velocity_scaling", 0.9),
    Switched("cost_scaling_dist", "use_cost_regulated_linear_velocity_scaling", 0.6),
)
"""Where regulated pure pursuit slows down."""

MPPI_LIMITS = (
    Row("vx_std", "vx_std", 0.2, above=0.0),
    Row("wz_std", "wz_std", 0.4, above=0.0),
    Row("vx_max", "vx_max", 0.5, above=0.0),
    Row("wz_max", "wz_max", 1.9, above=0.0),
    Row("ax_max", "ax_max", 3.0, above=0.0),
    Row("az_max", "az_max", 3.5, above=0.0),
)
"""MPPI's samples. Where a scenario does not give them, those of the robot are written."""

GOAL_ANGLE = (Row("threshold_to_consider", "threshold_to_consider", 0.5, above=0.0),)
"""MPPI's GoalAngleCritic, besides its weight."""

WEIGHTS = (
    Weight("ConstraintCritic", "cost_weight", 4.0, "constraint_weight", 10.0),
    Weight("GoalCritic", "cost_weight", 5.0, "goal_weight", 1.0),
    Weight("GoalAngleCritic", "cost_weight", 3.0, "goal_angle_weight", 1.0),
    Weight("PathAngleCritic", "cost_weight", 2.0, "path_angle_weight", 1.0),
    Weight("PreferForwardCritic", "cost_weight", 5.0, "prefer_forward_weight", 2.0),
    Weight("TwirlingCritic", "twirling_cost_weight", 10.0, "twirling_weight", 0.02),
    Weight("CostCritic", "cost_weight", 3.81, "repulsion_weight", 4.0),
    Weight("CostCritic", "collision_cost", 1_000_000.0, "collision_cost", 100.0),
    Weight("ObstaclesCritic", "repulsion_weight", 1.5, "repulsion_weight", 4.0),
    Weight("ObstaclesCritic", "collision_cost", 100_000.0, "collision_cost", 100.0),
)
"""Every weight of MPPI's critics that has a counterpart."""

PROGRESS = (
    Row("required_movement_radius", "required_movement_radius", 0.5, least=0.0),
    Row("movement_time_allowance", "movement_time_allowance", 10.0, least=0.0),
)
"""The progress checker."""

GOAL = (
    Row("xy_goal_tolerance", "goal_tolerance", 0.25, least=0.0),
    Row("yaw_goal_tolerance", "goal_yaw_tolerance", 0.25, least=0.0),
)
"""The goal checker."""

SMAC = (
    Row("reverse_penalty", "reverse_penalty", 2.0, least=1.0, most=1e3),
    Row("cost_penalty", "cost_weight", 2.0, least=0.0, most=1e3),
    Row("tolerance", "goal_tolerance", 0.25, least=0.0, most=1e4),
)
"""The Smac planners of poses, Hybrid-A* and the lattice."""

TURNING_RADIUS = (Row("minimum_turning_radius", "minimum_turning_radius", 0.4, least=0.01, most=1e4),)
"""Smac's Hybrid-A* and the constrained smoother."""

INFLATION = (
    Row("inflation_radius", "inflation_radius", 0.55, least=0.0),
    Row("cost_scaling_factor", "cost_scaling_factor", 10.0, least=0.0),
)
"""The inflation layer."""

RANGES = (
    Row("obstacle_max_range", "obstacle_max_range", 2.5, least=0.0),
    Row("obstacle_min_range", "obstacle_min_range", 0.0, least=0.0),
    Row("raytrace_max_range", "raytrace_max_range", 3.0, least=0.0),
    Row("raytrace_min_range", "raytrace_min_range", 0.0, least=0.0),
)
"""A source of an obstacle layer."""

SLOWDOWN = (Row("slowdown_ratio", "slowdown_ratio", 0.5, above=0.0, most=1.0),)
"""A zone of the collision monitor in which the robot slows down."""

APPROACH = (
    Row("time_before_collision", "time_before_collision", 2.0, least=0.0),
    Row("simulation_time_step", "simulation_time_step", 0.1, above=0.0),
)
"""A zone of the collision monitor that keeps a time to the collision."""

AMCL = (
    Row("alpha1", "alpha1", 0.2, least=0.0, most=10.0),
    Row("alpha2", "alpha2", 0.2, least=0.0, most=10.0),
    Row("alpha3", "alpha3", 0.2, least=0.0, most=10.0),
    Row("alpha4", "alpha4", 0.2, least=0.0, most=10.0),
    Row("alpha5", "alpha5", 0.2, least=0.0, most=10.0),
    Row("z_hit", "z_hit", 0.5, least=0.0, most=1.0),
    Row("z_rand", "z_rand", 0.5, least=0.0, most=1.0),
    Row("sigma_hit", "sigma_hit", 0.2, least=0.005, most=10.0),
    Row("pf_err", "pf_err", 0.05, above=0.0, most=1.0),
    Row("pf_z", "pf_z", 0.99, least=0.0, most=10.0),
    Row("update_min_d", "update_min_d", 0.25, least=0.0, most=100.0),
    Row("update_min_a", "update_min_a", 0.2, least=0.0, most=10.0),
)
"""AMCL and trundle's `amcl`. Only what a file gives is read: trundle's own defaults are for its own filter."""


def read_given(rows: Iterable[Row], block: NodeParameters) -> dict[str, float]:
    """Read the settings that a block of parameters gives; no default counts.

    Raises:
        InputError: If a parameter is no number, or out of bounds.
    """
    given = [row for row in rows if block.has(row.parameter)]
    return read_rows(given, block)


def read_rows(rows: Iterable[Row], block: NodeParameters) -> dict[str, float]:
    """Read the settings that stand in a block of parameters, or their defaults in Nav2.

    Raises:
        InputError: If a parameter is no number, or out of bounds.
    """
    return {
        row.setting: block.number(row.parameter, row.default, least=row.least, above=row.above, most=row.most)
        for row in rows
    }


def write_rows(rows: Iterable[Row], settings: object) -> dict[str, float]:
    """Write the parameters that stand for settings, which are attributes of `settings`."""
    return {row.parameter: float(getattr(settings, row.setting)) for row in rows}


def read_switched(rows: Iterable[Switched], block: NodeParameters) -> dict[str, float]:
    """Read distances, or 0 where they are switched off.

    Raises:
        InputError: If a distance is no number or negative, or a switch is neither true nor false.
    """
    found: dict[str, float] = {}
    for row in rows:
        distance = block.number(row.parameter, row.default, least=0.0)
        found[row.parameter] = distance if block.flag(row.switch, True) else 0.0
    return found


def write_switched(rows: Iterable[Switched], settings: object) -> dict[str, float | bool]:
    """Write distances and their switches; one that is 0 is switched off, with Nav2's default."""
    found: dict[str, float | bool] = {}
    for row in rows:
        distance = float(getattr(settings, row.parameter))
        found |= {row.switch: distance > 0.0, row.parameter: distance if distance > 0.0 else row.default}
    return found
