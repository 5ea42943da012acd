"""What moves: the transform of the robot, its odometry and its joints."""

from __future__ import annotations

import numpy as np

from trundle.messages import MessageMaker
from trundle.messages.qos import TRANSFORMS, Qos
from trundle.mission import Step
from trundle.observation import Observation
from trundle.robots import WheelSpeeds
from trundle.ros2.role import BridgeContext

ODOMETRY = Qos(10)
JOINTS = Qos(10)


def observed(step: Step) -> Observation:
    """What the robot observes at the end of a control period."""
    return step.state.observation if step.observation is None else step.observation


class MotionOutput:
    """Publishes odom → base on /tf, and the odometry.

    Args:
        context: The bridge.
    """

    def __init__(self, context: BridgeContext) -> None:
        wire, profile = context.wire, context.profile
        names, frames, topics = wire.names, profile.frames, profile.topics
        self._context = context
        self._make = MessageMaker(wire.types.codec)
        self._odom, self._base = names.frame(frames.odom), names.frame(frames.base)
        self._tf = wire.outlet(topics.tf, "tf2_msgs/msg/TFMessage", TRANSFORMS)
        self._odometry = None if topics.odom is None else wire.outlet(topics.odom, "nav_msgs/msg/Odometry", ODOMETRY)

    def publish(self, step: Step, time: float) -> None:
        """Publish both."""
        tf, odometry, make = self._tf, self._odometry, self._make
        wants_odometry = odometry is not None and odometry.is_wanted
        if not (tf.is_wanted or wants_odometry):
            return
        seen = observed(step)
        pose = self._context.odometry(seen)
        if tf.is_wanted:
            tf.write(make.transforms([make.transform(time, self._odom, self._base, pose)]))
        if odometry is not None and wants_odometry:
            odometry.write(make.odometry(time, self._odom, self._base, pose, seen.twist))


class JointOutput:
    """Publishes the joints of the drive wheels.

    Args:
        context: The bridge.
        topic: Its topic.
    """

    def __init__(self, context: BridgeContext, topic: str) -> None:
        wire = context.wire
        self._outlet = wire.outlet(topic, "sensor_msgs/msg/JointState", JOINTS)
        self._make = MessageMaker(wire.types.codec)
        self._kind = wire.types.codec.kind("sensor_msgs/msg/JointState")
        wheels = context.mission.robot.drive.wheels
        self._names = [wheel.joint for wheel in wheels]
        self._left = np.array([wheel.side > 0 for wheel in wheels])
        self._no_effort = np.zeros(0)
        self._period_s = 1.0 / context.profile.joint_state_rate
        self._written = -1.0

    def publish(self, step: Step, time: float) -> None:
        """Publish the end of a control period, if it is due."""
        state = step.state
        self.tick(time, state.wheel_positions, state.wheel_speeds)

    def tick(self, time: float, positions: WheelSpeeds, speeds: WheelSpeeds) -> None:
        """Publish the angles [rad] and speeds [rad/s] of the wheels, if it is due."""
        if not self._outlet.is_wanted or 0.0 <= time - self._written < self._period_s - 1e-9:
            return
        self._written = time
        left = self._left
        self._outlet.write(
            self._kind(
                header=self._make.header(time, ""),
                name=self._names,
                position=np.where(left, positions.left, positions.right),
                velocity=np.where(left, speeds.left, speeds.right),
                effort=self._no_effort,
            )
        )
