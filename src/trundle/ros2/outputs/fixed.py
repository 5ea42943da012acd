"""What does not change, for whoever comes late: the static transforms, and the robot as URDF."""

from __future__ import annotations

from trundle.export.urdf import describe_robot
from trundle.geometry import Pose2D
from trundle.messages import MessageMaker
from trundle.messages.qos import LATCHED
from trundle.ros2.role import BridgeContext


def publish_static_frames(context: BridgeContext, topic: str) -> None:
    """Publish where the lidars and the other frames of the profile are on the robot."""
    wire, profile, robot = context.wire, context.profile, context.mission.robot
    frame, make = wire.names.frame, MessageMaker(wire.types.codec)
    base = frame(profile.frames.base)
    transforms = [
        make.transform(0.0, frame(fixed.parent), frame(fixed.child), Pose2D(x, y, yaw), z)
        for fixed in profile.static_frames
        for x, y, z, yaw in (fixed.pose,)
    ]
    for name, sensor in profile.sensors_of(robot).items():
        lidar = robot.lidars[name]
        mount = Pose2D(lidar.x, lidar.y, lidar.yaw)
        transforms.append(make.transform(0.0, base, frame(sensor.frame or name), mount, lidar.z))
    wire.outlet(topic, "tf2_msgs/msg/TFMessage", LATCHED).write(make.transforms(transforms))


def publish_description(context: BridgeContext, topic: str) -> None:
    """Publish the robot as URDF, as robot_state_publisher does."""
    wire = context.wire
    text = describe_robot(context.mission.robot)
    wire.outlet(topic, "std_msgs/msg/String", LATCHED).write(wire.types.make("std_msgs/msg/String", data=text))
