"""`RobotInputs`: what the robot sends, heard in the wire's thread and taken by the one that drives."""

from __future__ import annotations

import math
import threading
import time as system
from collections import Counter, deque
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.messages import readers
from trundle.messages.qos import LATCHED, Qos
from trundle.observation import Scan
from trundle.robots import Robot
from trundle.ros2.bad_input import BadInputError
from trundle.ros2.profile import Profile
from trundle.ros2.remote.commands import Sources
from trundle.ros2.remote.frames import MOST_FRAMES, FrameTree, Mounts
from trundle.ros2.remote.guard import Guard, OutlineCheck, Reasons
from trundle.ros2.remote.map_odom import MapOdomInput
from trundle.ros2.remote.scans import Odometry, ScanInputs, read_odometry
from trundle.ros2.remote.streams import AHEAD_S, WALL_S, RobotClock, Stream
from trundle.ros2.wire import Wire

AS_IT_COMES = Qos(20, "best_effort")
"""QoS of what is read: best effort matches publishers of both kinds."""

OLD_S = 1.0
"""Messages whose stamps are older than this [s] are dropped."""

MOST_SCANS = 20
"""So many scans wait at most: a navigator that is busy for longer does without the older ones."""

JUMP_M, JUMP_RAD, JUMP_TIMES = 0.3, 0.5, 3.0
"""Odometry that moves by more than this, and so many times as fast as the robot can, has jumped."""

APART_M, APART_RAD = 0.5, 0.5
"""Odometry of the topic and of tf that have moved so far apart since both began disagree."""

ZEROS = 3
"""So many stamps of 0 are no clock that begins: a simulation has one before its first /clock is here."""


class RobotInputs:
    """Listens to the robot's clock, transforms, odometry and scans.

    Args:
        wire: The network.
        profile: Names of topics and frames.
        robot: The robot, with its lidars.
        guard: Is told of jumps.
        sources: Which publishers are ours.
        real, wall: Real time [s], from any origin, and this machine's clock.

    Attributes:
        clock: What time it is there.
        frames: The transforms.
        odometry: The newest odometry, or None.
        map_odom: map → odom from outside.
        changed: Notified when scans have arrived: once for all that were heard at a time, as those of two lidars are.
        outline: Whether the robot has the outline of its file.
    """

    def __init__(
        self,
        wire: Wire,
        profile: Profile,
        robot: Robot,
        guard: Guard,
        sources: Sources,
        *,
        real: Callable[[], float] = system.monotonic,
        wall: Callable[[], float] = system.time,
    ) -> None:
        self._wire, self._profile, self._robot, self._guard, self._sources = wire, profile, robot, guard, sources
        self._real, self._wall = real, wall
        frame, frames = wire.names.frame, profile.frames
        self._map, self._odom, self._base = frame(frames.map), frame(frames.odom), frame(frames.base)
        self.sensors = {name: one for name, one in profile.sensors_of(robot).items() if one.scan or one.points}
        self.clock, self.frames = RobotClock(), FrameTree()
        self.odometry: Odometry | None = None
        self.map_odom = MapOdomInput()
        self.changed = threading.Condition()
        self.odometry_stream, self.tf_stream = Stream("odometry"), Stream("odometry of tf")
        self.scan_streams = {name: Stream(f"scans of {name}") for name in self.sensors}
        self.jumps = 0
        self._heard: list[Scan] = []
        self._scans: deque[Scan] = deque(maxlen=MOST_SCANS)
        self.outline = OutlineCheck(self.frames, self._base, robot)
        mounts = Mounts(wire, self.frames, self._base, robot)
        self._laser = ScanInputs(wire, robot, mounts, self._time_of, self._take_scan, real)
        self._by_tf: Odometry | None = None
        self._topic_stamp = -math.inf
        self._apart: tuple[Pose2D, Pose2D] | None = None
        self._zeros: Counter[str] = Counter()
        self._ahead: dict[str, float] = {}

    def open(self) -> None:
        """Listen."""
        wire, topics = self._wire, self._profile.topics
        if topics.clock is not None:
            clock = "rosgraph_msgs/msg/Clock"
            wire.listen(topics.clock, clock, AS_IT_COMES, self._take_clock, newest=True, wakes=False)
        transforms = "tf2_msgs/msg/TFMessage"
        wire.listen(topics.tf, transforms, Qos(100, "best_effort"), self._take_moving, wakes=False)
        if topics.tf_static is not None:
            wire.listen(topics.tf_static, transforms, replace(LATCHED, depth=100), self._take_static)
        if topics.odom is not None:
            wire.listen(topics.odom, "nav_msgs/msg/Odometry", AS_IT_COMES, self._take_odometry, wakes=False)
        for name, sensor in self.sensors.items():
            self._laser.listen(name, sensor)
        wire.every_round(self._pass_on_scans)
        wire.every_round(self._laser.look)
        wire.every_round(self.outline.look)

    # The thread that drives -----------------------------------------------------------------------------------------

    @property
    def now(self) -> float:
        """What time it is there [s]."""
        return self.clock.now(self._wall())

    def take_scans(self) -> list[Scan]:
        """Return the scans that have arrived since, with times of the robot's clock."""
        with self.changed:
            found = list(self._scans)
            self._scans.clear()
        return found

    def wait_for_scan(self, timeout_s: float) -> bool:
        """Wait for a scan, and return whether there is one."""
        with self.changed:
            return self.changed.wait_for(lambda: bool(self._scans), max(0.0, timeout_s))

    @property
    def scan_period(self) -> float | None:
        """The shortest mean interval between scans of one lidar [s]; None without scans."""
        periods = [stream.period for stream in self.scan_streams.values() if stream.period is not None]
        return min(periods) if periods else None

    # Clock and transforms -------------------------------------------------------------------------------------------

    def _take_clock(self, message: Any, source: str) -> None:
        if self._sources.is_ours(source):
            return
        is_first = not self.clock.is_simulated
        if self.clock.set(readers.read_stamp(message.clock), self._real()):
            self._jumped("clock jumped", f"the time of {self._profile.topics.clock} has jumped")
        elif is_first:  # what came before has times of another clock
            self._forget()
        elif self.clock.is_slow:
            text = f"{self._profile.topics.clock} goes on in steps of {self.clock.least_step:.2f} s"
            self._wire.warn("/clock: slow", f"{text}: stamps tell the time in between")

    def _jumped(self, kind: str, text: str) -> None:
        """Forget what was before a jump, and let the robot stand: it has to be told where it is."""
        self.jumps += 1
        self._forget()
        self.map_odom.doubt(text)
        self._guard.hold(kind, text, self._real())

    def _forget(self) -> None:
        with self.changed:
            self._heard.clear()
            self._scans.clear()
            self._laser.clear()
            self.frames.clear_moving()
            self.odometry = self._by_tf = self._apart = None
            self._topic_stamp = -math.inf

    def _take_static(self, message: Any, source: str) -> None:
        self._take_transforms(message, source, is_static=True)

    def _take_moving(self, message: Any, source: str) -> None:
        self._take_transforms(message, source, is_static=False)

    def _take_transforms(self, message: Any, source: str, *, is_static: bool) -> None:
        ours = self._sources.is_ours(source)
        if ours:
            return
        moved = located = False
        for one in message.transforms:
            parent, child = readers.read_frame(one.header.frame_id), readers.read_frame(one.child_frame_id)
            if (parent, child) == (self._map, self._odom) and ours is None and self.map_odom.is_own(one):
                continue
            stamp = readers.read_stamp(one.header.stamp)
            try:
                why = self.frames.add(parent, child, readers.read_matrix(one.transform), None if is_static else stamp)
            except InputError as error:
                why = str(error)
            if why:
                kind = "tf: frames" if len(self.frames) >= MOST_FRAMES else f"tf: {child}"
                text = f"a transform of {self._wire.describe_source(source)} is dropped: {why}"
                self._wire.warn(kind, text)
                if {parent, child} == {self._odom, self._base}:
                    self._contradicts(f"a transform {parent} → {child} is no part of one tree")
                continue
            if (parent, child) == (self._map, self._odom):
                located = True
            elif child in self.frames.moved:
                first, second = self.frames.moved.pop(child)
                self._wire.warn(
                    f"tf: two parents of {child}",
                    f"tf has two parents of {child}: {first} and {second}; the newest counts",
                )
                if child in (self._odom, self._base):
                    self._contradicts(f"tf has two parents of {child}: {first} and {second}")
            moved |= not is_static and parent != self._map
        if moved:
            self._take_odometry_of_tf()
        found = self.frames.find(self._map, self._odom) if located else None
        if found is not None:  # after the odometry, which may have jumped: a message may have new ones of both
            self.map_odom.take(found.pose, self._real(), is_static=is_static)

    def find_on_robot(self, frame: str) -> Pose2D | None:
        """Return where a frame is on the robot by tf, in the listening thread; None where nobody says that."""
        found = self.frames.find(self._base, frame)
        return None if found is None or self.frames.parent(frame) is None else found.pose

    def _contradicts(self, text: str) -> None:
        """Let the robot stand while two publishers of tf disagree where it is."""
        self._guard.hold("tf contradicts", f"{text}: stop one of its publishers", self._real())

    def _take_odometry_of_tf(self) -> None:
        found = self.frames.find(self._odom, self._base)
        if found is None or found.time is None:
            return
        before, pose = self._by_tf, found.pose
        if before is not None and found.time <= before.time and found.time != 0.0:
            return
        time = self._time_of(found.time, "tf")
        if time is None:
            return
        twist = Twist2D()
        if before is not None and 0.0 < time - before.time < 1.0:
            step, passed = before.pose.inverse() @ pose, time - before.time
            twist = Twist2D(step.x / passed, step.yaw / passed)
            if passed < 0.03:  # smooth: a short interval makes large speeds of small errors
                twist = Twist2D(0.5 * (twist.v + before.twist.v), 0.5 * (twist.w + before.twist.w))
        self._by_tf = Odometry(time, pose, twist)
        self.tf_stream.mark(self._real())
        if not self.odometry_stream.count or self.odometry_stream.silent_s(self._real()):
            self._put_odometry(self._by_tf)

    # Odometry -------------------------------------------------------------------------------------------------------

    def _take_odometry(self, message: Any, source: str) -> None:
        try:
            stamp, pose, twist = read_odometry(message)
        except BadInputError as error:
            self._drop("odometry", error.kind, str(error), source)
            return
        frame, child = readers.read_frame(message.header.frame_id), readers.read_frame(message.child_frame_id)
        if (frame, child) != (self._odom, self._base):
            self._wire.warn(
                "odometry: frames",
                f"the odometry has frames {frame!r} and {child!r} in place of {self._odom!r} and {self._base!r}; it is "
                "taken as it is",
            )
        if not np.any(message.pose.covariance):
            self._wire.warn("odometry: covariance of 0", "the odometry has a covariance of 0, which is no covariance")
        time = self._time_of(stamp, "odometry")
        if time is None:
            return
        last = self.odometry
        is_repeated = last is not None and time <= last.time and self.odometry_stream.count
        if is_repeated and stamp > self._topic_stamp:  # tf was faster, while the topic was silent
            self._topic_stamp = stamp
            self.odometry_stream.mark(self._real())
            return
        self._topic_stamp = stamp
        if last is not None and is_repeated:
            if stamp != 0.0:
                self._wire.warn(
                    "odometry: repeated stamp", "an odometry is not newer than the one before: it is dropped"
                )
                return
            time = math.nextafter(last.time, math.inf)
        self.odometry_stream.mark(self._real())
        self._put_odometry(Odometry(time, pose, twist))
        self._compare(pose)

    def _put_odometry(self, new: Odometry) -> None:
        last, limits = self.odometry, self._robot.limits
        if last is not None:
            passed = max(new.time - last.time, 0.02)
            moved, turned = last.pose.distance_to(new.pose), abs(wrap_angle(new.pose.yaw - last.pose.yaw))
            fast, quick = JUMP_TIMES * limits.linear_speed * passed, JUMP_TIMES * limits.angular_speed * passed
            if moved > JUMP_M + fast or turned > JUMP_RAD + quick:
                self._jumped("odometry jumped", f"the odometry has jumped by {moved:.2f} m and {turned:.2f} rad")
                new = replace(new, twist=Twist2D())  # that of tf is the jump's
        with self.changed:
            self.odometry = new

    def _compare(self, pose: Pose2D) -> None:
        """Let the robot stand where the topic and tf have moved differently since both began."""
        other = self._by_tf
        if other is None or self.tf_stream.silent_s(self._real()) or self.odometry is None:
            self._apart = None
            return
        if abs(other.time - self.odometry.time) > 0.1:
            return
        if self._apart is None:
            self._apart = pose, other.pose
            return
        first, first_tf = self._apart
        one, two = first.inverse() @ pose, first_tf.inverse() @ other.pose
        if one.distance_to(two) > APART_M or abs(wrap_angle(one.yaw - two.yaw)) > APART_RAD:
            text = f"the odometry of its topic and that of tf are {one.distance_to(two):.2f} m apart"
            self._guard.hold("odometry disagrees", text, self._real())

    def _take_scan(self, scan: Scan) -> None:
        self.scan_streams[scan.lidar].mark(self._real())
        self._heard.append(scan)

    def _pass_on_scans(self) -> None:
        """Pass what was heard on to the driving thread; a control period for each scan would be too many."""
        if self._heard:
            with self.changed:
                self._scans += self._heard
                self._heard.clear()
                self.changed.notify_all()

    # Stamps ---------------------------------------------------------------------------------------------------------

    def _time_of(self, stamp: float, what: str) -> float | None:
        """Return the time that a stamp stands for [s]; None where it is of another time, and the message is dropped."""
        wall = self._wall()
        begins = self.clock.is_simulated and self.clock.now(wall) < OLD_S  # 0 is a time then
        if stamp == 0.0 and not begins:
            self._zeros[what] += 1
            if self._zeros[what] >= ZEROS:
                self._wire.warn(f"{what}: stamp of 0", f"{what}: stamps are 0; messages count as sent when they arrive")
            return self.clock.now(wall)
        epoch = self.clock.epoch
        self.clock.see(stamp, wall)
        if self.clock.epoch != epoch:
            self._forget()
            self._compare_clocks(what, stamp - wall)
        self._ahead[what] = stamp - wall
        now = self.clock.now(wall)
        if stamp > now + AHEAD_S:
            self._drop(what, "stamp in the future", f"its stamp {stamp:.3f} s is ahead of the time {now:.3f} s", "")
            return None
        if stamp < now - OLD_S:
            self._drop(what, "stamp in the past", f"its stamp {stamp:.3f} s is {now - stamp:.2f} s old", "")
            return None
        if lead := self.clock.lead(what, stamp):
            text = f"{what}: stamps are {lead:.2f} s ahead of /clock, and taken as they are"
            self._wire.warn(f"{what}: stamp ahead of /clock", text)
        return stamp

    def _compare_clocks(self, what: str, ahead: float) -> None:
        """Let the robot stand where stamps say another time than those before: that of another clock, or a new one."""
        apart = {one: abs(ahead - known) for one, known in self._ahead.items()}
        if not apart:
            return
        other = what if apart.get(what, 0.0) > WALL_S else max(apart, key=lambda one: apart[one])
        text = f"stamps of {what} and of {other} are {apart[other]:.1f} s apart: set their clocks"
        if other == what:
            text = f"stamps of {what} have jumped by {apart[what]:.1f} s"
        self._guard.hold("clocks differ", text, self._real())

    def _drop(self, what: str, kind: str, text: str, source: str) -> None:
        self._wire.warn(
            f"{what}: {kind}",
            lambda: f"{what}: a message of {self._wire.describe_source(source)} is dropped: {text}",
        )

    # Rules of the guard ---------------------------------------------------------------------------------------------

    def silences(self, now: float) -> Reasons:
        """Return what has fallen silent, each by its own rate, apart from the odometry; a rule of the guard."""
        found: Reasons = {}
        streams = list(self.scan_streams.values())
        if self.clock.is_simulated:
            streams.append(self.clock.stream)
        for stream in streams:
            silent = stream.silent_s(now)
            if silent:
                found[f"{stream.name} silent"] = f"{stream.name}: nothing new for {silent:.2f} s"
            elif not stream.count:
                found[f"{stream.name} missing"] = f"{stream.name}: nothing has come yet"
        return found

    @property
    def odometry_silent(self) -> bool:
        """Whether neither the topic nor tf has sent odometry lately."""
        now = self._real()
        streams = [one for one in (self.odometry_stream, self.tf_stream) if one.count]
        return all(one.silent_s(now) > 0.0 for one in streams)
