"""`SeenSurfaces`: where lidars see the surfaces of a map, which is rarely where the map draws them.

A map draws what lies in a band of heights, in whole cells; a lidar sees one height. Walls are up to a cell off, and
what is under a shelf a decimetre or more. Where a robot knows its place, each patch of the map's surface is given the
mean distance at which beams ended from it; scan matching then expects them there. A part of the distance is never
believed, so that the map keeps the estimate from drifting.
"""

from __future__ import annotations

import numpy as np

from trundle._core import expect_surfaces, learn_surfaces
from trundle.geometry import FloatArray, Pose2D
from trundle.localization.amcl.beams import Beams
from trundle.localization.amcl.map_field import MapField

_PATCH_M = 0.1
_DEEPEST_M = 0.35  # farther from the map's surface it is another thing that is seen
_BELIEVED = 0.9  # of the mean distance
_MAP_IS_RIGHT_M, _RISE_M = 0.04, 0.03  # up to this distance the map counts, from their sum on what was seen
_OFFSET_GAIN, _INDEPENDENT = 0.009, 0.6
_HALF_AFTER = 2.0  # scans
_MOST_SCANS = 20.0  # the mean is of about the last so many
_TRUST = np.array((_DEEPEST_M, _MAP_IS_RIGHT_M, _RISE_M, _BELIEVED, _HALF_AFTER))


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
        self._shape = tuple(int(size * field.resolution / _PATCH_M) + 2 for size in (rows, cols))
        self.clear()

    def clear(self) -> None:
        """Forget what was seen."""
        self.offset = 0.0
        self._counts = np.zeros(self._shape, np.float32)
        self._means = np.zeros(self._shape, np.float32)

    def targets(self, beams: Beams, pose: Pose2D) -> FloatArray:
        """Return the distance from the map's surface at which each beam is expected to end, shape (N,)."""
        field = self._field
        return expect_surfaces(
            *(field.values, field.resolution, field.limit, beams.points, np.array(pose.as_tuple())),
            *(self._counts, self._means, _PATCH_M, self.offset, _TRUST),
        )

    def learn(self, beams: Beams, pose: Pose2D, distance: float, independent: float) -> None:
        """Take where beams ended, from a pose that is known well."""
        field = self._field
        learn_surfaces(
            *(field.values, field.resolution, field.limit, beams.points, np.array(pose.as_tuple())),
            *(self._counts, self._means, _PATCH_M, _DEEPEST_M, _MOST_SCANS),
        )
        if independent > _INDEPENDENT:
            bound = 0.4 * field.resolution
            self.offset = min(bound, max(-bound, self.offset + _OFFSET_GAIN * distance))
