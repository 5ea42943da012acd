"""What the navigator publishes besides its costmap: its map, plan and pose, and markers of its goals and rollouts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from trundle.control import Rollouts
from trundle.geometry import FloatArray, Goal, Pose2D, wrap_angle
from trundle.messages.qos import LATCHED, TRANSFORMS, Qos
from trundle.mission import Step
from trundle.ros2.navigator_role.context import Kit
from trundle.ros2.outputs.output import Cadence

TOLERANCE_S = 0.1
"""map → odom is stamped so far ahead [s], as AMCL does: it then holds for odometry that comes before the next one."""

PLAN_PERIOD_S = 1.0
"""How often Nav2's behavior tree plans [s]."""

MOVED_M, TURNED_RAD = 0.25, 0.2
"""AMCL's update_min_d and update_min_a: the pose is published after this."""

_MARKERS = "visualization_msgs/msg/MarkerArray"
_POSE = "geometry_msgs/msg/PoseWithCovarianceStamped"
_SHOWN, _SECTION = 30, 3
"""So many rollouts are shown, by every third pose: more lines cost bytes, and show nothing more."""

_ADD, _DELETE_ALL = 0, 3
_ARROW, _SPHERE, _LINES = 0, 2, 5
_GREEN, _RED, _BLUE = (0.1, 0.7, 0.2), (0.9, 0.1, 0.1), (0.2, 0.4, 0.9)


class MapOutput:
    """Publishes the map, once for whoever comes.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        self._kit = kit
        self._outlet = kit.context.wire.outlet("map", "nav_msgs/msg/OccupancyGrid", LATCHED)
        self._written = False

    def publish(self, step: Step, time: float) -> None:
        """Publish the map, if it was not yet."""
        if not self._written:
            self._written = True
            self._outlet.write(self._kit.make.grid(time, self._kit.context.mission.grid, self._kit.map_frame))


class PoseOutput:
    """Publishes map → odom, and the pose as AMCL does: when the robot has moved, or it was told its pose.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        context = kit.context
        self._kit = kit
        self._odom = context.wire.names.frame(context.profile.frames.odom)
        self._tf = context.wire.outlet(context.profile.topics.tf, "tf2_msgs/msg/TFMessage", TRANSFORMS)
        self._pose = context.wire.outlet("amcl_pose", _POSE, LATCHED)
        self._last: Pose2D | None = None
        self._covariance = np.zeros(36)

    def begin(self) -> None:
        """Forget the last pose: a run begins."""
        self._last = None

    def publish(self, step: Step, time: float) -> None:
        """Publish what the robot believes at the end of a control period."""
        kit, belief = self._kit, self._kit.beliefs.now
        if self._tf.is_wanted:
            stamp = time + TOLERANCE_S
            transform = kit.make.transform(stamp, kit.map_frame, self._odom, belief.map_odom)
            self._tf.write(kit.make.transforms([transform]))
        if step.estimate is not None and step.estimate.covariance is not None:
            self._covariance = covariance_of(step.estimate.covariance)
        last, pose = self._last, belief.pose
        turned = math.inf if last is None else abs(wrap_angle(pose.yaw - last.yaw))
        if last is None or pose.distance_to(last) >= MOVED_M or turned >= TURNED_RAD:
            self._publish_pose()

    def answer(self) -> None:
        """Publish the pose now, and after the next control period: the robot was told where it is."""
        self._publish_pose()
        self._last = None

    def _publish_pose(self) -> None:
        kit, belief = self._kit, self._kit.beliefs.now
        self._last = belief.pose
        make = kit.types.make
        self._pose.write(
            make(
                _POSE,
                header=kit.make.header(belief.time, kit.map_frame),
                pose=make(
                    "geometry_msgs/msg/PoseWithCovariance",
                    pose=kit.make.pose(belief.pose),
                    covariance=self._covariance,
                ),
            )
        )


class PlanOutput:
    """Publishes the path that is followed, when it changes and once a second.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        self._kit = kit
        self._outlet = kit.context.wire.outlet("plan", "nav_msgs/msg/Path", Qos(10))
        self._path: object = None
        self._cadence = Cadence(PLAN_PERIOD_S)

    def publish(self, step: Step, time: float) -> None:
        """Publish the path, if there is one and it is due."""
        path = step.path
        if path is None or not self._outlet.is_wanted:
            return
        if path is self._path and not self._cadence.is_due(time):
            return
        self._path = path
        self._cadence.mark(time)
        self._outlet.write(self._kit.make.path(time, path.poses, self._kit.map_frame))


class MarkerOutput:
    """Publishes markers: the goals that are left, and the controller's best rollouts.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        wire = kit.context.wire
        self._kit = kit
        self._goals = wire.outlet("waypoints", _MARKERS, LATCHED)
        self._rollouts = wire.outlet("trajectories", _MARKERS, Qos(1))
        self._shown: object = None

    @property
    def wants_rollouts(self) -> bool:
        """Whether somebody looks at the rollouts, which take the controller a tenth of its time."""
        return self._rollouts.is_wanted

    def publish(self, step: Step, time: float) -> None:
        """Publish the goals where they have changed, and the rollouts."""
        goals = () if step.steering is None else step.steering.goals[step.goal :]
        if step.status.value in ("arrived", "idle"):
            goals = ()
        if goals != self._shown:
            self._shown = goals
            self._goals.write(self._kit.types.make(_MARKERS, markers=self._goal_markers(time, goals)))
        if step.rollouts is not None and self._rollouts.is_wanted:
            self._rollouts.write(self._kit.types.make(_MARKERS, markers=[self._lines(time, step.rollouts)]))

    def _goal_markers(self, time: float, goals: tuple[Goal, ...]) -> list[Any]:
        """Make a marker that deletes those of before, and one for each goal."""
        found = [self._marker(time, 0, _ARROW, (0.0, 0.0, 0.0), _RED, action=_DELETE_ALL)]
        for number, goal in enumerate(goals):
            shape, size = (_SPHERE, (0.2, 0.2, 0.2)) if goal.yaw_free else (_ARROW, (0.4, 0.06, 0.06))
            color = _GREEN if number == len(goals) - 1 else _BLUE
            marker = self._marker(time, number, shape, size, color)
            marker.pose = self._kit.make.pose(goal.pose, 0.1)
            found.append(marker)
        return found

    def _lines(self, time: float, rollouts: Rollouts) -> Any:
        """Make a marker of lines; its points are both ends of every section of the rollouts."""
        poses, point = rollouts.poses[:_SHOWN, ::_SECTION], self._kit.types.kind("geometry_msgs/msg/Point")
        ends = np.stack([poses[:, :-1, :2], poses[:, 1:, :2]], axis=2).reshape(-1, 2)
        marker = self._marker(time, 0, _LINES, (0.01, 0.0, 0.0), _BLUE)
        marker.points = [point(x, y, 0.05) for x, y in ends.tolist()]
        return marker

    def _marker(
        self,
        time: float,
        number: int,
        shape: int,
        size: tuple[float, float, float],
        color: tuple[float, float, float],
        action: int = _ADD,
    ) -> Any:
        make = self._kit.types.make
        red, green, blue = color
        return make(
            "visualization_msgs/msg/Marker",
            header=self._kit.make.header(time, self._kit.map_frame),
            ns="trundle",
            id=number,
            type=shape,
            action=action,
            scale=make("geometry_msgs/msg/Vector3", x=size[0], y=size[1], z=size[2]),
            color=make("std_msgs/msg/ColorRGBA", r=red, g=green, b=blue, a=0.9),
        )


def covariance_of(covariance: FloatArray) -> FloatArray:
    """Write a covariance of (x, y, yaw), shape (3, 3), as that of a PoseWithCovariance, shape (36,)."""
    whole = np.zeros((6, 6))
    whole[np.ix_((0, 1, 5), (0, 1, 5))] = covariance
    return whole.ravel()
