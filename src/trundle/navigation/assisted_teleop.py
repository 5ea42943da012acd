"""`assist_teleop`: what of a command by hand a stop check lets pass."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from trundle.geometry import Twist2D

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
    wish: Twist2D, allowed: Twist2D, can_stop: Callable[[Twist2D], bool], obstacle: str
) -> AssistedCommand:
    """Slow a command by hand down until the robot can stop before it touches something, after Nav2's AssistedTeleop.

    Args:
        wish: The command, within the robot's limits.
        allowed: The same arc within the speed limit, and within what was seen.
        can_stop: Whether a command leaves the robot room to stop.
        obstacle: What it would touch, for the reason.
    """
    for share in _SLOWER:
        slower = Twist2D(share * allowed.v, share * allowed.w)
        if can_stop(slower):
            if share < 1.0:
                return AssistedCommand(slower, f"slowed down before {obstacle}")
            return AssistedCommand(slower, "" if slower == wish else "slowed down by a speed limit or unseen space")
    return AssistedCommand(Twist2D(), f"stopped before {obstacle}")
