"""The protocol of localizers, and the localizers by name."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate, Observation
from trundle.registry import Registry
from trundle.robots import Robot
from trundle.values import check_kind

LOCALIZERS: Registry[Localizer] = Registry(
    "localizer",
    "trundle.localizers",
    {"odometry": "trundle.localization.odometry:OdometryLocalizer"},
)


@runtime_checkable
class Localizer(Protocol):
    """Estimates a robot's pose. A class behind a name is made with map and robot: `AMCL(grid, robot, **options)`.

    It gets observations only, never the truth of a simulation.
    """

    def reset(self, pose: Pose2D, *, seed: int = 0) -> None:
        """Start over with the robot at `pose`, map frame. The same seed and observations give the same estimates."""
        ...

    def update(self, observation: Observation) -> Estimate:
        """Return where the robot is after one more observation; its time is the observation's.

        Raises:
            InputError: If the time of the observation is not after the last one.
        """
        ...


def localizer_names() -> list[str]:
    """Names that `create_localizer` takes, sorted."""
    return LOCALIZERS.names()


def create_localizer(localizer: str | Localizer, grid: OccupancyGrid | None, robot: Robot, **options: Any) -> Localizer:
    """Make a localizer from its name and options, or take one as it is.

    Args:
        localizer: A name, or a localizer.
        grid: The map; none where the robot has none.
        robot: The robot.
        options: Of the localizer.

    Raises:
        UnknownNameError: If there is no localizer of that name.
        InputError: If it does not take these options, is no localizer, or needs a map and there is none.
    """
    check_kind(robot, Robot, "a localizer's robot", "Robot.load(name) makes one")
    return LOCALIZERS.take(localizer, "update", grid, robot, **options)
