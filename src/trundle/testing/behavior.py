"""The check that every behavior must pass."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from trundle.costmap import Costmap
from trundle.errors import BehaviorFailedError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation.behaviors import Behavior, BehaviorContext
from trundle.planning import Planner
from trundle.robots import Robot
from trundle.testing.conformance import expect

_DT = 0.05
_LONGEST_S = 600.0


def check_behavior(make: Callable[[], Behavior], *, robot: Robot | None = None) -> None:
    """Check that a behavior meets the contract of `trundle.navigation.behaviors.Behavior`.

    It runs in an open room, for a robot that follows every command within its limits. It has a name and a time
    allowance, and returns finite twists until it is done within that time, or raises `BehaviorFailedError` and no other
    error. Started again, after it ended or half way, it acts as when it was new. Two behaviors share no state.

    Args:
        make: Creates the behavior.
        robot: The robot; Nova Carter by default.

    Raises:
        ConformanceError: If a requirement is not met.
    """
    driven = Robot.load("nova_carter") if robot is None else robot
    behavior = make()
    expect(isinstance(behavior, Behavior), f"a behavior derives from Behavior; found: {type(behavior).__name__}")
    expect(bool(behavior.name), f"a behavior needs a name; found: {behavior.name!r}")
    allowed = float(behavior.time_allowance)
    expect(0.0 < allowed < math.inf, f"the time allowance of a behavior must be positive and finite; found: {allowed}")
    first = _run(behavior, driven, most=math.inf)
    expect(_run(make(), driven, most=math.inf) == first, "two behaviors must act the same; found: other commands")
    expect(_run(behavior, driven, most=math.inf) == first, "a behavior must act as new when it starts again")
    one, other = make(), make()
    _run(one, driven, most=2)
    expect(_run(other, driven, most=math.inf) == first, "two behaviors must share no state; found: other commands")
    expect(_run(one, driven, most=math.inf) == first, "a behavior that was interrupted must act as new")


def _run(behavior: Behavior, robot: Robot, *, most: float) -> list[Twist2D]:
    """Start it, and return its commands, `most` of them at most."""
    pose, twist, time, commands = Pose2D(4.0, 4.0, 0.5), Twist2D(), 0.0, list[Twist2D]()
    costmap, allowed = _open_room(robot), min(float(behavior.time_allowance), _LONGEST_S)
    try:
        behavior.start(_context(time, pose, twist, costmap, robot))
        while len(commands) < most:
            command = behavior.update(_context(time, pose, twist, costmap, robot))
            if command is None:
                break
            expect(isinstance(command, Twist2D), f"a behavior returns a Twist2D or None; found: {command!r}")
            commands.append(command)
            twist = robot.limits.approach(twist, command, _DT)
            pose, time = twist.integrate(pose, _DT), time + _DT
            expect(time <= allowed + _DT, f"a behavior must be done within its time allowance of {allowed:g} s")
    except BehaviorFailedError as error:
        expect(bool(str(error)), "a behavior that fails must say why")
    return commands


def _context(time: float, pose: Pose2D, twist: Twist2D, costmap: Costmap, robot: Robot) -> BehaviorContext:
    def replan(planner: Planner | None) -> None:
        raise BehaviorFailedError("there is no goal to plan to")

    return BehaviorContext(time, pose, twist, costmap, _DT, robot, sees=True, clear_costmap=_nothing, replan=replan)


def _nothing() -> None:
    """There is nothing to forget."""


def _open_room(robot: Robot) -> Costmap:
    return Costmap.from_grid(OccupancyGrid(np.zeros((160, 160), np.int8), 0.05), robot)
