"""`Kit`: what the actions and outputs of the navigator work with; `Beliefs`: where the robot believes to be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from trundle.costmap import Costmap
from trundle.errors import TrundleError
from trundle.geometry import Pose2D
from trundle.mission import Step
from trundle.ros2.actions import ActionGoal
from trundle.ros2.bad_input import BadInputError, check_pose
from trundle.ros2.navigator_role.tasks import Tasks
from trundle.ros2.outputs.output import observed
from trundle.ros2.role import BridgeContext

if TYPE_CHECKING:
    from trundle.ros2.types import Types

NAVIGATOR = "navigator"
"""Directives for what comes from the network without a name are given in this name."""


_UNKNOWN = {
    "ComputePathToPose": 200,
    "ComputePathThroughPoses": 300,
    "FollowPath": 100,
    "Spin": 700,
    "BackUp": 710,
    "DriveOnHeading": 720,
    "Wait": 740,
    "AssistedTeleop": 730,
    "SmoothPath": 500,
    "FollowWaypoints": 600,
}
"""UNKNOWN of each action from Iron on: what is sent where a distribution lacks the name of a code."""


class FrameError(TrundleError):
    """A pose in a frame that cannot be transformed to the map."""


@dataclass(frozen=True, slots=True)
class Belief:
    """Where the robot believes to be, and what it drives on.

    Attributes:
        time: Time on the network's clock [s].
        pose: Pose of the base, map frame.
        map_odom: Pose of the odom frame, as on the network, in the map frame.
        costmap: What it drives on, with what was sensed.
    """

    time: float
    pose: Pose2D
    map_odom: Pose2D
    costmap: Costmap


class Beliefs:
    """Keeps the latest `Belief`; the thread that drives replaces it as a whole.

    Args:
        context: The bridge.

    Attributes:
        now: The latest `Belief`.
        find: Where a frame that is none of map, odom and base is in the base; None where nobody says that.
        map: The map that it has: the one that it was given, or the one that its localizer makes; None without one.
        stands: Where the simulator has the robot, map frame.
    """

    def __init__(self, context: BridgeContext) -> None:
        self._context = context
        mission = context.mission
        self.now = Belief(0.0, mission.start, mission.start, mission.navigator.costmap)
        self.find: Callable[[str], Pose2D | None] = lambda frame: None
        self.map = mission.grid if mission.scenario.known_map else None
        self.stands = mission.start

    def take(self, step: Step, time: float) -> None:
        """Take what the robot believes at the end of a control period, at this time on the network's clock [s]."""
        self.stands = step.state.pose
        pose = step.state.pose if step.estimate is None else step.estimate.pose
        costmap = self.now.costmap if step.costmap is None else step.costmap
        if step.map is not None:
            self.map = step.map
        self.now = Belief(time, pose, pose @ self._context.odometry(observed(step)).inverse(), costmap)

    def read(self, stamped: Any, what: str) -> Pose2D:
        """Read the pose of a geometry_msgs/PoseStamped in the map frame; an empty frame means the map.

        Raises:
            FrameError: If its frame is none of map, odom and base.
            BadInputError: If a number is not finite, or the quaternion is no rotation.
        """
        try:
            return self.place(stamped.header.frame_id) @ check_pose(stamped.pose)
        except BadInputError as error:
            raise BadInputError(error.kind, f"{what}: {error}") from error
        except FrameError as error:
            raise FrameError(f"{what}: {error}") from error

    def place(self, frame_id: str) -> Pose2D:
        """Return where a frame is on the map now.

        Raises:
            FrameError: If it is none of map, odom and base, and nobody says where it is on the robot.
        """
        frames, names = self._context.profile.frames, self._context.wire.names
        frame, belief = frame_id.lstrip("/"), self.now
        if not frame or frame == names.frame(frames.map):
            return Pose2D(0.0, 0.0)
        if frame == names.frame(frames.odom):
            return belief.map_odom
        if frame in {names.frame(name) for name in (frames.base, *frames.also_base)}:
            return belief.pose
        seen = self.find(frame)
        if seen is not None:
            return belief.pose @ seen
        known = ", ".join(names.frame(name) for name in (frames.map, frames.odom, frames.base))
        raise FrameError(f"its frame is {frame_id!r}, which is none of {known}")


class Kit:
    """What every action of the navigator works with.

    Args:
        context: The bridge.
        tasks: The drive and the behavior that run.
        beliefs: Where the robot is.

    Attributes:
        is_own_pose: Whether a message of /initialpose, from this source, was sent by trundle itself.
    """

    def __init__(self, context: BridgeContext, tasks: Tasks, beliefs: Beliefs) -> None:
        self.context, self.tasks, self.beliefs = context, tasks, beliefs
        self.make = context.maker
        self.map_frame = context.wire.names.frame(context.profile.frames.map)
        self.is_own_pose: Callable[[Any, str], bool] = lambda message, source: False

    @property
    def types(self) -> Types:
        """The messages."""
        return self.context.wire.types

    def duration(self, seconds: float) -> Any:
        """Make a builtin_interfaces/Duration."""
        whole, nanoseconds = divmod(round(max(0.0, seconds) * 1e9), 1_000_000_000)
        return self.types.make("builtin_interfaces/msg/Duration", sec=whole, nanosec=nanoseconds)

    def stamped(self, pose: Pose2D) -> Any:
        """Make a geometry_msgs/PoseStamped of a pose on the map, now."""
        return self.make.goal(self.beliefs.now.time, pose, self.map_frame)

    def failure(self, action: str, name: str, message: str) -> dict[str, Any]:
        """Return the fields of a result with an error code of an action, such as GOAL_OCCUPIED of ComputePathToPose.

        Distributions without error codes leave the field out of their results, and the number is not sent.
        """
        result, constant = f"nav2_msgs/action/{action}_Result", self.types.constant
        number = constant(result, name, constant(result, "UNKNOWN", _UNKNOWN.get(action, 1)))
        return {"error_code": number, "error_msg": message}

    def is_accepting(self, action: str) -> bool:
        """Return whether goals are taken now, and report the reason if not."""
        why = self.tasks.refuses
        if why:
            self.context.wire.warn(f"{action}: refused", f"a goal of {action} is refused: {why}")
        return not why


class ServedAction:
    """An action of the navigator, which takes goals while navigation is active.

    Args:
        kit: What actions work with.
        name: Name of the action on the network.
    """

    def __init__(self, kit: Kit, name: str) -> None:
        self._kit, self._name = kit, name

    def accepts(self, request: Any) -> bool:
        """Return whether navigation is active; what is wrong with a goal is in its result."""
        return self._kit.is_accepting(self._name)

    def cancel(self, goal: ActionGoal) -> bool:
        """Stop, if the robot drives for this goal."""
        return self._kit.tasks.drive.cancel(goal, self._name)

    def _report(self, what: str, error: TrundleError, kind: str) -> None:
        """Report what is refused, by its kind where the error has none."""
        kind = error.kind if isinstance(error, BadInputError) else kind
        self._kit.context.wire.warn(f"{self._name}: {kind}", f"a {what} of {self._name} is refused: {error}")


def seconds_of(duration: Any) -> float:
    """Read a builtin_interfaces/Duration [s]."""
    return float(duration.sec) + 1e-9 * float(duration.nanosec)


def poses_of(goals: Any) -> list[Any]:
    """Return the PoseStamped of a list of goals: an array, or a message that holds one, as from Kilted on."""
    for name in ("goals", "poses"):
        goals = getattr(goals, name, goals)
    return list(goals)
