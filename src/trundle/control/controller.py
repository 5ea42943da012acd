"""The seam that every controller stands behind, and the controllers by name."""

from __future__ import annotations

from typing import Any, Protocol, runtime_checkable

from trundle.costmap import Costmap
from trundle.geometry import Pose2D, Twist2D
from trundle.path import Path
from trundle.registry import Registry
from trundle.robots import Robot

CONTROLLERS: Registry[Controller] = Registry(
    "controller",
    "trundle.controllers",
    {
        "regulated_pure_pursuit": "trundle.control.regulated_pure_pursuit:RegulatedPurePursuit",
        "blog": "trundle.control.waypoint_follower:BlogFollower",
    },
)


@runtime_checkable
class Controller(Protocol):
    """Follows a path. A class behind a name is made with the robot first: `RegulatedPurePursuit(robot, **options)`.

    It may also have `set_speed_limit(limit)`, by which a `Navigator` tells it before each command how fast it may drive
    now [m/s], infinity for as fast as it likes; the navigator slows the commands of one that has not.
    """

    def set_path(self, path: Path) -> None:
        """Follow this path from now on, from its beginning."""
        ...

    def compute_velocity(self, pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float) -> Twist2D:
        """Return the command for the next control period of `dt` [s].

        Args:
            pose: Where the robot is, map frame.
            twist: How it moves now, base_link.
            costmap: What to stay clear of.
            dt: Length of the control period [s].

        Returns:
            A twist within the robot's speed limits. It is (0, 0) where every way on is blocked.
        """
        ...


def controller_names() -> list[str]:
    """Names that `create_controller` takes, sorted."""
    return CONTROLLERS.names()


def create_controller(controller: str | Controller, robot: Robot, **options: Any) -> Controller:
    """Make a controller for a robot from its name and options, or take one as it is.

    Raises:
        UnknownNameError: If there is no controller of that name.
        InputError: If it does not take these options, or is no controller.
    """
    return CONTROLLERS.take(controller, "compute_velocity", robot, **options)
