"""`Policy`: a learned policy in an ONNX file, as an agent."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import cast

import numpy as np
import numpy.typing as npt

from trundle.control import GoalChecker
from trundle.errors import InputError, PlanningError
from trundle.geometry import Goal, Pose2D, Twist2D, wrap_angle
from trundle.navigation.agent import CONTROL_PERIOD_S, Agent, AgentInfo, AgentReport
from trundle.navigation.policies.policy_file import SHORTEST_PERIOD_S, PolicyFile
from trundle.navigation.progress import FollowedPath
from trundle.navigation.state import FINAL, NavigationStatus
from trundle.observation import Estimate, Observation, Scan
from trundle.robots import Lidar, Robot

Floats = npt.NDArray[np.float32]

FARTHEST_GOAL_M = 200.0
"""Goals farther away are observed at this distance [m], as in `trundle.gym`."""

PATH_SPACING_M = 0.5
"""Length of path from one observed point to the next [m], as in `trundle.gym`."""

_REPLAN_S = 1.0  # Nav2's period; the robot leaves the path to go around what the map lacks

_BLIND_S = 2.0
"""Without a scan for this long at the start [s], there will be none."""

_NO_MAP = "follows a path, and there is no map to plan it on"

_TURNING_GAIN = 2.0  # [1/s]: a goal's yaw is reached without overshoot at control periods of up to 0.5 s


class Policy(Agent):
    """Drives as a network says that observes what `trundle.gym` does: ranges, goal, velocity and path.

    The network computes an action once in its own period, which is held in between. A period that physics steps do not
    divide is kept on average. Near the goal its speed is limited
    to what lets the robot stop there. In the tolerance of the goal the robot stops, and turns to the goal's yaw where
    it has one.

    The path is that of the navigator's planner, on its map without what scans see, planned again each second.

    Args:
        robot: The robot.
        file: The ONNX file; its metadata say what the policy observes, see `PolicyFile`.
        navigator: Whose goal checker, map, costmap and planner it has, in a scenario.

    Attributes:
        file: The file's content.
        lidars: The lidars whose scans it needs, by name.
        goal_checker: Says whether the goal is reached.
        status: DRIVING until it has ARRIVED; STUCK where it needs scans and gets none, or a path and has
            no map; NO_PATH where the planner finds none.

    Raises:
        InputError: If the file is no policy for this robot, or needs a path and there is no map to plan on.
        MissingExtraError: If onnxruntime is not installed.
    """

    def __init__(self, robot: Robot, *, file: str, navigator: Agent | None = None) -> None:
        self.file = PolicyFile.load(file)
        self._robot = robot
        self.lidars: Mapping[str, Lidar] = _choose_lidars(self.file, robot)
        own = AgentInfo("policy") if navigator is None else navigator.info()
        self.goal_checker = GoalChecker() if own.goal_checker is None else own.goal_checker
        name = self.file.path.name
        self._needs_path = "path" in self.file.observations
        self._planner = navigator if self._needs_path else None
        if self._planner is not None and own.grid is None:
            raise InputError(f"{self.file.path}: the policy {_NO_MAP}: use it in a scenario whose map is known")
        planner = "none" if self._planner is None else own.planner
        self._info = replace(own, controller=name, planner=planner, goal_checker=self.goal_checker, plugins=())
        self.dt = _control_period(self.file.period)
        self.reset()

    def __repr__(self) -> str:
        return f"Policy({self.file.path.name}, {self.status.value})"

    def info(self) -> AgentInfo:
        """Return which file it drives by."""
        return self._info

    def report(self, *, rollouts: bool = False) -> AgentReport:
        """Return what it is doing, and why it is stuck."""
        followed = self._followed
        path, left_m = (None, None) if followed is None else (followed.path, followed.left_m)
        return AgentReport(self.status, self._message, self._error, path, left_m)

    def reset(self, *, seed: int = 0) -> None:
        """Forget the goal and the scans, and set the recurrent state to zeros."""
        self.status = NavigationStatus.IDLE
        self._goal: Goal | None = None
        self._message = ""
        self._scans: dict[str, Scan] = {}
        self._states = self.file.zero_states()
        self._began_s: float | None = None
        self._due_s = -math.inf
        self._action = Twist2D()
        self._followed: FollowedPath | None = None
        self._plan_due_s = -math.inf
        self._error: PlanningError | None = None

    def set_goal(self, goal: Goal | Pose2D, /) -> None:
        """Drive to this goal; the recurrent state stays."""
        self._goal = Goal.of(goal)
        self.status = NavigationStatus.DRIVING
        self._due_s = self._plan_due_s = -math.inf
        self._followed, self._error, self._message = None, None, ""

    def update(self, observation: Observation, estimate: Estimate, /) -> Twist2D:
        """Return the command for the next control period.

        Raises:
            InputError: If the network computes what is no number.
        """
        self._scans |= {scan.lidar: scan for scan in observation.scans}
        goal = self._goal
        if goal is None or self.status in FINAL:
            return Twist2D()
        if self._waits_for_scans(observation.time):
            return Twist2D()
        checker, pose = self.goal_checker, estimate.pose
        if checker.is_within(pose, goal.pose, any_yaw=True):
            if checker.is_reached(pose, observation.twist, goal.pose, any_yaw=goal.yaw_free):
                self.status = NavigationStatus.ARRIVED
                return Twist2D()
            return self._turn_to_yaw(pose, observation.twist, goal)
        if observation.time >= self._due_s - 1e-6:
            if self._needs_path and not self._find_path(observation.time, pose, goal):
                return Twist2D()
            late = observation.time - self._due_s
            # Periods follow one another without drift; after a pause they begin again.
            self._due_s = (self._due_s if late < self.file.period else observation.time) + self.file.period
            self._action = self._ask(observation.twist, pose, goal)
        return self._slow_down(self._action, math.hypot(goal.x - pose.x, goal.y - pose.y))

    def _waits_for_scans(self, time: float) -> bool:
        """Return whether a lidar that it needs has not measured yet; after a while that is an end."""
        missing = [name for name in self.lidars if name not in self._scans]
        if not missing:
            return False
        self._began_s = time if self._began_s is None else self._began_s
        if time - self._began_s > _BLIND_S:
            self.status = NavigationStatus.STUCK
            self._message = f"the policy {self.file.path.name} needs scans of the lidar {missing[0]}: give lidar: true"
        return True

    def _turn_to_yaw(self, pose: Pose2D, twist: Twist2D, goal: Goal) -> Twist2D:
        """Stop; and once the robot stands, turn to the yaw of the goal."""
        if goal.yaw_free or abs(twist.v) > self.goal_checker.stopped_linear:
            return Twist2D()
        error = wrap_angle(goal.yaw - pose.yaw)
        if abs(error) <= 0.5 * self.goal_checker.yaw_tolerance:
            return Twist2D()
        most = self._robot.limits.angular_speed
        return Twist2D(0.0, min(max(_TURNING_GAIN * error, -most), most))

    def _slow_down(self, action: Twist2D, distance: float) -> Twist2D:
        """Keep the curvature of an action, and no more speed than lets the robot stop at the goal."""
        most = math.sqrt(2.0 * self._robot.limits.linear_acceleration * distance)
        share = min(1.0, most / max(abs(action.v), 1e-9))
        return Twist2D(action.v * share, action.w * share)

    def _find_path(self, time: float, pose: Pose2D, goal: Goal) -> bool:
        """Find its place on the path, which is planned when due; return False where none is known."""
        if self._planner is None:
            self.status = NavigationStatus.STUCK
            self._message = f"the policy {self.file.path.name} {_NO_MAP}: give it a navigator with a map"
            return False
        if time >= self._plan_due_s - 1e-6:
            self._plan_due_s = time + _REPLAN_S
            try:
                planned = self._planner.plan_between(pose, goal)
            except PlanningError as error:
                # Beside a box that the map lacks, the robot may stand where the map has no room; it drives on.
                if self._followed is None:
                    self.status, self._error, self._message = NavigationStatus.NO_PATH, error, str(error)
                    return False
                planned = None
            if planned is not None:
                self._followed, self._message = FollowedPath(planned, planned), ""
        if self._followed is None:
            self._message = "waiting for a path: planning took too long"
            return False
        self._followed.advance(pose)
        return True

    def _path_ahead(self, pose: Pose2D) -> Floats:
        """Return points of the path ahead, base_link [m], shape (points, 2)."""
        points = np.zeros((self.file.path_points, 2), dtype=np.float32)
        if self._followed is None:
            return points
        check = self._followed.check
        begin = float(check.along[self._followed.index])
        for number in range(len(points)):
            at = int(check.along.searchsorted(begin + PATH_SPACING_M * (number + 1)))
            points[number] = check.poses[min(at, len(check.poses) - 1), :2]
        points[:] = pose.inverse().transform_points(points)
        return points

    def _ask(self, twist: Twist2D, pose: Pose2D, goal: Goal) -> Twist2D:
        values: dict[str, Floats] = {}
        if "ranges" in self.file.observations:
            values["ranges"] = np.concatenate([self._ranges(name) for name in self.lidars])
        dx, dy = goal.x - pose.x, goal.y - pose.y
        distance, direction = math.hypot(dx, dy), math.atan2(dy, dx) - pose.yaw
        values["goal"] = np.array(
            [min(distance, FARTHEST_GOAL_M), math.cos(direction), math.sin(direction)], dtype=np.float32
        )
        values["velocity"] = np.array([twist.v, twist.w], dtype=np.float32)
        values["path"] = self._path_ahead(pose)
        action, self._states = self.file.act(values, self._states)
        if not np.isfinite(action).all():
            raise InputError(
                f"the policy {self.file.path} commanded {action.tolist()} at ({pose.x:.2f}, {pose.y:.2f}): actions "
                "must be finite; train it again, or look at its normalisation"
            )
        v, w = self.file.command_of(action)
        return Twist2D(v, w)

    def _ranges(self, lidar: str) -> Floats:
        """Return ranges of the policy's beams, each of the measured beam nearest in direction, up to its reach [m]."""
        scan, count = self._scans[lidar], self.file.beams
        picked = _nearest_beams(scan, self.lidars[lidar].model_copy(update={"beams": count}).angles)
        ranges = np.where(np.isnan(scan.ranges), self.file.reach, scan.ranges)[picked]
        return np.clip(ranges, scan.range_min, self.file.reach).astype(np.float32)


def _control_period(period: float) -> float:
    """Return the longest control period of whole physics steps that divides a policy's period, else one step [s]."""
    steps = round(period / SHORTEST_PERIOD_S)
    if abs(steps * SHORTEST_PERIOD_S - period) > 1e-6:
        return SHORTEST_PERIOD_S
    most = round(CONTROL_PERIOD_S / SHORTEST_PERIOD_S)
    return max(each for each in range(1, most + 1) if steps % each == 0) * SHORTEST_PERIOD_S


def _choose_lidars(file: PolicyFile, robot: Robot) -> dict[str, Lidar]:
    """Return the lidars that a policy observes: those that it names, or the robot's first."""
    if "ranges" not in file.observations:
        return {}
    if not robot.lidars:
        raise InputError(f"{file.path}: the policy needs a lidar, and the robot {robot.name} has none")
    names = file.lidars or tuple(robot.lidars)[:1]
    for name in names:
        if name not in robot.lidars:
            has = ", ".join(robot.lidars)
            raise InputError(f"{file.path}: the policy observes the lidar {name!r}; {robot.name} has: {has}")
    file.check_beams(len(names))
    return {name: robot.lidars[name] for name in names}


def _nearest_beams(scan: Scan, wanted: npt.NDArray[np.float64]) -> npt.NDArray[np.int64]:
    """Return the index of the measured beam nearest to each direction."""
    turn = 2.0 * math.pi
    order = np.argsort(scan.angles % turn)
    angles = scan.angles[order] % turn
    # Repeated on both sides, so that a direction near 0 finds a beam near a full turn.
    around = np.concatenate([angles[-1:] - turn, angles, angles[:1] + turn])
    at = np.searchsorted(around, wanted % turn)
    at = np.clip(at, 1, len(around) - 1)
    at -= (wanted % turn) - around[at - 1] < around[at] - (wanted % turn)
    return cast("npt.NDArray[np.int64]", order[(at - 1) % len(order)])
