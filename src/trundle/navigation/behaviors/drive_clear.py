"""`DriveClear`: drive off what the robot touches or nearly touches."""

from __future__ import annotations

import numpy as np

from trundle.control.collision import FOOTPRINT_PADDING_M, can_stop
from trundle.errors import BehaviorFailedError
from trundle.geometry import FloatArray, Twist2D, integrate_twist, shrink_outline
from trundle.navigation.behaviors.behavior import Behavior, BehaviorContext
from trundle.navigation.behaviors.motions import positive

CLEAR_M, CLEAR_MPS = 0.1, 0.15
_TURNS_RADPS = (0.0, 0.3, -0.3, 0.7, -0.7)
_AHEAD_S = (0.5, 1.0, 2.0)
_LATER_WEIGHT = 0.1
_DEPTHS_M = (0.0, 0.04, 0.08, 0.12, 0.16)
_GAIN_M = 0.005
_NEAR_M = 0.05
_MOST_M = 1.0
_VAIN_S = 0.4
_MOVES_MPS, _MOVES_RADPS = 0.01, 0.02
_STAND = Twist2D()


class DriveClear(Behavior):
    """Drive off what the robot touches or nearly touches, as where something has pushed it against a shelf.

    Of short motions, forward and back, straight, curved and turning in place, it drives the one that takes the
    footprint farthest from everything, until there is room on all sides, or no motion makes more of it. A motion that
    does not move the robot, as a collision monitor stops it, is not tried again.

    Args:
        distance: The room to make [m].
        speed: How fast at most [m/s].

    Raises:
        InputError: If one is not a positive number.
    """

    def __init__(self, distance: float = CLEAR_M, speed: float = CLEAR_MPS) -> None:
        self.distance = positive("distance", distance)
        self.speed = positive("speed", speed)
        self._begin()

    def __repr__(self) -> str:
        return f"DriveClear({self.distance:g}, speed={self.speed:g})"

    @property
    def time_allowance(self) -> float:
        """Time in which it can try every motion, and drive one of them [s]."""
        return 15.0

    def helps(self, context: BehaviorContext) -> bool:
        """Whether the robot touches something, or nearly does."""
        pose = np.array(context.pose.as_tuple())
        return float(context.costmap.clearance(pose, cap=_MOST_M)[0]) < _NEAR_M

    def start(self, context: BehaviorContext) -> None:
        """Begin here."""
        self._begin()

    def _begin(self) -> None:
        self._moved = False
        self._driving: Twist2D | None = None
        self._vain_s = 0.0
        self._vain: set[Twist2D] = set()

    def update(self, context: BehaviorContext) -> Twist2D | None:
        """Return the command for the next control period; None where there is room, or no motion makes more of it.

        Raises:
            BehaviorFailedError: If the robot is stuck where it was.
        """
        outline, here = _outline_that_is_free(context)
        if outline is context.costmap.footprint and here >= self.distance:
            return None
        self._watch(context)
        padded = context.robot.planar.padded(FOOTPRINT_PADDING_M).outline
        for command, gain in self._ranked(context, outline, here):
            if gain < _GAIN_M:
                break
            if command in self._vain:
                continue
            limits, dt = context.robot.limits, context.dt
            if can_stop(context.costmap, limits, context.pose, context.twist, command, dt, padded=padded):
                if command != self._driving:
                    self._driving, self._vain_s = command, 0.0
                return command
        if self._moved:
            return None
        raise BehaviorFailedError(
            f"stuck at ({context.pose.x:.2f}, {context.pose.y:.2f}): no motion takes the robot away from what it is at"
        )

    def _watch(self, context: BehaviorContext) -> None:
        """Note whether the motion that is driven moves the robot."""
        if abs(context.twist.v) >= _MOVES_MPS or abs(context.twist.w) >= _MOVES_RADPS:
            self._moved, self._vain_s = True, 0.0
            return
        self._vain_s += context.dt
        if self._driving is not None and self._vain_s >= _VAIN_S:
            self._vain.add(self._driving)

    def _ranked(self, context: BehaviorContext, outline: FloatArray, here: float) -> list[tuple[Twist2D, float]]:
        """Commands, each with the room [m] that it makes, the best one first."""
        commands = self._commands(context)
        x, y, yaw = context.pose.as_tuple()
        poses = np.array([integrate_twist(x, y, yaw, c.v, c.w, time) for c in commands for time in _AHEAD_S])
        room = context.costmap.clearance(poses, cap=_MOST_M, outline=outline).reshape(len(commands), len(_AHEAD_S))
        # What it passes through on the way there counts too: a motion is as good as its best pose before it touches.
        reached = np.where(np.minimum.accumulate(room, axis=1) > 0.0, room, 0.0)
        gains = (reached - here).max(axis=1) + _LATER_WEIGHT * (reached[:, 0] - here)
        return [(commands[index], float(gains[index])) for index in np.argsort(-gains, kind="stable")]

    def _commands(self, context: BehaviorContext) -> list[Twist2D]:
        limits = context.robot.limits
        commands = [Twist2D(v, w) for v in (self.speed, -self.speed, 0.0) for w in _TURNS_RADPS if v or w]
        return [command for command in dict.fromkeys(map(limits.clamp, commands)) if command != _STAND]


def _outline_that_is_free(context: BehaviorContext) -> tuple[FloatArray, float]:
    """The footprint, or the largest smaller outline that touches nothing, and how far from everything it is [m]."""
    costmap = context.costmap
    pose = np.array(context.pose.as_tuple())
    for depth in _DEPTHS_M:
        outline = shrink_outline(costmap.footprint, depth) if depth else costmap.footprint
        if outline is None:
            break
        here = float(costmap.clearance(pose, cap=_MOST_M, outline=outline)[0])
        if here > 0.0:
            return outline, here
    raise BehaviorFailedError(
        f"the robot stands in something that is on the map at ({context.pose.x:.2f}, {context.pose.y:.2f})"
    )
