"""The protocol of controllers, and the controllers by name."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol, runtime_checkable

from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.path import Path
from trundle.registry import Registry
from trundle.robots import Robot
from trundle.values import check_kind

CONTROLLERS: Registry[Controller] = Registry(
    "controller",
    "trundle.controllers",
    {
        "regulated_pure_pursuit": "trundle.control.regulated_pure_pursuit:RegulatedPurePursuit",
        "lookahead": "trundle.control.lookahead:LookaheadFollower",
        "mppi": "trundle.control.mppi.controller:MppiController",
    },
    removed={"blog": "was renamed; use lookahead"},
)


_ADDED = ("reset", "set_speed_limit")
_OPTIONAL = ("set_tracks", "rollouts")


@dataclass(frozen=True, slots=True)
class Rollouts:
    """What a controller that samples considered best in the last control period.

    Attributes:
        poses: (x, y, yaw) [m, m, rad], map frame, shape (N, T, 3).
        costs: Of each [m], shape (N,), the lowest first.
    """

    poses: FloatArray
    costs: FloatArray


@runtime_checkable
class Controller(Protocol):
    """Follows a path. A class behind a name is made with the robot first: `RegulatedPurePursuit(robot, **options)`.

    One of another package without `reset` or `set_speed_limit` works as well: `create_controller` wraps it. One that
    has `set_tracks(tracks)` gets what the navigator's scans show to move before each command: every
    `trundle.observation.Track`, predicted to now, map frame. One that has an `intent`, an `Intent` or None, is judged
    by the collision monitor by all that it means to command, and not as if its command were kept up. One that has a
    text `reason` says there why it makes no progress, empty while it does: the navigator counts and shows it. One that
    has `rollouts()` returns `Rollouts`, or none, for pictures.
    """

    def reset(self, *, seed: int = 0) -> None:
        """Forget the path and everything else, at the start of a run.

        The same seed and arguments give the same commands. The default does nothing, for controllers that keep nothing
        but the path and draw no random numbers.
        """

    def set_path(self, path: Path) -> None:
        """Follow this path from now on, from its beginning."""
        ...

    def set_speed_limit(self, limit: float) -> None:
        """Drive no faster than this [m/s] from now on; infinity takes the limit away.

        A `Navigator` with a speed mask calls it before each command. The default does nothing: the navigator slows
        commands that are too fast, on the same arc.
        """

    def compute_velocity(self, pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float) -> Twist2D:
        """Return the command for the next control period of `dt` [s].

        Args:
            pose: Where the robot is, map frame.
            twist: How it moves now, base_link.
            costmap: The obstacles.
            dt: Length of the control period [s].

        Returns:
            A twist within the robot's speed limits; (0, 0) without a path and at its end.

        Raises:
            NoValidControlError: If every command would cause a contact. A navigator takes (0, 0) before the goal for
                the same.
        """
        ...


def controller_names() -> list[str]:
    """Names that `create_controller` takes, sorted."""
    return CONTROLLERS.names()


def create_controller(controller: str | Controller, robot: Robot, **options: Any) -> Controller:
    """Make a controller for a robot from its name and options, or take one as it is.

    One that has no `reset` or no `set_speed_limit` is wrapped, so that it can be used like any other.

    Raises:
        UnknownNameError: If there is no controller of that name.
        InputError: If it does not take these options, or is no controller; or the robot is none.
    """
    check_kind(robot, Robot, "a controller's robot", "Robot.load(name) makes one")
    made = CONTROLLERS.take(controller, "compute_velocity", robot, **options)
    whole = all(callable(getattr(made, name, None)) for name in _ADDED)
    return made if whole else OlderController(made)


class OlderController(Controller):
    """Gives a controller without `reset` or `set_speed_limit` the whole protocol, with the defaults for those methods.

    Args:
        controller: The controller to wrap.

    Attributes:
        controller: The same.
    """

    def __init__(self, controller: Controller) -> None:
        self.controller = controller
        # Either may be there without the other.
        for name in (*_ADDED, *_OPTIONAL):
            if callable(own := getattr(controller, name, None)):
                setattr(self, name, own)

    def set_path(self, path: Path) -> None:
        """Follow this path from now on; see `Controller`."""
        self.controller.set_path(path)

    def compute_velocity(self, pose: Pose2D, twist: Twist2D, costmap: Costmap, dt: float) -> Twist2D:
        """Return the command for the next control period; see `Controller`."""
        return self.controller.compute_velocity(pose, twist, costmap, dt)
