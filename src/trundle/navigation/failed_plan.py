"""`FailedPlan`: a plan that found no path, and whether another one would find one now."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trundle.costmap import INSCRIBED, LETHAL, Costmap
from trundle.errors import PlanningError
from trundle.geometry import Goal, Pose2D, wrap_angle
from trundle.planning import Planner

_NEAR_M, _NEAR_RAD = 0.1, 0.1
"""A start so near is in the same or the next of the states of hybrid A*, which are 0.1 m and 5° wide."""


@dataclass(frozen=True, slots=True)
class FailedPlan:
    """A plan that found no path.

    Attributes:
        error: Why.
        planner: What planned.
        start: From where.
        goals: To where.
        costmap: Where.
    """

    error: PlanningError
    planner: Planner
    start: Pose2D
    goals: tuple[Goal, ...]
    costmap: Costmap

    def holds(self, start: Pose2D, goals: tuple[Goal, ...], costmap: Costmap, *, noisy: bool) -> bool:
        """Whether a plan from here would fail, too: the robot has hardly moved, and nothing has become free.

        Args:
            start: Where the robot is.
            goals: Where it is to go.
            costmap: Now.
            noisy: Whether the costmap holds what was sensed: then single cells come and go at every surface, and only
                room for the robot's centre in a square of 3 × 3 cells counts.
        """
        return (
            goals == self.goals
            and start.distance_to(self.start) <= _NEAR_M
            and abs(wrap_angle(start.yaw - self.start.yaw)) <= _NEAR_RAD
            and not _is_freer(costmap, self.costmap, noisy=noisy)
        )


def _is_freer(costmap: Costmap, before: Costmap, *, noisy: bool) -> bool:
    """Whether a costmap has room that was occupied or unknown before, or lies elsewhere."""
    if costmap is before:
        return False
    if costmap.shape != before.shape or costmap.origin != before.origin or costmap.resolution != before.resolution:
        return True
    if not noisy:
        return bool(((costmap.data < LETHAL) & (before.data >= LETHAL)).any())
    freed = (costmap.data < INSCRIBED) & (before.data >= INSCRIBED)
    rows, cols = np.flatnonzero(freed.any(axis=1)), np.flatnonzero(freed.any(axis=0))
    if len(rows) == 0:
        return False
    freed = freed[rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1]
    freed = freed[2:] & freed[1:-1] & freed[:-2]
    return bool((freed[:, 2:] & freed[:, 1:-1] & freed[:, :-2]).any())
