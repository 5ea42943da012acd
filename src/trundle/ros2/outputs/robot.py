"""`RobotOutputs`: publishes the robot, its frames, its sensors and the clock of every run; an observer."""

from __future__ import annotations

import math
import threading
import time as clock
import time as real_time
from typing import Any

import numpy as np

from trundle.export.urdf import describe_robot
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.messages.qos import LATCHED, TRANSFORMS, Qos
from trundle.mission import Episode, RunInfo, Step
from trundle.ros2.outputs.lidar import LidarOutput
from trundle.ros2.outputs.motion import EXACT, ContactOutput, JointOutput, MotionOutput
from trundle.ros2.outputs.output import Cadence, Output, Stencil, mark_stamp
from trundle.ros2.role import BridgeContext
from trundle.ros2.static_frames import PATIENCE_S, StaticFrames
from trundle.sim import Substep

GRAVITY = 9.81
"""What an accelerometer at rest measures upwards [m/s²]."""

BATTERY_PERIOD_S = 1.0


class ImuOutput:
    """Publishes the turn, the turn rate and the acceleration of the robot in every control period.

    They are those of the simulation, without noise, in the frame of the base: the robot stays level. The yaw counts
    from the start of the run.

    Args:
        context: The bridge.
        topic: Its topic.
    """

    def __init__(self, context: BridgeContext, topic: str) -> None:
        wire = context.wire
        self._context, self._types = context, wire.types
        self._outlet = wire.outlet(topic, "sensor_msgs/msg/Imu", Qos(10))
        self._frame = wire.names.frame(context.profile.imu_frame)
        self._covariance = np.diag([EXACT] * 3).ravel()
        self._last: tuple[float, Twist2D] | None = None

    def publish(self, step: Step, time: float) -> None:
        """Publish the end of a control period."""
        twist, last = step.state.twist, self._last
        self._last = time, twist
        if not self._outlet.is_wanted:
            return
        is_next = last is not None and 0.0 < time - last[0] < 1.0
        forward = (twist.v - last[1].v) / (time - last[0]) if last is not None and is_next else 0.0
        yaw = wrap_angle(step.state.pose.yaw - self._context.origin.yaw)
        make = self._types.make
        vector, turn = "geometry_msgs/msg/Vector3", "geometry_msgs/msg/Quaternion"
        self._outlet.write(
            make(
                "sensor_msgs/msg/Imu",
                header=self._context.maker.header(time, self._frame),
                orientation=make(turn, z=math.sin(0.5 * yaw), w=math.cos(0.5 * yaw)),
                orientation_covariance=self._covariance,
                angular_velocity=make(vector, z=twist.w),
                angular_velocity_covariance=self._covariance,
                linear_acceleration=make(vector, x=forward, y=twist.v * twist.w, z=GRAVITY),
                linear_acceleration_covariance=self._covariance,
            )
        )


class BatteryOutput:
    """Publishes a battery of which nothing is known, once a second: none is simulated.

    As sensor_msgs/BatteryState has it, what is not measured is NaN, and the states are unknown.

    Args:
        context: The bridge.
        topic: Its topic.
    """

    def __init__(self, context: BridgeContext, topic: str) -> None:
        wire = context.wire
        self._maker, self._types = context.maker, wire.types
        self._outlet = wire.outlet(topic, "sensor_msgs/msg/BatteryState", Qos(10))
        self._cadence = Cadence(BATTERY_PERIOD_S)

    def publish(self, step: Step, time: float) -> None:
        """Publish it, if it is due."""
        if not self._outlet.is_wanted or not self._cadence.is_due(time):
            return
        self._cadence.mark(time)
        numbers = ("voltage", "temperature", "current", "charge", "capacity", "design_capacity", "percentage")
        unknown: dict[str, Any] = dict.fromkeys(numbers, math.nan)
        header = self._maker.header(time, "")
        self._outlet.write(
            self._types.make(
                "sensor_msgs/msg/BatteryState", header=header, present=True, location="not simulated", **unknown
            )
        )


WHEELS_PERIOD_S = 0.05
"""How often the wheels' frames are published [simulated time]: wheels that turn are only looked at."""

_FRAMES_LOOK_S = 1.0


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

    A node that reads the joint states and publishes transforms counts as one.

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
        self._look_at = now + _FRAMES_LOOK_S
        graph = self._wire.transport.graph()
        readers = {one.node for one in graph.subscriptions(self._joints or "") if not one.ours}
        writers = {one.node for one in graph.publishers(self._tf.topic) if not one.ours}
        self._publishes = not (readers & writers - {""})


CLOCK = Qos(10)
"""QoS of /clock: reliable, so that readers who ask for that get it, too; time sources take it as it comes."""

_REPEAT_S = 0.5

_DISCOVERY_S, _LOOK_S = 1.0, 5.0
"""When other clocks are looked for first, and how often then [real time]."""

_TWINS = 6
"""So often a clock of a node of the same name is seen before it is reported: one that was killed is seen for 20 s."""

FASTEST = 10.0
"""How fast a run may pass, relative to real time, for /clock to come from its physics steps."""


class ClockOutput:
    """Publishes the simulated time at a rate, as far as the physics steps are that short.

    While the time stands, it is repeated twice a second of real time, so that nodes that start meanwhile know it.

    Args:
        context: The bridge.
        topic: Its topic.
    """

    def __init__(self, context: BridgeContext, topic: str) -> None:
        wire = context.wire
        self._outlet = wire.outlet(topic, "rosgraph_msgs/msg/Clock", CLOCK)
        message = context.maker.clock(0.0)
        mark_stamp(message.clock)
        self._bytes = Stencil(wire.types.encode(message))
        self._lock = threading.Lock()
        self._clock, self._cadence = context.clock, Cadence(1.0 / context.profile.clock_rate)
        self._written_s = 0.0
        wire.every_round(self._repeat)
        self._wire, self._look_at, self._twins, self._told = wire, real_time.monotonic() + _DISCOVERY_S, 0, False
        wire.every_round(self._look)

    def tick(self, time: float) -> None:
        """Publish a time [s] if it is due."""
        if self._cadence.is_due(time):
            self._write(time)

    def publish(self, step: Step, time: float) -> None:
        """Publish the end of a control period, where no physics step did."""
        self.tick(time)

    def _write(self, time: float) -> None:
        self._cadence.mark(time)
        self._written_s = real_time.monotonic()
        if self._outlet.is_wanted:
            with self._lock:
                data = self._bytes.fill(time)
            self._outlet.write_bytes(data)

    def _look(self) -> None:
        """Say once that another node publishes the clock, too; it is looked for every few seconds."""
        now = real_time.monotonic()
        if self._told or now < self._look_at:
            return
        self._look_at = now + _LOOK_S
        wire = self._wire
        publishers = wire.transport.graph().publishers(self._outlet.topic)
        others = {one.node or "a node without a name" for one in publishers if not one.ours}
        self._twins = self._twins + 1 if len(publishers) > 1 else 0
        if others or self._twins >= _TWINS:
            self._told = True
            names = ", ".join(sorted(others)) or f"another node that is called {wire.transport.node}, too,"
            wire.warn(
                f"{self._outlet.topic}: two clocks",
                f"there is a {self._outlet.topic} of {names} already: nodes on this domain get two times that "
                "contradict each other, unless it is silent. Give each simulator its own domain: --domain, and "
                "ROS_DOMAIN_ID of its nodes",
            )

    def _repeat(self) -> None:
        if 0.0 < self._written_s < real_time.monotonic() - _REPEAT_S:
            self._write(self._clock.now)


def publish_description(context: BridgeContext, topic: str) -> None:
    """Publish the robot as URDF, as robot_state_publisher does."""
    wire = context.wire
    text = describe_robot(context.mission.robot)
    wire.outlet(topic, "std_msgs/msg/String", LATCHED).write(wire.types.make("std_msgs/msg/String", data=text))


class RobotOutputs:
    """Publishes what a simulator of the robot publishes; only what is wanted is made.

    A run that passes more than ten times as fast as real time has /clock once in each control period, which is 500
    times a second at least: more helps nobody, and slows the run.

    Args:
        context: The bridge.

    Attributes:
        static_frames: The fixed frames; None where the profile has no topic for them.
    """

    def __init__(self, context: BridgeContext) -> None:
        self._context = context
        self._is_fast = False
        profile, topics = context.profile, context.profile.topics
        robot = context.mission.robot
        self._ticks_joints = False
        self._clock = None if topics.clock is None else ClockOutput(context, topics.clock)
        self._joints = None if topics.joint_states is None else JointOutput(context, topics.joint_states)
        outputs: list[Output | None] = [self._clock, MotionOutput(context), self._joints]
        outputs += [
            LidarOutput(context, name, robot.lidars[name], sensor) for name, sensor in profile.sensors_of(robot).items()
        ]
        if topics.contacts is not None:
            outputs.append(ContactOutput(context, topics.contacts))
        if topics.imu is not None:
            outputs.append(ImuOutput(context, topics.imu))
        if topics.battery_state is not None:
            outputs.append(BatteryOutput(context, topics.battery_state))
        if profile.wheel_frames:
            outputs.append(WheelFrames(context))
        self._outputs: list[Output] = [output for output in outputs if output is not None]
        self.static_frames = open_static_frames(context)
        if topics.robot_description is not None:
            publish_description(context, topics.robot_description)

    def on_start(self, run: RunInfo) -> None:
        """Let the clock and the odometry begin."""
        self._context.clock.begin()
        self._context.origin = run.start
        self._ticks_joints = self._context.profile.joint_state_rate * run.dt > 1.0 + 1e-9
        self._context.periods.runs += 1

    def on_step(self, step: Step) -> None:
        """Publish a control period."""
        time = self._context.clock.set(step.state.time)
        self._is_fast = self._context.driver.status.factor > FASTEST
        for output in self._outputs:
            output.publish(step, time)
        if step.index:
            self._context.periods.add()

    def on_substep(self, substep: Substep) -> None:
        """Publish the time of a physics step, and joint states that come more often than control periods."""
        time = self._context.clock.set(substep.time)
        if self._clock is not None and not self._is_fast:
            self._clock.tick(time)
        positions, speeds = substep.wheel_positions, substep.wheel_speeds
        if self._ticks_joints and self._joints is not None and positions is not None and speeds is not None:
            self._joints.tick(time, positions, speeds)

    def on_end(self, episode: Episode) -> None:
        """Do nothing: the next run may follow."""
