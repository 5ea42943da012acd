"""`SeenSurfaces`: where lidars see the surfaces of a map, which is rarely where the map draws them.

A map draws what lies in a band of heights, in whole cells; a lidar sees one height. Walls are up to a cell off, and
what is under a shelf a decimetre or more. Where a robot knows its place, each patch of the map's surface is given the
mean distance at which beams ended from it; scan matching then expects them there. A part of the distance is never
believed, so that the map keeps the estimate from drifting.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle._core import field_at
from trundle.geometry import FloatArray, Pose2D
from trundle.localization.amcl.beams import Beams
from trundle.localization.amcl.map_field import MapField

_PATCH_M = 0.1
_DEEPEST_M = 0.35  # farther from the map's surface it is another thing that is seen
_BELIEVED = 0.9  # of the mean distance
_MAP_IS_RIGHT_M, _RISE_M = 0.04, 0.03  # up to this distance the map counts, from their sum on what was seen
_OFFSET_GAIN, _INDEPENDENT = 0.009, 0.6
_HALF_AFTER = 2.0  # beams
_MOST_BEAMS = 20.0  # the mean is of about the last so many


class SeenSurfaces:
    """Mean distances of what is seen from what the map draws, by patches of its surface.

    Args:
        field: The map.

    Attributes:
        offset: The mean distance of what is seen from walls that are where the map draws them [m], within a cell.
    """

    def __init__(self, field: MapField) -> None:
        self._field = field
        rows, cols = field.shape
        self._rows, self._cols = (int(size * field.resolution / _PATCH_M) + 2 for size in (rows, cols))
        self.clear()

    def clear(self) -> None:
        """Forget what was seen."""
        self.offset = 0.0
        self._counts = np.zeros(self._rows * self._cols, np.float32)
        self._means = np.zeros(self._rows * self._cols, np.float32)

    def targets(self, beams: Beams, pose: Pose2D) -> FloatArray:
        """Return the distance from the map's surface at which each beam is expected to end, shape (N,)."""
        patches, near, _ = self._patches(beams, pose)
        counts = self._counts[patches]
        means = self._means[patches]
        offset = self.offset
        apart = means - offset
        share = np.clip((np.abs(apart) - _MAP_IS_RIGHT_M) * (1.0 / _RISE_M), 0.0, 1.0)
        expected = offset + _BELIEVED * counts / (counts + _HALF_AFTER) * share * apart
        return np.where(near, expected, offset).astype(np.float64)

    def learn(self, beams: Beams, pose: Pose2D, distance: float, independent: float) -> None:
        """Take where beams ended, from a pose that is known well."""
        patches, near, distances = self._patches(beams, pose)
        patches, distances = patches[near], distances[near]
        self._counts[patches] = np.minimum(self._counts[patches] + 1.0, _MOST_BEAMS)
        self._means[patches] += (distances - self._means[patches]) / self._counts[patches]
        if independent > _INDEPENDENT:
            bound = 0.4 * self._field.resolution
            self.offset = min(bound, max(-bound, self.offset + _OFFSET_GAIN * distance))

    def _patches(self, beams: Beams, pose: Pose2D) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.bool_], FloatArray]:
        """The patch of surface nearest to each beam's end, whether it is near enough, and how far."""
        field = self._field
        points = pose.transform_points(beams.points)
        slopes = field_at(field.values, field.resolution, field.limit, points)
        distances = slopes[:, 0]
        near = np.abs(distances) < _DEEPEST_M
        feet = (points - distances[:, np.newaxis] * slopes[:, 1:]) * (1.0 / _PATCH_M)
        cells = feet.astype(np.intp)
        cols = np.clip(cells[:, 0], 0, self._cols - 1)
        rows = np.clip(cells[:, 1], 0, self._rows - 1)
        return rows * self._cols + cols, near, distances
