"""`OutlineCheck`: whether the robot's file has the outline of the robot that is there."""

from __future__ import annotations

import numpy as np

from trundle.geometry import Pose2D
from trundle.robots import Robot
from trundle.ros2.remote.frames import FrameTree
from trundle.ros2.remote.guard import Reasons

OUTSIDE_M = 0.05
"""Middles of wheels that are farther than this outside of the outline [m] are those of a larger robot."""

_WHEEL = "wheel"


class OutlineCheck:
    """Lets a robot stand whose wheels, by tf, are outside of the outline that its file gives.

    Nothing else that robots usually send says how large they are: one that publishes no frames of its wheels is taken
    as its file has it.

    Args:
        frames: The transforms.
        base: Frame of the robot's base.
        robot: The robot, by its file.
    """

    def __init__(self, frames: FrameTree, base: str, robot: Robot) -> None:
        self._frames, self._base, self._robot = frames, base, robot
        self._seen = 0
        self._reasons: Reasons = {}

    def look(self) -> None:
        """Look at the frames if there are new ones; in the thread that has them."""
        if len(self._frames) == self._seen:
            return
        self._seen = len(self._frames)
        wheels = {name: at.pose for name, at in self._frames.below(self._base).items() if _WHEEL in name.lower()}
        out = {name: _outside(pose, self._robot) for name, pose in wheels.items()}
        name = max(out, key=lambda one: out[one], default="")
        if not name or out[name] <= OUTSIDE_M:
            self._reasons = {}
            return
        x, y, _ = wheels[name].as_tuple()
        self._reasons = {
            "outline": f"by tf {name} is at ({x:.2f}, {y:.2f}), outside of the outline of {self._robot.name}: give the "
            "file of the robot that is there with --robot"
        }

    def rule(self, now: float) -> Reasons:
        """Return what was found; a rule of the guard."""
        return self._reasons


def _outside(pose: Pose2D, robot: Robot) -> float:
    """Return how far a point is outside of the outline, which is convex and counter-clockwise [m]."""
    corners = np.asarray(robot.outline, dtype=np.float64)
    sides = np.roll(corners, -1, axis=0) - corners
    outward = np.column_stack([sides[:, 1], -sides[:, 0]]) / np.linalg.norm(sides, axis=1)[:, None]
    return float(((np.array((pose.x, pose.y)) - corners) * outward).sum(axis=1).max())
