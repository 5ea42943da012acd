"""What a navigator is given from outside, checked where it comes in: settings, the map, a goal, how the robot moves."""

from __future__ import annotations

import math
import numbers
import os
import warnings
from collections.abc import Sequence
from typing import NamedTuple, cast

from trundle.costmap import Costmap, CostmapSettings
from trundle.errors import InputError, RobotWarning
from trundle.geometry import Goal, Pose2D, Twist2D, wrap_angle
from trundle.maps import OccupancyGrid
from trundle.maps.masks import KeepoutMask
from trundle.observation import Estimate, Observation, Scan, check_scans
from trundle.robots import Robot
from trundle.values import as_number, as_sequence, check_kind, is_finite_number

UPDATE_TAKES = "update takes (pose, twist, time=…, scans=…) or (observation, estimate)"
_CREDIBLE = 4.0  # times its limits: so fast may a robot be that is pushed, or runs down a ramp


def load_costmap(
    grid: OccupancyGrid | Costmap | tuple[OccupancyGrid, Costmap] | str | os.PathLike[str] | None,
    robot: Robot,
    settings: CostmapSettings | None,
    keepout: KeepoutMask | str | os.PathLike[str] | None,
) -> tuple[OccupancyGrid | None, Costmap | None]:
    """Make the map (none where a costmap is given alone) and the costmap; both are none without a map.

    Raises:
        MapError: If a map or a mask cannot be read.
        InputError: If an option is settled in the costmap that is given.
    """
    if grid is None:
        if keepout is not None:
            raise InputError("a keep-out mask needs a map: give Navigator a grid too, or leave the mask out")
        return None, None
    cells: OccupancyGrid | None = None
    if isinstance(grid, tuple):
        cells, grid = grid
        check_kind(cells, OccupancyGrid, "the first of a navigator's map and costmap", "give (grid, costmap)")
        check_kind(grid, Costmap, "the second of a navigator's map and costmap", "give (grid, costmap)")
    if isinstance(grid, Costmap):
        if keepout is not None:
            raise InputError("a keep-out mask belongs into the costmap: Costmap.from_grid(…, keepout=mask)")
        if settings is not None:
            raise InputError("this costmap is made already: give a map and costmap=…, or Costmap.from_grid(…) alone")
        return cells, grid
    advice = "OccupancyGrid.from_world(world) makes one of a world"
    check_kind(grid, (OccupancyGrid, Costmap, str, os.PathLike), "a navigator's map", advice)
    cells = grid if isinstance(grid, OccupancyGrid) else OccupancyGrid.load(grid)
    zones = keepout if keepout is None or isinstance(keepout, KeepoutMask) else KeepoutMask.load(keepout)
    return cells, (settings or CostmapSettings()).make_costmap(cells, robot, keepout=zones)


def read_pose(pose: Pose2D | Sequence[float]) -> Pose2D:
    """Read the pose of a robot. The yaw of its odometry may have added up to more than a whole turn.

    Raises:
        InputError: If it is no pose.
    """
    if isinstance(pose, Pose2D):
        return pose
    numbers = as_sequence(pose)
    if len(numbers) == 3 and is_finite_number(numbers[2]):
        numbers = (numbers[0], numbers[1], wrap_angle(numbers[2]))
    return Pose2D.of(numbers)


class Given(NamedTuple):
    """What an update is given.

    Attributes:
        pose: Where the robot is, map frame.
        twist: How it moves, base_link; None where that is not known.
        time: Now [s]; None where that is not known.
        scans: Scans that arrived since the last update.
        estimate: Where a localizer believes the robot to be; None where the pose is given alone.
    """

    pose: Pose2D
    twist: Twist2D | None
    time: float | None
    scans: tuple[Scan, ...] = ()
    estimate: Estimate | None = None


def read_update(
    pose: object, twist: object, time: object, scans: Sequence[Scan], observation: object, estimate: object
) -> Given:
    """Read the arguments of `Navigator.update`: a pose and what goes with it; or an observation and an estimate.

    These two may be given by name, or by position as `pose` and `twist`.

    Raises:
        InputError: If something is missing, is of another kind or not finite, or is given twice.
    """
    kinds = (Observation, Estimate)
    if observation is None and estimate is None and not isinstance(pose, kinds) and not isinstance(twist, kinds):
        if pose is None:
            raise InputError(f"there is neither a pose nor an observation; {UPDATE_TAKES}")
        here = read_pose(cast("Pose2D | Sequence[float]", pose))
        now = None if time is None else as_number(time, "time")
        if now is not None and not math.isfinite(now):
            raise InputError(f"time must be a finite number of seconds, got {time!r}")
        return Given(here, cast("Twist2D | None", twist), now, check_scans(scans) if scans else ())
    if observation is None:
        observation, pose = pose, None
    if estimate is None:
        estimate, twist = twist, None
    if pose is not None or twist is not None:
        both = "a twist and an estimate" if pose is None else "a pose and an observation"
        raise InputError(f"there are both {both}; {UPDATE_TAKES}")
    check_kind(observation, Observation, "an update's observation", UPDATE_TAKES)
    check_kind(estimate, Estimate, "an update's estimate", UPDATE_TAKES)
    if time is not None or scans:
        raise InputError(f"an observation has its own time and scans: leave these out; {UPDATE_TAKES}")
    return read_observed(cast("Observation", observation), cast("Estimate", estimate))


def read_observed(observation: Observation, estimate: Estimate) -> Given:
    """Read an observation and an estimate, as a session gives them.

    Raises:
        InputError: If its time is not finite, or its scans are none.
    """
    time = as_number(observation.time, "time")
    if not math.isfinite(time):
        raise InputError(f"time must be a finite number of seconds, got {time!r}")
    scans = check_scans(observation.scans) if observation.scans else ()
    return Given(estimate.pose, observation.twist, time, scans, estimate)


def read_goal(goal: Pose2D | Sequence[float] | float, y: float | None = None, yaw: float | None = None) -> Goal:
    """Read a goal as `Navigator.set_goal` does.

    Raises:
        InputError: If these are not two or three finite numbers.
    """
    if isinstance(goal, numbers.Real):
        if y is None:
            raise InputError("set_goal needs x and y, and may take a yaw")
        x = cast("float", goal)
        return Goal(x, y, yaw)
    if y is not None or yaw is not None:
        raise InputError(f"set_goal takes x, y and a yaw as numbers, or one pose, got {(goal, y, yaw)!r}")
    return Goal.of(goal if isinstance(goal, Pose2D) else as_sequence(goal))


class CredibleTwist:
    """Cuts how the robot is said to move to what it can at all, with a warning the first time.

    Args:
        robot: The robot.
    """

    def __init__(self, robot: Robot) -> None:
        self._name, limits = robot.name, robot.limits
        self._v_most = _CREDIBLE * max(limits.linear_speed, limits.reverse_speed or 0.0)
        self._w_most = _CREDIBLE * limits.angular_speed
        self._has_warned = False

    def cut(self, twist: object) -> Twist2D:
        """Return how the robot moves; the warning is for what calls `update`.

        Raises:
            InputError: If it is no twist.

        Warns:
            RobotWarning: If it is cut, the first time.
        """
        if not isinstance(twist, Twist2D):
            raise InputError(f"how the robot moves is a Twist2D, got {twist!r}")
        v_most, w_most = self._v_most, self._w_most
        if abs(twist.v) <= v_most and abs(twist.w) <= w_most:
            return twist
        if not self._has_warned:
            self._has_warned = True
            warnings.warn(
                f"{self._name} cannot move by {twist.v:g} m/s and {twist.w:g} rad/s; these, and all others from now "
                f"on, are cut to {v_most:g} m/s and {w_most:g} rad/s: check the units of the twist and where it comes "
                "from",
                RobotWarning,
                stacklevel=4,
            )
        return Twist2D(min(v_most, max(-v_most, twist.v)), min(w_most, max(-w_most, twist.w)))
