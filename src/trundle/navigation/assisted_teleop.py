"""`assist_teleop`: what of a command by hand the navigator's stop check lets pass."""

from __future__ import annotations

from dataclasses import dataclass

from trundle.control.collision import can_stop
from trundle.geometry import FloatArray, Twist2D
from trundle.navigation.drive import Now
from trundle.robots import Limits

_SLOWER = (1.0, 0.75, 0.5, 0.25, 0.1)


@dataclass(frozen=True, slots=True)
class AssistedCommand:
    """What may be sent of a command by hand.

    Attributes:
        command: The same arc, as fast as it may be driven; (0, 0) where it may not.
        reason: What held it back; empty where nothing did.
    """

    command: Twist2D
    reason: str = ""


def assist_teleop(
    wish: Twist2D, allowed: Twist2D, now: Now, limits: Limits, dt: float, *, padded: FloatArray
) -> AssistedCommand:
    """Slow a command by hand down until the robot can stop before it touches something, after Nav2's AssistedTeleop.

    Args:
        wish: The command, within the robot's limits.
        allowed: The same arc within the speed limit, and within what was seen.
        now: Where the robot is when the command takes effect, and the costmap.
        limits: Of the robot.
        dt: For how long it is sent [s].
        padded: The footprint's outline [m], base_link, widened by the clearance to keep.
    """
    for share in _SLOWER:
        slower = Twist2D(share * allowed.v, share * allowed.w)
        if can_stop(now.costmap, limits, now.pose, now.twist, slower, dt, padded=padded):
            if share < 1.0:
                return AssistedCommand(slower, "slowed down before an obstacle of the costmap")
            return AssistedCommand(slower, "" if slower == wish else "slowed down by a speed limit or unseen space")
    return AssistedCommand(Twist2D(), "stopped before an obstacle of the costmap")
