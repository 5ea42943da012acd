"""The frames of a robot's sensors and wheels on the network."""

from __future__ import annotations

import math
import time as clock
from typing import Any

from trundle.geometry import Pose2D
from trundle.messages.qos import TRANSFORMS
from trundle.mission import Step
from trundle.ros2.outputs.output import Cadence
from trundle.ros2.role import BridgeContext
from trundle.ros2.static_frames import PATIENCE_S, StaticFrames

WHEELS_PERIOD_S = 0.05
"""How often the wheels' frames are published [simulated time]: wheels that turn are only looked at."""

_LOOK_S = 1.0


def open_static_frames(context: BridgeContext) -> StaticFrames | None:
    """Publish where the lidars and the other frames of the profile are on the robot; None where there is no topic.

    Where the profile leaves that to robot_state_publisher, it is waited for.
    """
    profile, topic = context.profile, context.profile.topics.tf_static
    if topic is None:
        return None
    patience_s = 0.0 if profile.publishes_static else PATIENCE_S
    made = StaticFrames(
        context.wire, fixed_transforms(context), mode=context.static_frames, topic=topic, patience_s=patience_s
    )
    made.open()
    return made


def fixed_transforms(context: BridgeContext) -> list[Any]:
    """Make a geometry_msgs/TransformStamped of each frame that is fixed on the robot."""
    profile, robot = context.profile, context.mission.robot
    frame, make = context.wire.names.frame, context.maker
    transforms = [
        make.transform(0.0, frame(fixed.parent), frame(fixed.child), Pose2D(x, y, yaw), z)
        for fixed in profile.static_frames
        for x, y, z, yaw in (fixed.pose,)
    ]
    body, (at, height) = frame(profile.frames.body or profile.frames.base), profile.body_pose
    for name, sensor in profile.sensors_of(robot).items():
        lidar = robot.lidars[name]
        mount = at.inverse() @ Pose2D(lidar.x, lidar.y, lidar.yaw)
        transforms.append(make.transform(0.0, body, frame(sensor.frame or name), mount, lidar.z - height))
    return transforms


class WheelFrames:
    """Publishes the frames of the wheels on /tf, as robot_state_publisher does; with "auto", only where none is there.

    A node that reads the joint states and publishes transforms is taken for one.

    Args:
        context: The bridge.
    """

    def __init__(self, context: BridgeContext) -> None:
        profile, robot, names = context.profile, context.mission.robot, context.wire.names
        self._wire, self._make, self._mode = context.wire, context.maker, context.static_frames
        self._wheels = [
            (wheel, names.frame(profile.wheel_frames[wheel.joint]))
            for wheel in robot.drive.wheels
            if wheel.joint in profile.wheel_frames
        ]
        at, height = profile.body_pose
        self._at, self._height = at.inverse(), robot.drive.wheel_radius - height
        self._half_track = robot.drive.track_width / 2.0
        self._body = names.frame(profile.frames.body or profile.frames.base)
        self._tf = self._wire.outlet(profile.topics.tf, "tf2_msgs/msg/TFMessage", TRANSFORMS)
        joints = profile.topics.joint_states
        self._joints = None if joints is None else names.resolve(joints)
        self._cadence = Cadence(WHEELS_PERIOD_S)
        self._publishes = self._mode == "always"
        self._look_at = clock.monotonic() + PATIENCE_S
        if self._mode == "auto" and self._wheels:
            self._wire.every_round(self._look)

    def publish(self, step: Step, time: float) -> None:
        """Publish the wheels of a control period, if it is due and nobody else does."""
        if not (self._publishes and self._wheels and self._tf.is_wanted and self._cadence.is_due(time)):
            return
        self._cadence.mark(time)
        self._tf.write(
            self._make.transforms([self._transform(wheel, name, step, time) for wheel, name in self._wheels])
        )

    def _transform(self, wheel: Any, name: str, step: Step, time: float) -> Any:
        place = self._at @ Pose2D(wheel.x, wheel.side * self._half_track)
        transform = self._make.transform(time, self._body, name, place, self._height)
        angle = step.state.wheel_positions[0 if wheel.side > 0 else 1]
        turn = transform.transform.rotation
        turn.x, turn.y, turn.z, turn.w = 0.0, math.sin(0.5 * angle), 0.0, math.cos(0.5 * angle)
        return transform

    def _look(self) -> None:
        """See once a second whether another node publishes them."""
        now = clock.monotonic()
        if now < self._look_at:
            return
        self._look_at = now + _LOOK_S
        graph = self._wire.transport.graph()
        readers = {one.node for one in graph.subscriptions(self._joints or "") if not one.ours}
        writers = {one.node for one in graph.publishers(self._tf.topic) if not one.ours}
        self._publishes = not (readers & writers - {""})
