"""What is assumed of a robot that nobody describes: that it is small, and as fast as its recording shows."""

from __future__ import annotations

from trundle.robots import Robot

UNKNOWN = "unknown"
"""Name of a robot that is not known."""

_HALF_M = 0.1  # nothing is measured nearer to the middle of a robot than this
_LEAST_SPEED, _LEAST_TURN = 1.0, 1.5  # [m/s], [rad/s]: a slow recording does not make a slow robot
_MARGIN = 1.5


def make_unknown_robot(speed: float, turning_speed: float) -> Robot:
    """Return a robot with a small outline, and limits above the highest speeds that were seen [m/s, rad/s].

    What the robot's own body reflects is not left out by such an outline, but by what is always in the scans: see
    `OwnHits`.
    """
    like = Robot.load("nova_carter")
    limits = like.limits.model_copy(
        update={
            "linear_speed": min(100.0, max(_LEAST_SPEED, _MARGIN * speed)),
            "angular_speed": min(100.0, max(_LEAST_TURN, _MARGIN * turning_speed)),
        }
    )
    outline = ((_HALF_M, _HALF_M), (-_HALF_M, _HALF_M), (-_HALF_M, -_HALF_M), (_HALF_M, -_HALF_M))
    return like.model_copy(
        update={"name": UNKNOWN, "limits": limits, "footprint": outline, "lidars": {}, "casters": ()}
    )
