"""`MapField`: a map as localisation needs it; `SeenSurfaces`: where lidars see its surfaces."""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
import numpy.typing as npt

from trundle._core import distance_field, expect_surfaces, learn_surfaces
from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D
from trundle.localization.amcl.amcl_settings import AmclSettings
from trundle.localization.amcl.beams import Beams
from trundle.maps import OccupancyGrid
from trundle.maps.cells import FREE_UP_TO, OCCUPIED_FROM, UNKNOWN

_LIMIT_M = 2.0  # farther from what is occupied a beam counts for nothing
_MOST_CELLS = 200
_SEARCH_CELL_M = 0.1  # scan matching refines what is found, and finer cells take four times as long
_SEARCH_WIDTH_M = 0.12  # about half of the search's step of yaw at 8 m


class MapField:
    """What localisation looks up in a map. Its poses and points are in the grid's frame: see `from_map` and `to_map`.

    Args:
        grid: The map.
        settings: Of the localizer.

    Attributes:
        grid: The map.
        is_free: Which cells are free, bool.
        values: Signed distance of each cell's centre from the nearest surface [m], negative inside.
        limit: The farthest distance that the field holds [m].

    Raises:
        InputError: If there is no map, or nothing on it that a scan could be compared with.
    """

    def __init__(self, grid: OccupancyGrid | None, settings: AmclSettings) -> None:
        if grid is None:
            raise InputError("the localizer amcl needs a map, and the robot has none; give one, or use odometry")
        occupied = grid.data >= OCCUPIED_FROM
        free = (grid.data >= 0) & (grid.data <= FREE_UP_TO)
        if not occupied.any():
            raise InputError("the localizer amcl needs a map with walls, and no cell of this one is occupied")
        if not free.any():
            raise InputError("the localizer amcl needs a map with free space, and no cell of this one is free")
        self.grid = grid
        self._settings = settings
        self.resolution = grid.resolution
        self.is_free = free
        self.limit = min(max(_LIMIT_M, 4.0 * grid.resolution), _MOST_CELLS * grid.resolution)
        # Halfway into the cells at the rim, where surfaces lie on average, or through the middle of a wall of one cell.
        shift = 0.0 if grid.surface == "border" else 0.5 * grid.resolution
        self.values = distance_field(occupied.view(np.uint8), grid.resolution, shift, self.limit)
        self._inverse = grid.origin.inverse()

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, cols)."""
        return self.grid.shape

    def from_map(self, pose: Pose2D) -> Pose2D:
        """Return a pose of the map frame in the grid's frame."""
        return self._inverse @ pose

    def to_map(self, pose: Pose2D) -> Pose2D:
        """Return a pose of the grid's frame in the map frame."""
        return self.grid.origin @ pose

    def covariance_to_map(self, covariance: FloatArray) -> FloatArray:
        """Turn a covariance (3, 3) from the grid's frame into the map frame."""
        return _turned(covariance, self.grid.origin.yaw)

    def covariance_from_map(self, covariance: FloatArray) -> FloatArray:
        """Turn a covariance (3, 3) from the map frame into the grid's frame."""
        return _turned(covariance, -self.grid.origin.yaw)

    def cell_value(self, pose: Pose2D) -> int | None:
        """Return the cell under a pose of the grid's frame, or None outside of the map."""
        col, row = math.floor(pose.x / self.resolution), math.floor(pose.y / self.resolution)
        rows, cols = self.grid.shape
        return int(self.grid.data[row, col]) if 0 <= row < rows and 0 <= col < cols else None

    @cached_property
    def log_weights(self) -> npt.NDArray[np.float32]:
        """Logarithm of how likely a beam ends in each cell; unknown cells away from walls are neutral."""
        settings = self._settings
        hit = np.exp(-0.5 * np.square(self.values / settings.sigma_hit))
        table = np.log(settings.z_hit * hit + settings.z_rand).astype(np.float32)
        unknown = (self.grid.data == UNKNOWN) & (hit < 0.1)
        table[unknown] = self.neutral_weight
        return table

    @property
    def neutral_weight(self) -> float:
        """Logarithm of a beam's weight where the map does not tell."""
        settings = self._settings
        return 0.5 * (math.log(settings.z_rand) + math.log(settings.z_hit + settings.z_rand))

    @cached_property
    def search_tables(self) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.uint8], float]:
        """How well a beam's end fits each cell, 0 to 255, where a robot may be, and the cells' edge [m]."""
        fit = np.rint(255.0 * np.exp(-0.5 * np.square(self.values / _SEARCH_WIDTH_M))).astype(np.uint8)
        stride = max(1, round(_SEARCH_CELL_M / self.resolution))
        if stride == 1:
            return fit, self.is_free.view(np.uint8), self.resolution
        rows, cols = (-(-size // stride) for size in fit.shape)
        padded = [
            np.pad(table, ((0, rows * stride - table.shape[0]), (0, cols * stride - table.shape[1])))
            for table in (fit, self.is_free.view(np.uint8))
        ]
        coarse, free = (
            np.ascontiguousarray(table.reshape(rows, stride, cols, stride).max(axis=(1, 3))) for table in padded
        )
        return coarse, free, self.resolution * stride


def _turned(covariance: FloatArray, yaw: float) -> FloatArray:
    if yaw == 0.0:
        return covariance
    cos, sin = math.cos(yaw), math.sin(yaw)
    turn = np.array(((cos, -sin, 0.0), (sin, cos, 0.0), (0.0, 0.0, 1.0)))
    return turn @ covariance @ turn.T


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

    A map draws what lies in a band of heights, in whole cells; a lidar sees one height. Walls are up to a cell off, and
    what is under a shelf a decimetre or more. Where a robot knows its place, each patch of the map's surface is given
    the mean distance at which beams ended from it; scan matching then expects them there. A part of the distance is
    never believed, so that the map keeps the estimate from drifting.

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
