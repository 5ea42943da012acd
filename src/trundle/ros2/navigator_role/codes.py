"""Nav2's error codes for what goes wrong in trundle: https://docs.nav2.org, nav2_msgs/action."""

from __future__ import annotations

from trundle.errors import BlockedPoseError, NoPathError, OutsideMapError, PlanningStoppedError, TrundleError
from trundle.geometry import Pose2D
from trundle.mission import TaskEnd
from trundle.navigation import NavigationStatus
from trundle.ros2.navigator_role.context import FrameError

_AT_START_M = 1e-6


def planning_code(error: TrundleError | None, start: Pose2D) -> str:
    """Return the name of the code of what a planner raised for a plan from this pose."""
    if isinstance(error, FrameError):
        return "TF_ERROR"
    if isinstance(error, OutsideMapError):
        return "START_OUTSIDE_MAP" if _is_at(error.pose, start) else "GOAL_OUTSIDE_MAP"
    if isinstance(error, BlockedPoseError):
        return "START_OCCUPIED" if _is_at(error.pose, start) else "GOAL_OCCUPIED"
    if isinstance(error, PlanningStoppedError):
        return {"timeout": "TIMEOUT", "exhausted": "NO_VALID_PATH"}.get(error.status, "UNKNOWN")
    return "NO_VALID_PATH" if isinstance(error, NoPathError) else "UNKNOWN"


def _is_at(pose: tuple[float, float, float] | None, start: Pose2D) -> bool:
    return pose is not None and abs(pose[0] - start.x) + abs(pose[1] - start.y) <= _AT_START_M


def driving_code(end: TaskEnd, start: Pose2D) -> tuple[str, str]:
    """Return action and name of the code of a drive that failed: its planner's, or its controller's."""
    if end.fault is not None:
        return "ComputePathToPose" if end.fault.kind in ("planner", "smoother") else "FollowPath", "UNKNOWN"
    if end.status is NavigationStatus.PLANNING_TIMED_OUT:
        return "ComputePathToPose", "TIMEOUT"
    if end.status is NavigationStatus.NO_PATH:
        return "ComputePathToPose", planning_code(end.error, start)
    return "FollowPath", following_code(end)


def following_code(end: TaskEnd) -> str:
    """Return the name of FollowPath's code of a drive that failed."""
    if end.status is not NavigationStatus.STUCK:
        return "UNKNOWN"
    blocked = end.message.startswith("blocked") or "no valid control" in end.message
    return "NO_VALID_CONTROL" if blocked else "FAILED_TO_MAKE_PROGRESS"


def behavior_code(end: TaskEnd) -> str:
    """Return the name of the code of a behavior that failed."""
    if end.message.startswith("it took longer than"):
        return "TIMEOUT"
    if "would touch something" in end.message:
        return "COLLISION_AHEAD"
    return "INVALID_INPUT" if "cannot reverse" in end.message else "UNKNOWN"
