"""Bad input from the network: the checks that find it, and `Warnings`, which count what is dropped."""

from __future__ import annotations

import logging
import math
import threading
import time as clock
from collections import Counter
from collections.abc import Callable, Collection
from typing import Any

from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D
from trundle.messages import readers

STAMP_S = 0.5
"""A stamp that is farther than this from the simulated time [s] is of the past or the future."""

WALL_S = 60.0
"""How far the clock of another machine may be from this one's [s], for a stamp to be of wall time."""

_LOGGER = logging.getLogger("trundle.ros2")

_SHORTEST = 1e-3
"""A quaternion that is shorter than this is no rotation."""

_FASTEST = 1e6
"""Speeds [m/s, rad/s] and positions [m] beyond this are treated as faults, like numbers that are not finite."""


class BadInputError(InputError):
    """A message from the network that is dropped.

    Attributes:
        kind: What is wrong with it, the same for all that have this fault.
    """

    def __init__(self, kind: str, message: str) -> None:
        super().__init__(message)
        self.kind = kind


def check_stamp(stamp: Any, now: float, *, tolerance_s: float = STAMP_S) -> float:
    """Read a builtin_interfaces/Time in seconds; a stamp of 0 means now.

    Raises:
        BadInputError: If it is too far from the simulated time `now` [s].
    """
    time = readers.read_stamp(stamp)
    if time == 0.0:
        return now
    if abs(time - now) <= tolerance_s:
        return time
    where = "past" if time < now else "future"
    raise BadInputError(
        f"stamp in the {where}",
        f"its stamp {time:.3f} s is {abs(time - now):.3g} s in the {where} of the simulated time {now:.3f} s: set the "
        "parameter use_sim_time of the node that sends it",
    )


def is_wall_time(stamp: Any, now: float) -> bool:
    """Return whether a stamp is of the wall clock, where the simulated time `now` [s] is another one."""
    time, wall = readers.read_stamp(stamp), clock.time()
    return abs(time - wall) <= WALL_S < abs(time - now)


def check_frame(frame_id: str, frames: Collection[str]) -> str:
    """Read a frame without its leading slash; an empty one means the first of `frames`.

    Raises:
        BadInputError: If it is none of these frames.
    """
    frame = readers.read_frame(frame_id)
    if not frame or frame in frames:
        return frame or next(iter(frames))
    raise BadInputError("wrong frame", f"its frame is {frame_id!r}, and not {' or '.join(frames)}")


def check_twist(twist: Any) -> Twist2D:
    """Read forward speed and rotation of a geometry_msgs/Twist.

    Raises:
        BadInputError: If a number is not finite.
    """
    parts = (twist.linear.x, twist.linear.y, twist.linear.z, twist.angular.x, twist.angular.y, twist.angular.z)
    if not all(math.isfinite(part) and abs(part) <= _FASTEST for part in parts):
        raise BadInputError("not finite", f"its speeds are {parts}, which are not all finite")
    return Twist2D(float(twist.linear.x), float(twist.angular.z))


def check_pose(pose: Any) -> Pose2D:
    """Read the pose on the floor of a geometry_msgs/Pose.

    Raises:
        BadInputError: If a number is not finite, or the quaternion is no rotation.
    """
    at, turn = pose.position, pose.orientation
    numbers = (at.x, at.y, at.z, turn.x, turn.y, turn.z, turn.w)
    if not all(math.isfinite(number) for number in numbers):
        raise BadInputError("not finite", "a number of its pose is not finite")
    if math.hypot(turn.x, turn.y, turn.z, turn.w) < _SHORTEST:
        raise BadInputError(
            "no rotation", "its quaternion has length 0, which is no rotation: give w = 1 for no rotation"
        )
    if math.hypot(at.x, at.y, at.z) > _FASTEST:
        raise BadInputError("too far", f"its position ({at.x:g}, {at.y:g}) is more than {_FASTEST:g} m away")
    length = math.hypot(turn.x, turn.y, turn.z, turn.w)
    x, y, z, w = turn.x / length, turn.y / length, turn.z / length, turn.w / length
    yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return Pose2D(float(at.x), float(at.y), yaw)


MOST_KINDS, OTHER_KINDS = 300, "others"
"""So many kinds of warnings are told apart; all others are one."""


class Warnings:
    """Counts what is dropped, and warns of the first of each kind; any thread may use it.

    Args:
        report: Gets each first warning. If None, the log does.

    Attributes:
        listeners: Get each report, too.
    """

    def __init__(self, report: Callable[[str], None] | None = None) -> None:
        self._report = report
        self._lock = threading.Lock()
        self._counts: Counter[str] = Counter()
        self.listeners: list[Callable[[str], None]] = []

    @property
    def counts(self) -> dict[str, int]:
        """How often each kind came, those that came first at the front."""
        with self._lock:
            return dict(self._counts)

    def warn(self, kind: str, text: str | Callable[[], str]) -> None:
        """Count one of a kind; the first one is reported.

        Args:
            kind: The kind, such as "cmd_vel: not finite".
            text: What came, and what becomes of it; or what makes that text, for the first one alone.
        """
        with self._lock:
            if kind not in self._counts and len(self._counts) >= MOST_KINDS:  # names in them may be anyone's
                kind, text = OTHER_KINDS, f"there are more than {MOST_KINDS} kinds of faults"
            self._counts[kind] += 1
            if self._counts[kind] > 1:
                return
        text = text if isinstance(text, str) else text()
        self.note(f"{text}; further ones are counted, and not reported")

    def note(self, text: str) -> None:
        """Report something every time, such as a connection that was lost."""
        for listener in tuple(self.listeners):
            listener(text)
        if self._report is not None:
            self._report(text)
        else:
            _LOGGER.warning("%s", text)

    def summary(self) -> str:
        """Return what was counted, in one line; empty where nothing was."""
        return ", ".join(f"{kind} ({count})" for kind, count in self.counts.items())
