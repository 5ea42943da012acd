"""What a robot may need from trundle: the frames of its sensors, and its pose on /initialpose."""

from __future__ import annotations

import time as system
from typing import Any

from trundle.errors import TrundleError
from trundle.geometry import Pose2D
from trundle.messages import MessageMaker
from trundle.messages.makers import POSE
from trundle.messages.qos import LATCHED, Qos
from trundle.messages.readers import read_pose
from trundle.robots import Robot
from trundle.ros2.profile import Profile
from trundle.ros2.remote.commands import Sources
from trundle.ros2.remote.frames import mount_matrix
from trundle.ros2.remote.inputs import RobotInputs
from trundle.ros2.remote.localizer import RemoteLocalizer, TfLocalizer
from trundle.ros2.role import BridgeContext
from trundle.ros2.wire import Wire

LOOKS_S = 1.0
"""Who listens is looked up this often [s]."""

_SAME_M = 1e-6

FRAMES_AFTER_S = 3.0
"""Frames that tf lacks this long after the start are published [s]: /tf_static comes within a second or two."""


class StaticFrames:
    """Publishes base → sensor for the lidars, where nobody else does.

    Args:
        wire: The network.
        profile: Names of frames and topics.
        robot: The robot, whose file has the mounts.
        inputs: Knows the transforms of others.
        when: "auto" where nobody else publishes them, "always" or "never".
    """

    def __init__(self, wire: Wire, profile: Profile, robot: Robot, inputs: RobotInputs, when: str) -> None:
        self._wire, self._profile, self._robot, self._inputs, self._when = wire, profile, robot, inputs, when
        self._since = system.monotonic()
        self._is_done = when == "never" or profile.topics.tf_static is None
        self.published: tuple[str, ...] = ()

    def open(self) -> None:
        """Publish them now, or look for them while the run goes on."""
        if self._when == "always":
            self._publish()
        elif not self._is_done:
            self._wire.every_round(self._look)

    def _look(self) -> None:
        if not self._is_done and system.monotonic() - self._since > FRAMES_AFTER_S:
            self._publish()

    def _publish(self) -> None:
        self._is_done = True
        topic, frame = self._profile.topics.tf_static, self._wire.names.frame
        base = frame(self._profile.frames.base)
        make = MessageMaker(self._wire.types.codec)
        transforms: list[object] = []
        names: list[str] = []
        for name, sensor in self._inputs.sensors.items():
            child, lidar = frame(sensor.frame or name), self._robot.lidars[name]
            if self._when == "auto" and self._inputs.frames.find(base, child) is not None:
                continue
            mount = Pose2D(lidar.x, lidar.y, lidar.yaw)
            transforms.append(make.transform(0.0, base, child, mount, lidar.z))
            names.append(child)
            self._inputs.frames.add(base, child, mount_matrix(lidar.x, lidar.y, lidar.z, lidar.yaw), None)
        if not transforms or topic is None:
            return
        self.published = tuple(names)
        self._wire.outlet(topic, "tf2_msgs/msg/TFMessage", LATCHED).write(make.transforms(transforms))
        self._wire.warnings.note(
            f"nobody publishes {base} → {', '.join(names)}: trundle does, by the robot's file"
            if self._when == "auto"
            else f"published: {base} → {', '.join(names)}"
        )


class StartPose:
    """Publishes where the robot is on /initialpose to everybody who begins to listen: some robots wait for that.

    Args:
        context: The bridge.
        inputs: Knows the time.
        localizer: Where the robot is.
        sources: Which publishers are ours.
    """

    def __init__(
        self,
        context: BridgeContext,
        inputs: RobotInputs,
        localizer: RemoteLocalizer | TfLocalizer,
        sources: Sources,
    ) -> None:
        self._sources = sources
        self._sent: Pose2D | None = None
        self._context, self._inputs, self._localizer = context, inputs, localizer
        self._outlet = context.wire.outlet("initialpose", POSE, Qos(1))
        self._looked = 0.0
        self._told: set[str] = set()

    def open(self) -> None:
        """Look for listeners while the run goes on."""
        self._context.wire.every_round(self._look)

    def _look(self) -> None:
        now = system.monotonic()
        localizer = self._localizer
        pose = localizer.shown
        if now - self._looked < LOOKS_S or localizer.waits_for_pose or pose is None:
            return
        self._looked = now
        try:
            ends = self._context.wire.transport.endpoints(self._outlet.topic)
        except TrundleError:
            return
        others = [one for one in ends if one.kind == "subscription" and not one.ours and one.type_name == POSE]
        listeners = {one.source or one.node for one in others if one.qos.durability == "volatile"}
        if listeners - self._told:
            self._outlet.look()
            if self._outlet.readers < len(listeners):  # what is written now would not reach a new one: the next time
                return
            self._sent = pose
            self._outlet.write(self._context.maker.pose_estimate(self._inputs.now, pose, None, self._frame))
        self._told = listeners

    def is_own(self, message: Any, source: str) -> bool:
        """Return whether a message of /initialpose was sent here: the transport sends it back."""
        ours = self._sources.is_ours(source)
        if ours is None and self._sent is not None:
            return read_pose(message.pose.pose).distance_to(self._sent) < _SAME_M
        return bool(ours)

    @property
    def _frame(self) -> str:
        return self._context.wire.names.frame(self._context.profile.frames.map)
