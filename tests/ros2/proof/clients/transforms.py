"""Looks up transforms as programs do with tf2_ros, which has no wheel; prints what it finds as JSON.

transforms.py BASE LIDAR X Y sends the robot to (X, Y), and keeps /tf and /tf_static as tf2_ros' TransformListener does:
with its QoS, ten seconds of each frame, interpolated between the two nearest, and no extrapolation. As users of a
Buffer do, it looks up map → base at the newest common time, at the stamps of poses and scans, in the past and ahead.
"""

import bisect
import json
import math
import sys
import time

import rclpy
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan
from tf2_msgs.msg import TFMessage

KEPT_S = 10.0


class LookupException(Exception):  # noqa: N818 - its name in tf2
    """A frame is not known."""


class ConnectivityException(Exception):  # noqa: N818 - its name in tf2
    """Two frames are in no common tree."""


class ExtrapolationException(Exception):  # noqa: N818 - its name in tf2
    """There is no transform at this time."""


class Buffer:
    """Planar transforms (x, y, yaw) of each frame in its parent, by their stamps."""

    def __init__(self):
        self.moving, self.fixed = {}, {}

    def add(self, message, is_static):
        for one in message.transforms:
            at, turn = one.transform.translation, one.transform.rotation
            yaw = math.atan2(2.0 * (turn.w * turn.z + turn.x * turn.y), 1.0 - 2.0 * (turn.y**2 + turn.z**2))
            pose = at.x, at.y, yaw
            if is_static:
                self.fixed[one.child_frame_id] = one.header.frame_id, pose
                continue
            kept = self.moving.setdefault(one.child_frame_id, [])
            bisect.insort(kept, (seconds(one.header.stamp), one.header.frame_id, pose))
            while kept[-1][0] - kept[0][0] > KEPT_S:
                del kept[0]

    def parents(self, frame):
        found = []
        while frame in self.fixed or frame in self.moving:
            found.append(frame)
            frame = self.fixed[frame][0] if frame in self.fixed else self.moving[frame][-1][1]
        return [*found, frame]

    def chain(self, target, source):
        """The frames from the source up to the target, which is above it here, as map is above all."""
        frames = self.parents(source)
        if len(frames) == 1:
            raise LookupException(source)
        if target not in frames:
            raise ConnectivityException(f"{source} is in {frames[-1]}, not in {target}")
        return frames[: frames.index(target)]

    def newest(self, target, source):
        """The newest time at which all between are known."""
        return min(self.moving[one][-1][0] for one in self.chain(target, source) if one in self.moving)

    def lookup(self, target, source, at):
        pose = 0.0, 0.0, 0.0
        for frame in self.chain(target, source):
            pose = compose(self.fixed[frame][1] if frame in self.fixed else self.between(frame, at), pose)
        return pose

    def between(self, frame, at):
        kept = self.moving[frame]
        index = bisect.bisect_left(kept, (at,))
        if index == len(kept) or (index == 0 and at < kept[0][0]):
            raise ExtrapolationException(f"{frame} at {at}, known from {kept[0][0]} to {kept[-1][0]}")
        after = kept[index]
        if after[0] == at:
            return after[2]
        before = kept[index - 1]
        share = (at - before[0]) / (after[0] - before[0])
        turned = math.remainder(after[2][2] - before[2][2], math.tau)
        x, y = (one + share * (two - one) for one, two in zip(before[2][:2], after[2][:2], strict=True))
        return x, y, before[2][2] + share * turned


def compose(first, second):
    c, s = math.cos(first[2]), math.sin(first[2])
    return first[0] + c * second[0] - s * second[1], first[1] + s * second[0] + c * second[1], first[2] + second[2]


def seconds(stamp):
    return stamp.sec + 1e-9 * stamp.nanosec


base, lidar, goal = sys.argv[1], sys.argv[2], (float(sys.argv[3]), float(sys.argv[4]))
rclpy.init()
node = rclpy.create_node("looks_up")
buffer, poses, scans = Buffer(), [], []
latched = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_subscription(TFMessage, "/tf", lambda message: buffer.add(message, False), QoSProfile(depth=100))
node.create_subscription(TFMessage, "/tf_static", lambda message: buffer.add(message, True), latched)
node.create_subscription(PoseWithCovarianceStamped, "/amcl_pose", poses.append, latched)
node.create_subscription(LaserScan, "/front/scan", scans.append, qos_profile_sensor_data)
goals = node.create_publisher(PoseStamped, "/goal_pose", 10)


def spin(done, what):
    until = time.monotonic() + 60.0
    while not done():
        if time.monotonic() > until:
            sys.exit(f"waited in vain {what}: {sorted(buffer.moving)}, {sorted(buffer.fixed)}")
        rclpy.spin_once(node, timeout_sec=0.05)


def known(source):
    """Return whether a lookup at the newest common time works, as can_transform does."""
    try:
        return bool(buffer.lookup("map", source, buffer.newest("map", source)))
    except (LookupException, ConnectivityException, ExtrapolationException):
        return False


def failure(target, source, at):
    try:
        buffer.lookup(target, source, at)
    except Exception as error:  # noqa: BLE001 - its name is what is asked for
        return type(error).__name__
    return ""


spin(lambda: known(base) and known(lidar) and goals.get_subscription_count(), "for the frames")
began = buffer.lookup("map", base, buffer.newest("map", base))
message = PoseStamped()
message.header.frame_id, message.pose.orientation.w = "map", 1.0
message.pose.position.x, message.pose.position.y = goal
goals.publish(message)


def moved():
    x, y, _ = buffer.lookup("map", base, buffer.newest("map", base))
    return math.hypot(x - began[0], y - began[1])


spin(lambda: moved() > 0.5, "for a motion")
del poses[:], scans[:]
spin(lambda: len(poses) >= 5 and len(scans) >= 5, "for poses and scans")
newest = max(seconds(one.header.stamp) for one in (*poses, *scans))
spin(lambda: buffer.newest("map", lidar) >= newest, "for tf at their stamps")
off = []
for one in poses:
    x, y, _ = buffer.lookup("map", base, seconds(one.header.stamp))
    off.append(math.hypot(x - one.pose.pose.position.x, y - one.pose.pose.position.y))
mounts = []
for one in scans:
    at = seconds(one.header.stamp)
    robot, sensor = buffer.lookup("map", base, at), buffer.lookup("map", one.header.frame_id, at)
    mounts.append(math.hypot(sensor[0] - robot[0], sensor[1] - robot[1]))
now = buffer.newest("map", base)
found = {
    "moved": moved(),
    "off": max(off),
    "mounts": [min(mounts), max(mounts)],
    "past": math.hypot(*(a - b for a, b in zip(buffer.lookup("map", base, now - 0.4)[:2], began[:2], strict=True))),
    "ahead": failure("map", base, now + 5.0),
    "before": failure("map", base, now - 100.0),
    "unknown": failure("map", "camera", now),
}
print(json.dumps(found))
