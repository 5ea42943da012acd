"""Which parameters of Nav2 are settings of trundle under another name, or in another unit."""

from __future__ import annotations

from typing import NamedTuple


class Weight(NamedTuple):
    """A critic's weight and its counterpart, each with the value that means as much as the other's.

    Nav2's weights are for costs of many units, trundle's for metres of path. So they are converted by their share of
    the value that each has in the parameters that Nav2 ships and in trundle's defaults: twice as much stays so.
    """

    critic: str
    parameter: str
    usual: float
    setting: str
    default: float


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
"""Every weight that has a counterpart."""

OBSTACLES = ("CostCritic", "ObstaclesCritic")
"""The two critics of obstacles, of which one is used."""

DIGITS = 9
"""To which converted weights are rounded, so that they come back as they were."""


def to_setting(weight: Weight, value: float) -> float:
    """Trundle's weight for Nav2's."""
    return round(value / weight.usual * weight.default, DIGITS)


def to_parameter(weight: Weight, value: float) -> float:
    """Nav2's weight for trundle's."""
    return round(value / weight.default * weight.usual, DIGITS)
