"""`FieldOfView`: where the newest scan of a lidar looked."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray
from trundle.observation import Scan


@dataclass(frozen=True, slots=True)
class FieldOfView:
    """The sector that a scan looked at, in the map frame.

    Attributes:
        time: Of the scan [s].
        x, y: The sensor [m].
        middle: Direction of the sector's middle [rad].
        half: Half of its angle [rad]; π or more for a full turn.
        reach: From which range to which it counts [m].
    """

    time: float
    x: float
    y: float
    middle: float
    half: float
    reach: tuple[float, float]

    @classmethod
    def of_scan(cls, scan: Scan, poses: FloatArray, reach: tuple[float, float]) -> FieldOfView | None:
        """Return where a scan looked; None if it has no beam.

        Args:
            scan: The scan, with its beams in either order.
            poses: Of its sensor, map frame, shape (1, 3) or (beams, 3).
            reach: From which range to which it marks [m].
        """
        count = len(scan.angles)
        if count == 0:
            return None
        x, y, yaw = poses[len(poses) // 2].tolist()
        first, last = float(scan.angles.min()), float(scan.angles.max())
        half = 0.5 * (last - first) * count / max(1, count - 1)  # each beam stands for as much as lies between two
        low, high = max(scan.range_min, reach[0]), min(scan.range_max, reach[1])
        return cls(scan.time, x, y, yaw + 0.5 * (first + last), half, (low, high))

    def contains(self, x: FloatArray, y: FloatArray) -> npt.NDArray[np.bool_]:
        """Whether it looked towards points [m], map frame; what hides them makes no difference."""
        off = np.arctan2(y - self.y, x - self.x) - self.middle
        distance = np.hypot(x - self.x, y - self.y)
        inside = np.abs((off + math.pi) % (2.0 * math.pi) - math.pi) <= self.half
        return inside & (distance >= self.reach[0]) & (distance <= self.reach[1])
