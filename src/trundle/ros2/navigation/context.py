"""`Belief`: where the robot believes to be, for the threads that are not the one that drives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from trundle.costmap import Costmap
from trundle.errors import TrundleError
from trundle.geometry import Pose2D
from trundle.mission import Step
from trundle.ros2.inputs.checks import BadInputError, check_pose
from trundle.ros2.role import BridgeContext

NAVIGATOR = "navigator"
"""Who gives directives for what comes from the network without a name."""


class FrameError(TrundleError):
    """A pose in a frame that cannot be transformed to the map."""


@dataclass(frozen=True, slots=True)
class Belief:
    """Where the robot believes to be, and what it drives on.

    Attributes:
        time: On the network's clock [s].
        pose: Map frame.
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
        now: The latest.
    """

    def __init__(self, context: BridgeContext) -> None:
        self._context = context
        mission = context.mission
        self.now = Belief(0.0, mission.start, mission.start, mission.navigator.costmap)

    def take(self, step: Step, time: float) -> None:
        """Take what the robot believes at the end of a control period, at this time on the network's clock [s]."""
        observation = step.state.observation if step.observation is None else step.observation
        pose = step.state.pose if step.estimate is None else step.estimate.pose
        costmap = self.now.costmap if step.costmap is None else step.costmap
        self.now = Belief(time, pose, pose @ self._context.odometry(observation).inverse(), costmap)

    def read(self, stamped: Any, what: str) -> Pose2D:
        """The pose of a geometry_msgs/PoseStamped in the map frame; an empty frame means the map.

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
        """Where a frame is on the map now.

        Raises:
            FrameError: If it is none of map, odom and base.
        """
        frames, names = self._context.profile.frames, self._context.wire.names
        frame, belief = frame_id.lstrip("/"), self.now
        if not frame or frame == names.frame(frames.map):
            return Pose2D(0.0, 0.0)
        if frame == names.frame(frames.odom):
            return belief.map_odom
        if frame in {names.frame(name) for name in (frames.base, *frames.also_base)}:
            return belief.pose
        known = ", ".join(names.frame(name) for name in (frames.map, frames.odom, frames.base))
        raise FrameError(f"its frame is {frame_id!r}, which is none of {known}")
