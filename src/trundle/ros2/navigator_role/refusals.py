"""Actions of Nav2 that trundle does not serve: they are refused at once, with the reason."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from trundle.ros2.actions import ActionGoal
from trundle.ros2.wire import Wire


@dataclass(frozen=True, slots=True)
class Refusal:
    """What is refused.

    Attributes:
        name: Its name on the network.
        type_name: Its type.
        call: The call of `BasicNavigator` that asks for it, for the docs.
        why: The reason, with what to do instead.
    """

    name: str
    type_name: str
    call: str
    why: str


REFUSED_ACTIONS = (
    Refusal(
        "follow_gps_waypoints",
        "nav2_msgs/action/FollowGPSWaypoints",
        "followGpsWaypoints",
        "trundle knows no geographic coordinates: use goToPose or goThroughPoses on the map",
    ),
    Refusal("dock_robot", "nav2_msgs/action/DockRobot", "dockRobotByPose, dockRobotByID", "trundle has no docks"),
    Refusal("undock_robot", "nav2_msgs/action/UndockRobot", "undockRobot", "trundle has no docks"),
    Refusal(
        "compute_route",
        "nav2_msgs/action/ComputeRoute",
        "getRoute",
        "trundle has no route graph: use getPath or getPathThroughPoses",
    ),
    Refusal(
        "compute_and_track_route",
        "nav2_msgs/action/ComputeAndTrackRoute",
        "getAndTrackRoute",
        "trundle has no route graph: use goThroughPoses",
    ),
)
"""The actions that `BasicNavigator` of any distribution may ask for, and that are refused."""


class Refuse:
    """Refuses the goals of an action.

    Where the distribution's result has a text for the reason, a goal is accepted and aborted with it. Otherwise it is
    rejected, as that is what clients look at, and the reason is reported here.

    Args:
        wire: What serves it.
        refusal: What is refused.
    """

    def __init__(self, wire: Wire, refusal: Refusal) -> None:
        self._wire, self._refusal = wire, refusal
        self._says = wire.types.has(f"{refusal.type_name}_Result", "error_msg")

    def accepts(self, request: Any) -> bool:
        """Return whether the result can say why the goal is refused."""
        name, why = self._refusal.name, self._refusal.why
        self._wire.warn(f"{name}: refused", f"a goal of {name} is refused: {why}")
        return self._says

    def accepted(self, goal: ActionGoal) -> None:
        """Abort the goal with the reason."""
        result = f"{self._refusal.type_name}_Result"
        goal.abort(error_code=self._wire.types.constant(result, "UNKNOWN", 1), error_msg=self._refusal.why)

    def cancel(self, goal: ActionGoal) -> bool:
        """Return False: nothing runs that could be cancelled."""
        return False
