"""NavigateToPose and NavigateThroughPoses."""

from __future__ import annotations

from typing import Any

from trundle.errors import InputError, TrundleError
from trundle.geometry import Pose2D
from trundle.mission import SetGoal, SetGoals, Step, TaskEnd
from trundle.mission.steering.goal_directives import MOST_GOALS
from trundle.ros2.actions import ActionGoal
from trundle.ros2.inputs.checks import BadInputError
from trundle.ros2.navigation.actions.parts import Kit, poses_of
from trundle.ros2.navigation.codes import driving_code, planning_code
from trundle.ros2.navigation.context import FrameError

_SLOWEST_MPS = 0.01
"""As in Nav2: slower than this there is no estimate of the time that is left."""


class Navigation:
    """Reports on a drive to a goal, or through several.

    Args:
        kit: What actions work with.
        plans: The action of Nav2 that plans for it, whose error codes are sent.
        goals: The goals.
    """

    def __init__(self, kit: Kit, plans: str, goals: list[Pose2D]) -> None:
        self._kit, self._plans, self._goals = kit, plans, goals
        self._begun_s = 0.0
        self._runs_before: int | None = None

    def begin(self, time: float) -> None:
        """The robot drives from now on [s]."""
        self._begun_s, self._runs_before = time, None

    def feedback(self, step: Step) -> dict[str, Any]:
        """Where the robot is, how far and how long it still drives, and how often it had to recover."""
        kit, recoveries = self._kit, sum(ran.recovery for ran in step.behaviors)
        goals = () if step.steering is None else step.steering.goals
        if self._runs_before is None:
            self._runs_before = recoveries
        left_m = 0.0 if step.distance_remaining is None else step.distance_remaining
        speed = abs(step.state.twist.v if step.observation is None else step.observation.twist.v)
        return {
            "current_pose": kit.stamped(kit.beliefs.now.pose),
            "navigation_time": kit.duration(step.state.time - self._begun_s),
            "estimated_time_remaining": kit.duration(left_m / speed if speed > _SLOWEST_MPS else 0.0),
            "number_of_recoveries": max(0, recoveries - self._runs_before),
            "distance_remaining": left_m,
            "number_of_poses_remaining": min(len(self._goals), max(0, len(goals) - step.goal)),
        }

    def refused(self, error: TrundleError) -> dict[str, Any]:
        """The goal cannot be reached, by the plan to it."""
        name = planning_code(error, self._kit.beliefs.now.pose)
        return self._kit.failure(self._plans, name, str(error))

    def ended(self, end: TaskEnd) -> dict[str, Any]:
        """How the drive ended."""
        if end.result == "failed":
            action, name = driving_code(end, self._kit.beliefs.now.pose)
            return self._kit.failure(self._plans if action == "ComputePathToPose" else action, name, end.message)
        return {} if end.result in ("succeeded", "cancelled") else {"error_msg": end.message}


class Navigate:
    """Serves NavigateToPose, or NavigateThroughPoses. A second goal replaces the first, which is aborted.

    Args:
        kit: What actions work with.
        name: Of the action on the network.
        through: Whether it drives through several poses.
    """

    def __init__(self, kit: Kit, name: str, *, through: bool) -> None:
        self._kit, self._name, self._through = kit, name, through
        self._plans = "ComputePathThroughPoses" if through else "ComputePathToPose"

    def accepts(self, request: Any) -> bool:
        """Whether navigation is active; what is wrong with a goal is in its result."""
        return self._kit.is_accepting(self._name)

    def accepted(self, goal: ActionGoal) -> None:
        """Drive there from now on."""
        kit = self._kit
        try:
            goals = self._read(goal.request)
        except FrameError as error:
            goal.abort(**kit.failure(self._plans, "TF_ERROR", str(error)))
            return
        except BadInputError as error:
            kit.context.wire.warn(f"{self._name}: {error.kind}", f"a goal of {self._name} is refused: {error}")
            goal.abort(**kit.failure(self._plans, "UNKNOWN", str(error)))
            return
        except _RefusedError as error:
            goal.abort(**kit.failure(error.action, error.code, str(error)))
            return
        directive = SetGoals(goals) if self._through else SetGoal(goals[0])
        kit.tasks.drive.start(goal, Navigation(kit, self._plans, goals), directive, self._name)

    def cancel(self, goal: ActionGoal) -> bool:
        """Stop, if this goal is driven to."""
        return self._kit.tasks.drive.cancel(goal, self._name)

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
        action: Whose code it has.
        code: The name of the code.
    """

    def __init__(self, message: str, action: str = "", code: str = "UNKNOWN") -> None:
        super().__init__(message)
        self.action, self.code = action, code
