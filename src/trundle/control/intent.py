"""`Intent`: what a controller means to command after its command."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from trundle.geometry import FloatArray, Twist2D, integrate_twist

_SAME = 1e-3  # [m/s] and [rad/s]: rounding in single precision is below it


@dataclass(frozen=True, slots=True, eq=False)
class Intent:
    """How a controller means to drive from now on, if nothing changes.

    Attributes:
        twists: Commands (v, w) [m/s, rad/s] one after the other, shape (N, 2); the first is the one that it returned.
        step_s: How long each is kept up [s]; the last one from then on.
    """

    twists: FloatArray
    step_s: float

    def begins_with(self, command: Twist2D) -> bool:
        """Whether a command is its first one: one that something else has changed leads elsewhere."""
        if len(self.twists) == 0:
            return False
        v, w = self.twists[0].tolist()
        return abs(v - command.v) <= _SAME and abs(w - command.w) <= _SAME

    def poses(self, times: FloatArray) -> FloatArray:
        """Poses (x, y, yaw) of base_link at these times [s], ascending, from (0, 0, 0) on; shape (K, 3)."""
        x = y = yaw = now = 0.0
        poses: list[tuple[float, float, float]] = []
        last = len(self.twists) - 1
        twists: list[list[float]] = self.twists.tolist()
        index = 0
        for time in times.tolist():
            while index < last and (index + 1) * self.step_s <= time:
                end = (index + 1) * self.step_s
                x, y, yaw = integrate_twist(x, y, yaw, twists[index][0], twists[index][1], end - now)
                now, index = end, index + 1
            x, y, yaw = integrate_twist(x, y, yaw, twists[index][0], twists[index][1], time - now)
            now = time
            poses.append((x, y, yaw))
        return np.array(poses).reshape(-1, 3)
