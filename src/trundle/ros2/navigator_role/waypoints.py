"""FollowWaypoints: the robot drives to one pose after another, stops at each, and leaves out those it cannot reach."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from trundle.errors import InputError, TrundleError
from trundle.geometry import Pose2D
from trundle.mission import SetGoal, Step, TaskEnd
from trundle.mission.steering.directives import Directive
from trundle.mission.steering.goal_directives import MOST_GOALS
from trundle.ros2.actions import ActionGoal
from trundle.ros2.navigator_role.codes import driving_code, planning_code
from trundle.ros2.navigator_role.context import Kit, ServedAction, poses_of
from trundle.ros2.navigator_role.tasks import Task

_GOAL, _LOOPS = "nav2_msgs/action/FollowWaypoints_Goal", "number_of_loops"
_RESULT = "nav2_msgs/action/FollowWaypoints_Result"
_MISSED, _STATUS = "nav2_msgs/msg/MissedWaypoint", "nav2_msgs/msg/WaypointStatus"
_FAILED = 3
"""FAILED of nav2_msgs/msg/WaypointStatus."""


class Tour:
    """Reports on the waypoints that are driven to.

    Args:
        kit: What actions work with.
        goals: The poses.
        first: Index of the first one.
        loops: How often the poses are driven through again.

    Attributes:
        index: Index of the waypoint that is driven to.
    """

    def __init__(self, kit: Kit, goals: list[Pose2D], first: int, loops: int) -> None:
        self._kit, self._goals, self._loops = kit, goals, loops
        self._missed: list[Any] = []
        self.index = first

    @property
    def target(self) -> Pose2D:
        """The waypoint that is driven to."""
        return self._goals[self.index]

    def advance(self) -> bool:
        """Go on to the next waypoint, and return whether there is one."""
        self.index += 1
        if self.index < len(self._goals):
            return True
        self.index = 0
        self._loops -= 1
        return self._loops >= 0

    def miss(self, action: str, code: str, why: str) -> None:
        """Take note that the present waypoint is not reached, as the distribution's result has it."""
        kit, number = self._kit, self._kit.failure(action, code, why)["error_code"]
        stamped, types = kit.stamped(self.target), kit.types
        fields: dict[str, Any] = {"error_code": number, "error_msg": why}
        kind = types.item_type(_RESULT, "missed_waypoints")
        if kind == _STATUS:
            fields |= {"waypoint_status": _FAILED, "waypoint_index": self.index, "waypoint_pose": stamped}
            self._missed.append(types.make(_STATUS, **fields))
        elif kind == _MISSED:
            self._missed.append(types.make(_MISSED, index=self.index, goal=stamped, **fields))
        else:  # Humble has the index alone
            self._missed.append(self.index)

    def begin(self, time: float) -> None:
        """Do nothing: the feedback does not count the time."""

    def feedback(self, step: Step) -> dict[str, Any]:
        """Return which waypoint is driven to."""
        return {"current_waypoint": self.index}

    def refused(self, error: TrundleError) -> dict[str, Any]:
        """Return the result where nothing was reached."""
        return self.result() | self._kit.failure("FollowWaypoints", "UNKNOWN", str(error))

    def ended(self, end: TaskEnd) -> dict[str, Any]:
        """Return the result where the drive was ended."""
        return self.result() | ({} if end.result == "cancelled" else {"error_msg": end.message})

    def result(self) -> dict[str, Any]:
        """Return the waypoints that were missed."""
        return {"missed_waypoints": self._missed}


class TourTask(Task):
    """A goal that gives the run one waypoint after another; a failed one is left out, as Nav2's bringup has it.

    Args:
        goal: The goal.
        tour: Its waypoints.
        later: Calls something in the listening thread.
        drive: Gives the run a waypoint.
        kit: What actions work with.
        by: Who gives them.
    """

    def __init__(
        self,
        goal: ActionGoal,
        tour: Tour,
        later: Callable[[Callable[[], None]], None],
        drive: Callable[[Pose2D, TourTask], None],
        kit: Kit,
        by: str,
    ) -> None:
        super().__init__(goal, tour, later)
        self._tour, self._drive, self._kit, self._by = tour, drive, kit, by

    def begin_tour(self) -> None:
        """Drive to the first waypoint."""
        self._drive(self._tour.target, self)

    def again(self) -> tuple[Directive, str]:
        """Return what gives the next run the present waypoint."""
        return SetGoal(self._tour.target), self._by

    def refuse(self, error: TrundleError) -> None:
        """Leave out a waypoint that cannot be reached."""
        code = planning_code(error, self._kit.beliefs.now.pose)
        self._tour.miss("ComputePathToPose", code, str(error))
        self.later(self._next)

    def end(self, end: TaskEnd) -> None:
        """Go on after a waypoint."""
        if end.result == "failed" and end.fault is None:
            self._tour.miss(*driving_code(end, self._kit.beliefs.now.pose), end.message)
        elif end.result != "succeeded":
            super().end(end)
            return
        self.later(self._next)

    def _next(self) -> None:
        """Drive to the next waypoint, or end; in the listening thread."""
        if self.goal.is_over:
            return
        if self.goal.cancel_requested:
            self.finish(self.cancelled, self._tour.result())
        elif self._tour.advance():
            self._drive(self._tour.target, self)
        else:
            self.finish(self.goal.succeed, self._tour.result())


class FollowWaypoints(ServedAction):
    """Serves FollowWaypoints. A second goal replaces the first, which is aborted."""

    def accepted(self, goal: ActionGoal) -> None:
        """Drive to the waypoints from now on."""
        kit, types = self._kit, self._kit.types
        try:
            poses, first = self._read(goal.request)
        except TrundleError as error:
            self._report("goal", error, "bad goal")
            unknown = types.constant(_RESULT, "UNKNOWN", 600)
            goal.abort(error_code=types.constant(_RESULT, "NO_VALID_WAYPOINTS", unknown), error_msg=str(error))
            return
        loops = goal.request.number_of_loops if types.has(_GOAL, _LOOPS) else 0
        steering = kit.context.driver.steering

        def drive(pose: Pose2D, task: TourTask) -> None:
            steering.put(SetGoal(pose), by=self._name, watcher=task)

        task = TourTask(goal, Tour(kit, poses, first, int(loops)), kit.tasks.later, drive, kit, self._name)
        kit.tasks.drive.adopt(task)
        task.begin_tour()

    def _read(self, request: Any) -> tuple[list[Pose2D], int]:
        stamped = poses_of(request.poses)
        if not 0 < len(stamped) <= MOST_GOALS:
            raise InputError(f"give 1 to {MOST_GOALS} waypoints, got {len(stamped)}")
        has_first = self._kit.types.has(_GOAL, "goal_index")
        first = int(request.goal_index) if has_first else 0
        if first >= len(stamped):
            raise InputError(f"goal_index {first} is not one of {len(stamped)} waypoints")
        beliefs = self._kit.beliefs
        return [beliefs.read(one, f"waypoint {number}") for number, one in enumerate(stamped, 1)], first
