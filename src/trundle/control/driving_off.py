"""`DrivingOff`: how fast a command may speed a robot up, so that neither of its wheels slips."""

from __future__ import annotations

from trundle.geometry import Twist2D
from trundle.robots import Robot

_LEAD_S = 0.2
"""How far commands may lead what the robot reaches: with less, motors that lag behind would hardly speed it up."""

_LEAST_SHARE = 0.25
"""Share of the acceleration that is left in any turn, so that a robot that turns all the time still drives off."""


class DrivingOff:
    """Limits how fast commands speed a robot up: the outer wheel's acceleration stays within that of the robot.

    A robot that drives off while it still turns asks its outer wheel for both accelerations at once. Where the wheel
    then slips, odometry counts a turn that the robot did not make. So the more the turning speed changes, the less the
    speed may grow; the arc stays the same. Braking is not limited.

    Args:
        robot: What is driven.
        acceleration: Of each wheel along the floor [m/s²].
    """

    def __init__(self, robot: Robot, acceleration: float) -> None:
        self._limits, self._half_track = robot.limits, robot.drive.track_width / 2.0
        self._acceleration = acceleration
        self.reset()

    def reset(self) -> None:
        """Forget the last command."""
        self._last = 0.0

    def limit(self, command: Twist2D, twist: Twist2D, dt: float) -> Twist2D:
        """The same arc, not faster than may be commanded for the next `dt` [s] to a robot that moves with `twist`.

        Speeds grow from the last command, which may lead what the robot reaches by 0.2 s of its acceleration: a robot
        whose motors lag behind would hardly speed up otherwise.
        """
        forward = 1.0 if command.v >= 0.0 else -1.0
        wanted, moving = abs(command.v), max(0.0, forward * twist.v)
        most = moving + self._acceleration * _LEAD_S
        base = min(max(moving, forward * self._last), most)
        step = self._acceleration * dt
        slowest = base + _LEAST_SHARE * step
        if wanted <= slowest:
            return command
        turned = max(abs(share * command.w - twist.w) for share in (1.0, slowest / wanted))
        across = self._half_track * min(turned, self._limits.angular_acceleration * dt)
        share = min(1.0, max(slowest, base + step - across) / wanted)
        return Twist2D(share * command.v, share * command.w)

    def note(self, command: Twist2D) -> None:
        """Take the command that was chosen."""
        self._last = command.v
