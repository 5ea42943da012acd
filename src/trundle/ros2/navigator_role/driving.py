"""NavigateToPose, NavigateThroughPoses and FollowPath."""

from __future__ import annotations

from typing import Any

import numpy as np

from trundle.errors import InputError, TrundleError
from trundle.geometry import FloatArray, Pose2D, wrap_angles
from trundle.mission import FollowPath, SetGoal, SetGoals, Step, TaskEnd
from trundle.mission.steering.goal_directives import MOST_GOALS, MOST_POSES
from trundle.ros2.actions import ActionGoal
from trundle.ros2.bad_input import BadInputError
from trundle.ros2.navigator_role.codes import driving_code, following_code, planning_code
from trundle.ros2.navigator_role.context import FrameError, Kit, ServedAction, poses_of

_SLOWEST_MPS = 0.01
"""As in Nav2: slower than this there is no estimate of the time that is left."""

_CONTROLLERS = ("", "FollowPath")
"""Names of Nav2's controller plugin that mean the controller in use; its own name does too."""

_SAME_PLACE_M = 1e-3
"""Poses of a path that are closer than this are one [m]."""

_ALONG_RAD = np.pi / 6.0
"""A leg points along a yaw that differs by less than this: paths of hybrid A* turn between their poses."""


class Navigation:
    """Reports on a drive to a goal, or through several.

    Args:
        kit: What actions work with.
        plans: The action of Nav2 that plans for it, whose error codes are sent.
        goals: The goals.
    """

    def __init__(self, kit: Kit, plans: str, goals: list[Pose2D]) -> None:
        self._kit, self._plans, self._goals = kit, plans, goals
        self._begun_s = self._passed_s = 0.0
        self._runs_before: int | None = None
        self._recoveries = 0

    def begin(self, time: float) -> None:
        """Take note that the robot drives from this time on [s]; a drive that another map interrupted goes on."""
        self._begun_s, self._runs_before = time - self._passed_s, None

    def feedback(self, step: Step) -> dict[str, Any]:
        """Return where the robot is, how far and how long it still drives, and how often it had to recover."""
        kit, recoveries = self._kit, sum(ran.recovery for ran in step.behaviors)
        goals = () if step.steering is None else step.steering.goals
        if self._runs_before is None:
            self._runs_before = recoveries - self._recoveries
        self._recoveries = max(0, recoveries - self._runs_before)
        self._passed_s = step.state.time - self._begun_s
        left_m = 0.0 if step.distance_remaining is None else step.distance_remaining
        speed = abs(step.state.twist.v if step.observation is None else step.observation.twist.v)
        return {
            "current_pose": kit.stamped(kit.beliefs.now.pose),
            "navigation_time": kit.duration(self._passed_s),
            "estimated_time_remaining": kit.duration(left_m / speed if speed > _SLOWEST_MPS else 0.0),
            "number_of_recoveries": self._recoveries,
            "distance_remaining": left_m,
            "number_of_poses_remaining": min(len(self._goals), max(0, len(goals) - step.goal)),
        }

    def refused(self, error: TrundleError) -> dict[str, Any]:
        """Return the result of a goal that cannot be reached, by the error of the plan to it."""
        name = planning_code(error, self._kit.beliefs.now.pose)
        return self._kit.failure(self._plans, name, str(error))

    def ended(self, end: TaskEnd) -> dict[str, Any]:
        """Return how the drive ended."""
        if end.result == "failed":
            action, name = driving_code(end, self._kit.beliefs.now.pose)
            return self._kit.failure(self._plans if action == "ComputePathToPose" else action, name, end.message)
        return {} if end.result in ("succeeded", "cancelled") else {"error_msg": end.message}


class Navigate(ServedAction):
    """Serves NavigateToPose, or NavigateThroughPoses. A second goal replaces the first, which is aborted.

    Args:
        kit: What actions work with.
        name: Name of the action on the network.
        through: Whether it drives through several poses.
    """

    def __init__(self, kit: Kit, name: str, *, through: bool) -> None:
        super().__init__(kit, name)
        self._through = through
        self._plans = "ComputePathThroughPoses" if through else "ComputePathToPose"

    def accepted(self, goal: ActionGoal) -> None:
        """Drive to the goal from now on."""
        kit = self._kit
        try:
            goals = self._read(goal.request)
        except FrameError as error:
            goal.abort(**kit.failure(self._plans, "TF_ERROR", str(error)))
            return
        except BadInputError as error:
            self._report("goal", error, error.kind)
            goal.abort(**kit.failure(self._plans, "UNKNOWN", str(error)))
            return
        except _RefusedError as error:
            goal.abort(**kit.failure(error.action, error.code, str(error)))
            return
        directive = SetGoals(goals) if self._through else SetGoal(goals[0])
        kit.tasks.drive.start(goal, Navigation(kit, self._plans, goals), directive, self._name)

    def _read(self, request: Any) -> list[Pose2D]:
        if request.behavior_tree:
            raise _RefusedError(
                f"trundle has no behavior trees, and cannot run {request.behavior_tree!r}: leave behavior_tree empty",
                "NavigateThroughPoses" if self._through else "NavigateToPose",
                "FAILED_TO_LOAD_BEHAVIOR_TREE",
            )
        stamped = poses_of(request.poses) if self._through else [request.pose]
        if not stamped:
            raise _RefusedError("there is no pose to drive through", self._plans, "NO_VIAPOINTS_GIVEN")
        if len(stamped) > MOST_GOALS:
            raise _RefusedError(f"{len(stamped)} poses are more than {MOST_GOALS}", self._plans, "UNKNOWN")
        beliefs = self._kit.beliefs
        return [beliefs.read(one, f"pose {number} of the goal") for number, one in enumerate(stamped, 1)]


class _RefusedError(InputError):
    """A goal that is refused.

    Args:
        message: Why.
        action: The action whose code it has.
        code: The name of the code.
    """

    def __init__(self, message: str, action: str = "", code: str = "UNKNOWN") -> None:
        super().__init__(message)
        self.action, self.code = action, code


class Following:
    """Reports on a path that is followed.

    Args:
        kit: What actions work with.
    """

    def __init__(self, kit: Kit) -> None:
        self._kit = kit

    def begin(self, time: float) -> None:
        """Do nothing: the feedback does not count the time."""

    def feedback(self, step: Step) -> dict[str, Any]:
        """Return how far the robot still drives, and how fast it is."""
        speed = step.state.twist.v if step.observation is None else step.observation.twist.v
        return {"distance_to_goal": step.distance_remaining or 0.0, "speed": speed}

    def refused(self, error: TrundleError) -> dict[str, Any]:
        """Return the result of a path that cannot be followed."""
        return self._kit.failure("FollowPath", "INVALID_PATH", str(error))

    def ended(self, end: TaskEnd) -> dict[str, Any]:
        """Return how the drive ended."""
        if end.result == "failed":
            return self._kit.failure("FollowPath", following_code(end), end.message)
        return {} if end.result in ("succeeded", "cancelled") else {"error_msg": end.message}


class Follow(ServedAction):
    """Serves FollowPath: the path is followed as it is, and nothing is planned."""

    def accepted(self, goal: ActionGoal) -> None:
        """Follow the path from now on."""
        kit = self._kit
        known = (*_CONTROLLERS, kit.context.mission.navigator.controller_name)
        if goal.request.controller_id not in known:
            text = f"there is no controller {goal.request.controller_id!r}: leave controller_id empty"
            goal.abort(**kit.failure("FollowPath", "INVALID_CONTROLLER", text))
            return
        try:
            directive = self._read(goal.request.path)
        except FrameError as error:
            goal.abort(**kit.failure("FollowPath", "TF_ERROR", str(error)))
            return
        except InputError as error:
            self._report("path", error, "no path")
            goal.abort(**kit.failure("FollowPath", "INVALID_PATH", str(error)))
            return
        kit.tasks.drive.start(goal, Following(kit), directive, self._name)

    def _read(self, path: Any) -> FollowPath:
        if not 0 < len(path.poses) <= MOST_POSES:
            raise InputError(f"a path has 1 to {MOST_POSES} poses, and this one has {len(path.poses)}")
        beliefs = self._kit.beliefs
        frame = path.header.frame_id
        for stamped in path.poses:
            stamped.header.frame_id = stamped.header.frame_id or frame
        poses = [beliefs.read(stamped, f"pose {number}").as_tuple() for number, stamped in enumerate(path.poses, 1)]
        return FollowPath(*drivable(np.array(poses)))


def drivable(poses: FloatArray) -> tuple[list[list[float]], list[bool]]:
    """Return the poses of a path as trundle drives it, and which legs are driven in reverse.

    Controllers of Nav2 look at the positions of a path, and at the yaw of its end. Many programs leave the other yaws
    at 0. They count only where every leg points along the yaws of its ends, or against them: then it is a path with
    legs in reverse, as hybrid A* gives.

    Args:
        poses: (x, y, yaw), shape (N, 3).
    """
    steps = np.hypot(*np.diff(poses[:, :2], axis=0).T)
    kept = poses[np.concatenate([[True], steps > _SAME_PLACE_M])] if len(poses) > 1 else poses
    if len(kept) == 1:
        kept = poses[[0, -1]] if len(poses) > 1 else poses
        return kept.tolist(), [False] * (len(kept) - 1)
    headings = np.arctan2(*np.diff(kept[:, 1::-1], axis=0).T)
    off = np.abs(wrap_angles(kept[:-1, 2] - headings))
    backward = off > np.pi - _ALONG_RAD
    if np.ptp(kept[:, 2]) == 0.0 or not (backward | (off < _ALONG_RAD)).all():
        backward = np.zeros(len(headings), np.bool_)
    made = kept.copy()
    made[:-1, 2] = np.where(backward, wrap_angles(headings + np.pi), headings)
    made[-1, 2] = poses[-1, 2]
    return made.tolist(), backward.tolist()
