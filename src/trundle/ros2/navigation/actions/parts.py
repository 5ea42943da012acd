"""What the actions share: durations, stamped poses, and the fields of a result that failed."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from trundle.geometry import Pose2D
from trundle.messages import MessageMaker
from trundle.ros2.navigation.codes import code
from trundle.ros2.navigation.context import Beliefs
from trundle.ros2.navigation.tasks import Tasks
from trundle.ros2.role import BridgeContext

if TYPE_CHECKING:
    from trundle.ros2.types import Types


class Kit:
    """What every action of the navigator works with.

    Args:
        context: The bridge.
        tasks: The drive and the behavior that run.
        beliefs: Where the robot is.
    """

    def __init__(self, context: BridgeContext, tasks: Tasks, beliefs: Beliefs) -> None:
        self.context, self.tasks, self.beliefs = context, tasks, beliefs
        self.make = MessageMaker(context.wire.types.codec)
        self.map_frame = context.wire.names.frame(context.profile.frames.map)

    @property
    def types(self) -> Types:
        """The messages."""
        return self.context.wire.types

    def duration(self, seconds: float) -> Any:
        """A builtin_interfaces/Duration."""
        whole, nanoseconds = divmod(round(max(0.0, seconds) * 1e9), 1_000_000_000)
        return self.types.make("builtin_interfaces/msg/Duration", sec=whole, nanosec=nanoseconds)

    def stamped(self, pose: Pose2D) -> Any:
        """A geometry_msgs/PoseStamped of a pose on the map, now."""
        return self.make.goal(self.beliefs.now.time, pose, self.map_frame)

    def failure(self, action: str, name: str, message: str) -> dict[str, Any]:
        """The fields of a result with the code of an action, such as GOAL_OCCUPIED of ComputePathToPose."""
        return {"error_code": code(self.types, action, name), "error_msg": message}

    def is_accepting(self, action: str) -> bool:
        """Whether goals are taken now; where not, the reason is reported."""
        why = self.tasks.refuses
        if why:
            self.context.wire.warn(f"{action}: refused", f"a goal of {action} is refused: {why}")
        return not why


def seconds_of(duration: Any) -> float:
    """A builtin_interfaces/Duration [s]."""
    return float(duration.sec) + 1e-9 * float(duration.nanosec)


def poses_of(goals: Any) -> list[Any]:
    """The PoseStamped of a list of goals: an array, or a message that holds one, as from Kilted on."""
    for name in ("goals", "poses"):
        goals = getattr(goals, name, goals)
    return list(goals)
