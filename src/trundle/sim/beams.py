"""Level lidar beams in a world."""

from __future__ import annotations

import math

import numpy as np

from trundle._core import cast_jumping_rays, cast_outline_rays
from trundle.geometry import FloatArray, Pose2D
from trundle.geometry.solids import Cylinder, OccupancyCells, Sphere
from trundle.sim.footprint import CellField
from trundle.sim.sections import Disc, outline_segments, slab_section
from trundle.worlds import World

_AROUND_M = 2.0
"""Segments beyond the reach of beams by more than this are left out until the robot has driven as far."""


class WorldOutline:
    """A world cut at one height: segments, circles and blocked cells.

    Args:
        world: The world to cut.
        height: Height of the cut above the floor [m].

    Attributes:
        fields: Blocked cells that the cut goes through.
    """

    def __init__(self, world: World, height: float) -> None:
        segments: list[FloatArray] = [np.empty((0, 4))]
        discs: list[tuple[float, float, float]] = []
        self.fields: list[CellField] = []
        for solid in world.solids:
            shape = solid.shape
            if isinstance(shape, OccupancyCells):
                base = solid.pose.position[2]
                if base <= height <= base + shape.height:
                    self.fields.append(CellField.of(solid, shape))
            elif isinstance(shape, Sphere) or (isinstance(shape, Cylinder) and solid.pose.is_upright()):
                section = slab_section(solid, height, height)
                if isinstance(section, Disc):
                    discs.append((section.x, section.y, section.radius))
            else:
                segments.append(outline_segments(solid, height))
        self._segments = np.vstack(segments)
        self._discs = np.array(discs).reshape(-1, 3)
        self._around: tuple[float, float, float, FloatArray] | None = None

    @property
    def segments(self) -> FloatArray:
        """Straight edges (x0, y0, x1, y1) [m], shape (S, 4)."""
        return self._segments

    @property
    def discs(self) -> FloatArray:
        """Circles (x, y, radius) [m], shape (D, 3)."""
        return self._discs

    def cast(self, x: float, y: float, angles: FloatArray, reach: float) -> FloatArray:
        """Return distances [m] from (x, y) along `angles` [rad] to the nearest outline, infinity beyond `reach` [m].

        A beam that starts inside a solid meets its outline from within; one that starts in a blocked cell reads 0.
        The angles are evenly spaced and ascending.
        """
        count = len(angles)
        step = float(angles[-1] - angles[0]) / (count - 1) if count > 1 else 1.0
        distances = cast_outline_rays(
            self._segments_around(x, y, reach), self._discs, x, y, float(angles[0]), step, count, reach
        )
        for field in self.fields:
            inverse, scale = field.inverse, field.resolution
            local = inverse @ Pose2D(x, y)
            hits = cast_jumping_rays(field.free, local.x / scale, local.y / scale, angles + inverse.yaw, reach / scale)
            np.minimum(distances, hits * scale, out=distances)
        return distances

    def _segments_around(self, x: float, y: float, reach: float) -> FloatArray:
        """Return segments that may be within reach [m] of (x, y), and some more."""
        if self._around is not None:
            at_x, at_y, of, segments = self._around
            if of == reach and math.hypot(x - at_x, y - at_y) < _AROUND_M:
                return segments
        start, end = self._segments[:, :2] - (x, y), self._segments[:, 2:] - (x, y)
        middle, half = 0.5 * (start + end), 0.5 * (end - start)
        nearest = np.hypot(middle[:, 0], middle[:, 1]) - np.hypot(half[:, 0], half[:, 1])
        # A millimetre for rounding, where worlds are kilometres wide.
        segments = self._segments[nearest <= reach + _AROUND_M + 1e-3]
        self._around = x, y, reach, segments
        return segments
