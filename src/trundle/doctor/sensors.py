"""What a robot's sensors leave open: low things that its lidars do not see, and how wrong its odometry may be."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from trundle.navigation import NavigatorSettings
from trundle.robots import Lidar, Robot
from trundle.values import check_number

THINGS = (
    ("the base of a swivel chair", 0.11),
    ("a EUR pallet", 0.144),
    ("a kerb", 0.15),
    ("the forks of a forklift", 0.20),
    ("a low box", 0.30),
    ("a pallet truck's body", 0.40),
)
"""Common low objects, and the height of their top [m]; the pallet by EN 13698-1, the others typical."""


@dataclass(frozen=True, slots=True)
class LidarView:
    """The heights at which the robot could touch something that one of its lidars does not see.

    Attributes:
        lidar: Its name.
        height: Height of its beams above the floor [m].
        below: Heights [m, m] from the robot's underside to the beams: an object that ends there is not seen. None where
            the beams are no higher than the underside.
        above: Heights [m, m] from the beams to the robot's top: an object that begins there, such as a table's top, is
            not seen. None where the beams are no lower than the top.
        missed: Common objects that end below its beams and that the robot would touch.
        field_of_view: Directions that it covers [rad].
    """

    lidar: str
    height: float
    below: tuple[float, float] | None
    above: tuple[float, float] | None
    missed: tuple[str, ...]
    field_of_view: float

    @property
    def message(self) -> str:
        """Sentence that describes the view."""
        texts = [f"{self.lidar}: its beams are {self.height:.3g} m above the floor"]
        if self.below is not None:
            low, high = self.below
            names = f", such as {', '.join(self.missed)}" if self.missed else ""
            texts.append(f"it does not see what is between {low:.3g} and {high:.3g} m high{names}")
        if self.above is not None:
            low, high = self.above
            no = "it does not see" if self.below is None else "nor"
            texts.append(f"{no} what hangs between {low:.3g} and {high:.3g} m, such as a table's top")
        if self.field_of_view < 2.0 * math.pi - 1e-6:
            texts.append(f"it covers {math.degrees(self.field_of_view):.0f}°")
        return "; ".join(texts)


def view_of_lidars(robot: Robot) -> tuple[LidarView, ...]:
    """Return what each of a robot's lidars cannot see. Heights are those on a level floor."""
    return tuple(_view(name, lidar, robot) for name, lidar in robot.lidars.items())


def _view(name: str, lidar: Lidar, robot: Robot) -> LidarView:
    under, top, height = robot.body.clearance, robot.body.height, lidar.z
    return LidarView(
        name,
        height,
        (under, height) if under < height else None,
        (height, top) if height < top else None,
        tuple(thing for thing, end in THINGS if under < end < height),
        lidar.fov,
    )


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
