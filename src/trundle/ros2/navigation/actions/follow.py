"""FollowPath."""

from __future__ import annotations

from typing import Any

import numpy as np

from trundle.errors import InputError, TrundleError
from trundle.geometry import FloatArray, wrap_angles
from trundle.mission import FollowPath, Step, TaskEnd
from trundle.mission.steering.goal_directives import MOST_POSES
from trundle.ros2.actions import ActionGoal
from trundle.ros2.inputs.checks import BadInputError
from trundle.ros2.navigation.actions.parts import Kit
from trundle.ros2.navigation.codes import following_code
from trundle.ros2.navigation.context import FrameError

_CONTROLLERS = ("", "FollowPath")
"""Names of Nav2's controller plugin that mean the controller in use; its own name does too."""

_SAME_PLACE_M = 1e-3
_ALONG_RAD = np.pi / 6.0


class Following:
    """Reports on a path that is followed.

    Args:
        kit: What actions work with.
    """

    def __init__(self, kit: Kit) -> None:
        self._kit = kit

    def begin(self, time: float) -> None:
        """The robot follows it from now on."""

    def feedback(self, step: Step) -> dict[str, Any]:
        """How far the robot still drives, and how fast it is."""
        speed = step.state.twist.v if step.observation is None else step.observation.twist.v
        return {"distance_to_goal": step.distance_remaining or 0.0, "speed": speed}

    def refused(self, error: TrundleError) -> dict[str, Any]:
        """The path cannot be followed."""
        return self._kit.failure("FollowPath", "INVALID_PATH", str(error))

    def ended(self, end: TaskEnd) -> dict[str, Any]:
        """How it ended."""
        if end.result == "failed":
            return self._kit.failure("FollowPath", following_code(end), end.message)
        return {} if end.result in ("succeeded", "cancelled") else {"error_msg": end.message}


class Follow:
    """Serves FollowPath: the path is followed as it is, and nothing is planned.

    Args:
        kit: What actions work with.
        name: Of the action on the network.
    """

    def __init__(self, kit: Kit, name: str) -> None:
        self._kit, self._name = kit, name

    def accepts(self, request: Any) -> bool:
        """Whether navigation is active."""
        return self._kit.is_accepting(self._name)

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
            kind = error.kind if isinstance(error, BadInputError) else "no path"
            kit.context.wire.warn(f"{self._name}: {kind}", f"a path of {self._name} is refused: {error}")
            goal.abort(**kit.failure("FollowPath", "INVALID_PATH", str(error)))
            return
        kit.tasks.drive.start(goal, Following(kit), directive, self._name)

    def cancel(self, goal: ActionGoal) -> bool:
        """Stop, if this path is followed."""
        return self._kit.tasks.drive.cancel(goal, self._name)

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
    """Poses of a path as trundle drives it, and which legs are driven in reverse.

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
