"""How far wrong the odometry of a robot without a localizer may be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from trundle.navigation import NavigatorSettings
from trundle.values import check_number

DISTANCES_M = (10.0, 30.0)
"""Lengths of short and long missions [m]."""

AMCL_BEARS = (0.05, math.radians(5.0))
"""What the localizer amcl corrects: errors of the distance, as a share, and of the heading [rad/m]. It was measured
with the suites of benchmarks/localization."""


@dataclass(frozen=True, slots=True)
class OdometryNeed:
    """The largest errors of odometry with which a robot reaches a goal by odometry alone.

    Either error alone brings the robot as far from the goal as the tolerance allows. A robot that has both needs less
    of each.

    Attributes:
        distance: Length of the mission [m].
        tolerance: The goal's [m].
        scale: Bias of the distance, as a share of it.
        heading: Bias of the heading per metre driven [rad/m].
    """

    distance: float
    tolerance: float
    scale: float
    heading: float

    @property
    def message(self) -> str:
        """Return a sentence that says so."""
        return (
            f"after {self.distance:g} m it is within {self.tolerance:g} m of its goal if the odometry is wrong by at "
            f"most {100.0 * self.scale:.2g} % of the distance or {math.degrees(self.heading):.2g}° per metre"
        )


def needed_odometry(
    distances: Sequence[float] = DISTANCES_M, *, tolerance: float | None = None
) -> tuple[OdometryNeed, ...]:
    """Compute how exact odometry must be for a robot without a localizer.

    On a straight line of length L, a share s of the distance is an error of s L. A heading that turns by h per metre
    bends the line to an arc, which ends h L² / 2 beside it. A path with turns ends no farther off.

    Args:
        distances: Lengths of missions [m].
        tolerance: The goal's [m]. If None, the default of runs.

    Raises:
        InputError: If a length or the tolerance is not a positive number.
    """
    off = NavigatorSettings().goal_tolerance if tolerance is None else tolerance
    check_number("tolerance", off, 1e-6, 1e6, "m")
    for distance in distances:
        check_number("distance", distance, 1e-3, 1e6, "m")
    return tuple(OdometryNeed(length, off, off / length, 2.0 * off / length**2) for length in distances)
