"""`UnseenSurfaces`: what a map draws and no lidar sees: a kerb below the lidars' plane, or something that is gone.

Beams go through it. From a pose that is right otherwise, again and again while the robot drives, this tells that the
surface is not expected in scans, and such beams no longer count against the pose. A robot that is lost sees beams go
through walls as well: nothing is learnt unless the beams have agreed with the map for long.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle._core import cast_grid_rays
from trundle.geometry import FloatArray, Pose2D
from trundle.localization.amcl.beams import Beams
from trundle.localization.amcl.map_field import MapField
from trundle.maps.cells import OCCUPIED_FROM

_PATCH_M = 0.1
_BEHIND_M = 0.25  # beams that end this far behind a surface went through it
_PASSES, _PER_STOP = 4, 4.0  # beams through a patch of the surface, and how many more than those that end on it
_MOST = 40.0
_STEP_M = 0.05  # the robot sees a surface from elsewhere by then
_SAME_SENSOR_M = 0.03
_FEWEST = 10  # beams


class UnseenSurfaces:
    """Patches of the map's surface that beams go through.

    Args:
        field: The map.

    Attributes:
        any: Whether there are such patches.
    """

    def __init__(self, field: MapField) -> None:
        self._resolution = field.resolution
        occupied = field.grid.data >= OCCUPIED_FROM
        self._occupied = occupied.view(np.uint8)
        self._per_patch = max(1, round(_PATCH_M / field.resolution))
        self._shape = tuple(-(-size // self._per_patch) for size in occupied.shape)
        self.clear()

    def clear(self) -> None:
        """Forget them."""
        self.any = False
        self._passes = np.zeros(self._shape, np.float32)
        self._stops = np.zeros(self._shape, np.float32)
        self._unseen = np.zeros(self._occupied.shape, np.uint8)
        self._travel = 0.0

    def judging(self, beams: Beams, pose: Pose2D) -> Beams:
        """Return the beams to judge a pose by: without those that go through what no lidar sees."""
        if not self.any:
            return beams
        first, length, _ = self._cast(self._unseen, beams, pose)
        seen = first >= length - _BEHIND_M
        return beams if seen.all() or seen.sum() < _FEWEST else beams.only(seen)

    def learn(self, beams: Beams, pose: Pose2D, travel: float) -> None:
        """Take which surfaces beams went through, from a pose known well that was followed for `travel` [m]."""
        if abs(travel - self._travel) < _STEP_M:
            return
        self._travel = travel
        first, length, ends = self._cast(self._occupied, beams, pose)
        step = self._per_patch
        cells = np.floor(ends / self._resolution).astype(np.intp)
        rows, cols = self._occupied.shape
        inside = (cells[:, 0] >= 0) & (cells[:, 0] < cols) & (cells[:, 1] >= 0) & (cells[:, 1] < rows)
        patches = (cells[:, 1] // step, cells[:, 0] // step)
        through = inside & (first < length - _BEHIND_M)
        stopped = inside & (np.abs(first - length) <= _BEHIND_M)
        for counts, chosen in ((self._passes, through), (self._stops, stopped)):
            at = patches[0][chosen], patches[1][chosen]
            counts[at] = np.minimum(counts[at] + 1.0, _MOST)
        touched = through | stopped
        row, col = patches[0][touched], patches[1][touched]
        passes = self._passes[row, col]
        unseen = (passes >= _PASSES) & (passes >= _PER_STOP * self._stops[row, col])
        for dy in range(step):
            for dx in range(step):
                y, x = np.minimum(row * step + dy, rows - 1), np.minimum(col * step + dx, cols - 1)
                self._unseen[y, x] = unseen & (self._occupied[y, x] != 0)
        self.any = self.any or bool(unseen.any())

    def _cast(
        self, cells: npt.NDArray[np.uint8], beams: Beams, pose: Pose2D
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """How far each beam is free of some cells [m], its length [m], and where it meets the first."""
        sensors, points = pose.transform_points(beams.sensors), pose.transform_points(beams.points)
        ways = points - sensors
        length = np.hypot(ways[:, 0], ways[:, 1])
        angles = np.arctan2(ways[:, 1], ways[:, 0])
        first = np.empty(len(points))
        left = np.ones(len(points), np.bool_)
        while left.any():
            at = sensors[int(left.argmax())]
            same = left & (np.abs(sensors - at).max(axis=1) <= _SAME_SENSOR_M)
            x, y = at / self._resolution
            most = float(length[same].max()) / self._resolution + 1.0
            first[same] = self._resolution * cast_grid_rays(cells, float(x), float(y), angles[same], most)
            left &= ~same
        first = np.minimum(first, length + 1.0)
        met = sensors + ways * ((first + 0.01) / np.maximum(length, 1e-9))[:, np.newaxis]
        return first, length, met
