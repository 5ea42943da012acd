"""`MapOdomInput`: map → odom from outside, and whether it still says where the robot is."""

from __future__ import annotations

from collections import deque
from typing import Any

from trundle.geometry import Pose2D, wrap_angle
from trundle.ros2.remote.guard import Reasons
from trundle.ros2.remote.streams import Stream

_SAME_M, _SAME_RAD = 1e-3, 1e-3
"""A map → odom that differs by less [m, rad] is the one before: AMCL and slam_toolbox repeat theirs until they have
located the robot again."""

_OWN_M, _OWNS_KEPT = 1e-9, 64
"""One that differs by less [m] from one of the last that were published here, for three seconds, is our own."""

_NOTHING = "the robot is not located yet: nobody has published map → odom"


class MapOdomInput:
    """Takes map → odom that others publish. The listening thread writes, the one that drives reads.

    After a jump of clock or odometry, map → odom is that of before until it changes: it places the robot by odometry
    that is no more. One that is only repeated is no news.

    Attributes:
        pose: The newest one, where it says where the robot is; else None.
        why: Why it does not; empty where it does.
        is_static: Whether the newest one was sent once for good, on /tf_static.
        stream: How often it comes.
        published: map → odom as it was published here lately; the transport may send it back without saying whose.
    """

    def __init__(self) -> None:
        self.pose: Pose2D | None = None
        self.why = _NOTHING
        self.is_static = False
        self.stream = Stream("map → odom")
        self.published: deque[Pose2D] = deque(maxlen=_OWNS_KEPT)
        self._before: Pose2D | None = None
        """The one from before a jump, until another one comes."""

    def is_own(self, transform: Any) -> bool:
        """Return whether a transform of a publisher that nobody knows is what was published here."""
        at = transform.transform.translation
        return any(abs(at.x - sent.x) < _OWN_M and abs(at.y - sent.y) < _OWN_M for sent in self.published.copy())

    def take(self, pose: Pose2D, now: float, *, is_static: bool) -> None:
        """Receive a map → odom that came at a real time [s]."""
        self.is_static = is_static
        self.stream.mark(now)
        if self._before is not None and _is_same(pose, self._before):
            return
        self._before, self.pose, self.why = None, pose, ""

    def doubt(self, text: str) -> None:
        """Note a jump of clock or odometry, which this text describes."""
        self._before, self.pose = self.pose or self._before, None
        if self._before is not None:
            self.why = (
                f"{text}, and map → odom is what it was before: give your localizer the pose of the robot; if map → "
                "odom is right as it is, start trundle again"
            )

    # Rules of the guard ---------------------------------------------------------------------------------------------

    def silence(self, now: float) -> Reasons:
        """Return whether it has fallen silent; a rule of the guard where it locates the robot."""
        silent = 0.0 if self.is_static else self.stream.silent_s(now)
        return {"map → odom silent": f"map → odom: nothing new for {silent:.2f} s"} if silent else {}

    def others(self, now: float) -> Reasons:
        """Return whether somebody publishes it; a rule of the guard where trundle locates the robot."""
        stream = self.stream
        if not stream.count or (not self.is_static and now - stream.last > max(1.0, stream.allowed_s)):
            return {}
        return {
            "two localizers": "somebody else publishes map → odom, too: stop that, or give --localizer tf and take it"
        }


def _is_same(one: Pose2D, other: Pose2D) -> bool:
    return one.distance_to(other) < _SAME_M and abs(wrap_angle(one.yaw - other.yaw)) < _SAME_RAD
