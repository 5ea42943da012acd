"""The check that every controller must pass."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import cast

import numpy as np

from trundle.control import Controller, Intent, Rollouts, create_controller
from trundle.control.controller import ControllerLike
from trundle.control.latency import Latency
from trundle.costmap import Costmap
from trundle.errors import InputError, NoValidControlError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.observation import Track
from trundle.path import Path
from trundle.robots import Robot
from trundle.testing.conformance import ConformanceError, accept, expect

_DT = 0.05
_SECONDS = 90.0
_FIRST_SECONDS = 3.0
_LIMIT_SHARE = 0.3
_THROUGH_TOLERANCE_M = 0.25


def check_controller(controller: ControllerLike, *, robot: Robot | None = None) -> None:
    """Check that a controller meets the contract of `trundle.control.Controller`.

    Without a path it commands zero, after a reset too. It follows a straight and a bent path to their ends in an open
    room. In front of a wall it commands zero or raises `NoValidControlError`, and no other error. It returns finite
    twists within the robot's speed limits, does not modify its arguments, is deterministic, and shares no state with
    other controllers. It accepts a speed limit, which it obeys or leaves to the navigator, and drops the limit when
    that is removed. Its optional members take what a navigator gives them and return what `Controller` says; those that
    it lacks have the defaults of `Controller`.

    Args:
        controller: A controller in any of the ways of `ControllerLike`, or a function that makes one for a robot.
        robot: The robot to drive; Nova Carter by default.

    Raises:
        ConformanceError: If a requirement is not met.
    """
    driven = Robot.load("nova_carter") if robot is None else robot
    grid = _empty_room()

    def make(robot: Robot) -> Controller:
        return accept(lambda given: create_controller(cast("ControllerLike", given), robot, grid), controller)

    try:
        _check(make, driven, Costmap.from_grid(grid, driven))
    except InputError as error:
        raise ConformanceError(str(error)) from error


def _check(make: Callable[[Robot], Controller], driven: Robot, costmap: Costmap) -> None:
    standing = make(driven).compute_velocity(Pose2D(0, 0), Twist2D(), costmap, _DT)
    expect(standing == Twist2D(), f"a controller without a path must command zero; found: {standing}")
    controller = make(driven)
    for path in (_path((0, 0), (3, 0)), _path((0, 0), (2, 0), (3, 2)), _path((0, 0), (-2, -2))):
        first = _follow(controller, path, driven, costmap)
        again = _follow(make(driven), path, driven, costmap)
        expect(
            first == again,
            f"a controller must act the same after another path as when new; found: {(first, again)}",
        )
    one, other = make(driven), make(driven)
    one.set_path(_path((0, 0), (3, 0)))
    command = other.compute_velocity(Pose2D(0, 0), Twist2D(), costmap, _DT)
    expect(command == Twist2D(), f"two controllers must not share a path; found: {command}")
    _check_speed_limit(make, driven, costmap)
    _check_reset(make, driven, costmap)
    _check_optional_members(make, driven, costmap)
    _check_wall(make, driven)


def _check_reset(make: Callable[[Robot], Controller], robot: Robot, costmap: Costmap) -> None:
    path = _path((0, 0), (2, 0), (3, 2))
    controller = make(robot)
    first = _first_commands(controller, path, robot, costmap)
    controller.reset(seed=0)
    again = _first_commands(controller, path, robot, costmap)
    expect(first == again, "a controller must act the same after a reset with the same seed; found: other commands")


def _check_optional_members(make: Callable[[Robot], Controller], robot: Robot, costmap: Costmap) -> None:
    """Tell it what a navigator tells it, first that there is nothing to tell, and ask what a navigator asks."""
    path = _path((0, 0), (3, 0))
    plain = _first_commands(make(robot), path, robot, costmap)
    told = make(robot)
    told.set_latency(Latency())
    told.set_tracks(())
    _check_reports(told)
    told.set_through((), _THROUGH_TOLERANCE_M)
    expect(
        _first_commands(told, path, robot, costmap) == plain,
        "a controller must act the same where the latency is zero, nothing moves and no pose is to be passed; found: "
        "other commands",
    )
    _check_reports(told)
    track = Track(1, 0.0, 4.0, 4.0, 0.1, 0.0, 0.01 * np.eye(4), 0.3, confirmed=True, moving=True)
    told.set_latency(Latency(scan_age_s=0.1, command_delay_s=0.1))
    told.set_tracks((track,))
    told.set_path(path)
    told.set_through((1.0, 2.0), _THROUGH_TOLERANCE_M)
    command = told.compute_velocity(path.start, Twist2D(), costmap, _DT)
    expect(
        math.isfinite(command.v) and math.isfinite(command.w),
        f"a command must be finite where something moves far away; found: {command}",
    )
    _check_reports(told)


def _check_reports(controller: Controller) -> None:
    intent, rollouts = controller.intent, controller.rollouts()
    expect(intent is None or isinstance(intent, Intent), f"intent must be an Intent or None; found: {intent!r}")
    expect(isinstance(controller.reason, str), f"reason must be a text; found: {controller.reason!r}")
    if rollouts is None:
        return
    expect(isinstance(rollouts, Rollouts), f"rollouts() must return Rollouts or None; found: {rollouts!r}")
    poses, costs = np.asarray(rollouts.poses), np.asarray(rollouts.costs)
    expect(
        poses.ndim == 3 and poses.shape[2] == 3 and costs.shape == poses.shape[:1],
        f"rollouts have poses of the shape (N, T, 3) and N costs; found: {poses.shape} and {costs.shape}",
    )
    expect(bool((np.diff(costs) >= 0.0).all()), "rollouts must be sorted, the lowest cost first; found: another order")


def _check_wall(make: Callable[[Robot], Controller], robot: Robot) -> None:
    """Face a wall right in front, with a path through it."""
    cells = np.zeros((240, 240), dtype=np.int8)
    grid = OccupancyGrid(cells, 0.05, Pose2D(-6.0, -6.0))
    front = float(robot.outline[:, 0].max())
    cells[:, int(grid.world_to_cell(front, 0.0)[1]) + 1 :] = 100
    costmap = Costmap.from_grid(OccupancyGrid(cells, 0.05, grid.origin), robot)
    controller = make(robot)
    controller.set_path(_path((0, 0), (3, 0)))
    for _ in range(round(_FIRST_SECONDS / _DT)):
        try:
            command = controller.compute_velocity(Pose2D(0, 0), Twist2D(), costmap, _DT)
        except NoValidControlError:
            continue
        except InputError:
            raise
        except Exception as error:
            raise ConformanceError(
                f"a controller without a valid control must raise NoValidControlError or command zero; found: {error!r}"
            ) from error
        finite = math.isfinite(command.v) and math.isfinite(command.w)
        expect(finite, f"a command must be finite in front of a wall; found: {command}")


def _check_speed_limit(make: Callable[[Robot], Controller], robot: Robot, costmap: Costmap) -> None:
    path = _path((0, 0), (3, 0))
    free = _first_commands(make(robot), path, robot, costmap)
    limited = make(robot)
    limited.set_speed_limit(_LIMIT_SHARE * robot.limits.linear_speed)
    commands = _first_commands(limited, path, robot, costmap)
    fastest = max(abs(command.v) for command in commands)
    kept = fastest <= _LIMIT_SHARE * robot.limits.linear_speed + 1e-9
    expect(kept or commands == free, f"a controller must obey or ignore a speed limit; found: {fastest} m/s")
    expect(
        any(command != Twist2D() for command in commands),
        "a controller must drive under a speed limit; it stopped",
    )
    limited.set_speed_limit(math.inf)
    expect(
        _first_commands(limited, path, robot, costmap) == free,
        "after its speed limit is removed, a controller must behave as if it never had one; found: other commands",
    )


def _first_commands(controller: Controller, path: Path, robot: Robot, costmap: Costmap) -> list[Twist2D]:
    """Commands in the first seconds on a path, with ideal motion."""
    controller.set_path(path)
    pose, twist, commands = path.start, Twist2D(), list[Twist2D]()
    for _ in range(round(_FIRST_SECONDS / _DT)):
        commands.append(controller.compute_velocity(pose, twist, costmap, _DT))
        twist = robot.limits.approach(twist, commands[-1], _DT)
        pose = twist.integrate(pose, _DT)
    return commands


def _empty_room() -> OccupancyGrid:
    return OccupancyGrid(np.zeros((240, 240), dtype=np.int8), 0.05, Pose2D(-6.0, -6.0))


def _path(*corners: tuple[float, float]) -> Path:
    """Return a polyline with the turns in place at its corners; it starts with yaw 0."""
    poses = [(*corners[0], 0.0)]
    for (x0, y0), (x1, y1) in itertools.pairwise(corners):
        yaw = math.atan2(y1 - y0, x1 - x0)
        poses += [(x0, y0, yaw), (x1, y1, yaw)]
    return Path(np.array(poses))


def _follow(controller: Controller, path: Path, robot: Robot, costmap: Costmap) -> Pose2D:
    """Drive with ideal motion within the robot's limits to the end of a path; return the final pose."""
    costs, poses = costmap.data.copy(), path.poses.copy()
    controller.set_path(path)
    pose, twist = path.start, Twist2D()
    for _ in range(round(_SECONDS / _DT)):
        command = controller.compute_velocity(pose, twist, costmap, _DT)
        finite = math.isfinite(command.v) and math.isfinite(command.w)
        expect(finite, f"a command must be finite; found: {command}")
        clamped = robot.limits.clamp(command)
        within = math.isclose(clamped.v, command.v, abs_tol=1e-9) and math.isclose(clamped.w, command.w, abs_tol=1e-9)
        expect(within, f"a command must be within the speed limits of {robot.name}; found: {command}")
        if command == Twist2D() and twist == Twist2D():
            break
        twist = robot.limits.approach(twist, command, _DT)
        pose = twist.integrate(pose, _DT)
    near = pose.distance_to(path.goal)
    expect(near <= 0.25, f"a controller must stop within 0.25 m of the path's end {path.goal}; found: {pose}")
    expect(twist == Twist2D(), f"a controller must stop the robot at the end; found: {twist}")
    expect(np.array_equal(costs, costmap.data), "a controller must not modify the costmap; found: other costs")
    expect(np.array_equal(poses, path.poses), "a controller must not modify the path; found: other poses")
    return pose
