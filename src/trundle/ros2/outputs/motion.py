"""What the robot does: its transform, its odometry and how far it may be off, its joints, and what it touches."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np

from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.messages import MessageMaker
from trundle.messages.qos import TRANSFORMS, Qos
from trundle.mission import Step
from trundle.robots import Robot, WheelSpeeds
from trundle.ros2.outputs.output import Cadence, Stencil, mark, mark_stamp, observed
from trundle.ros2.role import BridgeContext
from trundle.ros2.wire import Wire
from trundle.sim import Contact
from trundle.sim.odometry_errors import OdometryErrors

EXACT = 1e-6
"""Variance [m², rad², …] of what has no error: it is not 0, as filters need one that can be inverted."""


class OdometryCovariance:
    """Propagates the errors of odometry along the odometry's own poses, to first order.

    Random errors add up as variances; a bias is the same for the whole run, and its effect adds up before it is
    squared. See Thrun, Burgard and Fox, Probabilistic Robotics, section 5.4, for the motion's Jacobians.

    Args:
        errors: What the odometry is simulated with. If None, it has no errors.
        robot: The robot, for its track.
    """

    def __init__(self, errors: OdometryErrors | None, robot: Robot) -> None:
        self._errors = errors
        self._track = robot.drive.track_width
        self.reset()

    def reset(self) -> None:
        """Begin where the odometry is exact."""
        self._random = np.zeros((3, 3))
        self._biased = np.zeros((3, 2))
        self._last: Pose2D | None = None
        self.pose = _whole(np.zeros((3, 3)))
        self.twist = _whole(np.zeros((3, 3)))

    def update(self, pose: Pose2D, twist: Twist2D, dt: float) -> None:
        """Take the odometry of the next control period.

        Args:
            pose: Pose in the odometry's frame.
            twist: Twist in base_link.
            dt: Length of the period [s].
        """
        errors, last = self._errors, self._last
        self._last = pose
        if errors is None or last is None:
            return
        dx, dy = pose.x - last.x, pose.y - last.y
        driven = math.hypot(dx, dy)
        if driven == 0.0 and pose.yaw == last.yaw:
            return
        along, around = self._variances(driven, abs(pose.yaw - last.yaw))
        motion = np.array([[1.0, 0.0, -dy], [0.0, 1.0, dx], [0.0, 0.0, 1.0]])
        cos, sin = math.cos(last.yaw), math.sin(last.yaw)
        self._random = motion @ self._random @ motion.T
        self._random[:2, :2] += along * np.array([[cos * cos, cos * sin], [cos * sin, sin * sin]])
        self._random[2, 2] += around
        self._biased = motion @ self._biased
        self._biased[:, 0] += (dx, dy, 0.0)
        self._biased[2, 1] += driven
        bias = np.square([errors.scale, errors.heading])
        self.pose = _whole(self._random + (self._biased * bias) @ self._biased.T)
        v_variance = along / dt**2 + (errors.scale * twist.v) ** 2
        w_variance = around / dt**2 + (errors.heading * twist.v) ** 2
        self.twist = _whole(np.diag([v_variance, 0.0, w_variance]))

    def _variances(self, driven: float, turned: float) -> tuple[float, float]:
        """Return the variances that a motion [m, rad] adds to the distance [m²] and to the heading [rad²]."""
        errors = self._errors or OdometryErrors()
        travels = max(2.0 * driven, turned * self._track)  # of both wheels
        along = errors.walk**2 * driven + errors.slip**2 * travels / 4.0
        around = errors.heading_walk**2 * driven + errors.slip**2 * travels / self._track**2
        if errors.slips is not None:
            slips = driven / errors.slips.every
            along += slips * errors.slips.distance**2
            around += slips * errors.slips.heading**2
        return along, around


def _whole(covariance: FloatArray) -> tuple[float, ...]:
    """Return a covariance of (x, y, yaw), shape (3, 3), as the 36 numbers of a message, with `EXACT` added."""
    whole = np.eye(6) * EXACT
    whole[np.ix_((0, 1, 5), (0, 1, 5))] += covariance
    return tuple(whole.ravel().tolist())


ODOMETRY, JOINTS, CONTACTS = Qos(10), Qos(10), Qos(10)

_SIZE_M = 0.1
"""Diameter of the sphere at a contact: large enough to be seen in RViz, small enough to show where it is."""

_SPHERE, _ADD, _DELETE_ALL = 2, 0, 3


class MotionOutput:
    """Publishes odom → base on /tf, and the odometry, with covariances of the errors that it is simulated with.

    Args:
        context: The bridge.
    """

    def __init__(self, context: BridgeContext) -> None:
        wire, profile = context.wire, context.profile
        names, frames, topics = wire.names, profile.frames, profile.topics
        self._context = context
        odom, base = names.frame(frames.odom), names.frame(frames.base)
        self._tf_bytes = _stencil_of_transform(wire, context.maker, odom, base)
        self._odometry_bytes = _stencil_of_odometry(wire, context.maker, odom, base)
        self._tf = wire.outlet(topics.tf, "tf2_msgs/msg/TFMessage", TRANSFORMS)
        self._odometry = None if topics.odom is None else wire.outlet(topics.odom, "nav_msgs/msg/Odometry", ODOMETRY)
        mission = context.mission
        self._covariance = OdometryCovariance(mission.scenario.odometry, mission.robot)
        self._last_s = 0.0

    def publish(self, step: Step, time: float) -> None:
        """Publish the transform and the odometry of a control period."""
        tf, odometry, seen = self._tf, self._odometry, observed(step)
        pose = self._context.odometry(seen)
        if step.index == 0:
            self._covariance.reset()
        self._covariance.update(pose, seen.twist, max(step.state.time - self._last_s, 1e-3))
        self._last_s = step.state.time
        wants_odometry = odometry is not None and odometry.is_wanted
        if not (tf.is_wanted or wants_odometry):
            return
        half = 0.5 * pose.yaw
        place = (pose.x, pose.y, 0.0, 0.0, 0.0, math.sin(half), math.cos(half))
        if tf.is_wanted:
            tf.write_bytes(self._tf_bytes.fill(time, place))
        if odometry is not None and wants_odometry:
            twist = seen.twist
            covariance, speeds = self._covariance, (twist.v, 0.0, 0.0, 0.0, 0.0, twist.w)
            odometry.write_bytes(self._odometry_bytes.fill(time, place, covariance.pose, speeds, covariance.twist))


class JointOutput:
    """Publishes the joints of the drive wheels.

    Args:
        context: The bridge.
        topic: Its topic.
    """

    def __init__(self, context: BridgeContext, topic: str) -> None:
        wire = context.wire
        self._outlet = wire.outlet(topic, "sensor_msgs/msg/JointState", JOINTS)
        wheels = context.mission.robot.drive.wheels
        count = len(wheels)
        self._sides = [0 if wheel.side > 0 else 1 for wheel in wheels]
        message = wire.types.make(
            "sensor_msgs/msg/JointState",
            name=[wheel.joint for wheel in wheels],
            position=mark(0, count),
            velocity=mark(1, count),
        )
        mark_stamp(message.header.stamp)
        self._bytes = Stencil(wire.types.encode(message), (count, count))
        self._cadence = Cadence(1.0 / context.profile.joint_state_rate)

    def publish(self, step: Step, time: float) -> None:
        """Publish the end of a control period, if it is due."""
        state = step.state
        self.tick(time, state.wheel_positions, state.wheel_speeds)

    def tick(self, time: float, positions: WheelSpeeds, speeds: WheelSpeeds) -> None:
        """Publish the angles [rad] and speeds [rad/s] of the wheels, if it is due."""
        if not self._outlet.is_wanted or not self._cadence.is_due(time):
            return
        self._cadence.mark(time)
        sides = self._sides
        data = self._bytes.fill(time, [positions[side] for side in sides], [speeds[side] for side in sides])
        self._outlet.write_bytes(data)


def _stencil_of_transform(wire: Wire, make: MessageMaker, parent: str, child: str) -> Stencil:
    transform = make.transform(0.0, parent, child, Pose2D(0.0, 0.0))
    mark_stamp(transform.header.stamp)
    _mark_pose(transform.transform.translation, transform.transform.rotation)
    return Stencil(wire.types.encode(make.transforms([transform])), (7,))


def _stencil_of_odometry(wire: Wire, make: MessageMaker, frame: str, child: str) -> Stencil:
    message = make.odometry(0.0, frame, child, Pose2D(0.0, 0.0), Twist2D())
    mark_stamp(message.header.stamp)
    _mark_pose(message.pose.pose.position, message.pose.pose.orientation)
    twist = message.twist.twist
    twist.linear, twist.angular = replace(twist.linear), replace(twist.angular)
    (twist.linear.x, twist.linear.y, twist.linear.z), angular = mark(2, 6)[:3].tolist(), mark(2, 6)[3:].tolist()
    twist.angular.x, twist.angular.y, twist.angular.z = angular
    message.pose.covariance, message.twist.covariance = mark(1, 36), mark(3, 36)
    return Stencil(wire.types.encode(message), (7, 36, 6, 36))


def _mark_pose(place: Any, turn: Any) -> None:
    """Put marks into a position and a quaternion."""
    place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = mark(0, 7).tolist()


class ContactOutput:
    """Publishes contacts as visualization_msgs/MarkerArray, once in each control period with one, and once without.

    Each contact is a red sphere where it is, in the frame of the base: its namespace is the name of what is
    touched, its text the part of the robot. The first marker deletes those of before.

    Args:
        context: The bridge.
        topic: Its topic.
    """

    def __init__(self, context: BridgeContext, topic: str) -> None:
        wire = context.wire
        self._types = wire.types
        self._make = context.maker
        self._outlet = wire.outlet(topic, "visualization_msgs/msg/MarkerArray", CONTACTS)
        self._frame = wire.names.frame(context.profile.frames.base)
        self._touched = False

    def publish(self, step: Step, time: float) -> None:
        """Publish the contacts of a control period."""
        contacts = step.state.contacts
        if not self._outlet.is_wanted or not (contacts or self._touched):
            return
        self._touched = bool(contacts)
        header = self._make.header(time, self._frame)
        markers = [self._marker(header, action=_DELETE_ALL)]
        markers += [self._sphere(header, number, contact, step.state.pose) for number, contact in enumerate(contacts)]
        self._outlet.write(self._types.make("visualization_msgs/msg/MarkerArray", markers=markers))

    def _sphere(self, header: Any, number: int, contact: Contact, robot: Pose2D) -> Any:
        make = self._types.make
        x, y = robot.inverse().transform_points([(contact.x, contact.y)])[0].tolist()
        point = make("geometry_msgs/msg/Point", x=x, y=y, z=_SIZE_M)
        upright = make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0)
        return self._marker(
            header,
            action=_ADD,
            ns=contact.other,
            id=number,
            type=_SPHERE,
            text=contact.part,
            pose=make("geometry_msgs/msg/Pose", position=point, orientation=upright),
            scale=make("geometry_msgs/msg/Vector3", x=_SIZE_M, y=_SIZE_M, z=_SIZE_M),
            color=make("std_msgs/msg/ColorRGBA", r=1.0, g=0.1, b=0.1, a=1.0),
        )

    def _marker(self, header: Any, **fields: Any) -> Any:
        return self._types.make("visualization_msgs/msg/Marker", header=header, **fields)
