"""Zones of masks in pictures: keep-out areas and speed limits."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from trundle.costmap import LETHAL, Costmap
from trundle.geometry import FloatArray
from trundle.maps.masks import SpeedMask
from trundle.pictures.colors import FREE, KEPT_OUT, SLOW, Rgb
from trundle.record.page import Mark
from trundle.robots import Robot

_MOST_MARKS = 2


class SpeedZones:
    """The limits of a speed mask as colours: stronger for lower limits.

    Args:
        mask: The mask.
        top_speed: Maximum speed of the robot [m/s].
    """

    def __init__(self, mask: SpeedMask, top_speed: float) -> None:
        self._mask = mask
        self._top_speed = top_speed

    def strength(self, x: npt.ArrayLike, y: npt.ArrayLike) -> FloatArray:
        """Strength of the colour at points [m], map frame: 0 without a limit, 0.25 to 0.7 with one."""
        return self._strength_of(self._mask.limit_at(x, y, self._top_speed))

    def marks(self) -> list[Mark]:
        """Entries of the legend: the limits if they are few, else their range."""
        values = np.flatnonzero(np.bincount(np.maximum(self._mask.grid.data, 0).ravel(), minlength=101))
        limits = np.unique(self._mask.limits(self._top_speed)[values[values > 0]])
        if len(limits) == 0:
            return []
        if len(limits) <= _MOST_MARKS:
            return [Mark("square", self._color_of(limit), f"up to {limit:.2g} m/s") for limit in limits.tolist()]
        low, high = float(limits[0]), float(limits[-1])
        return [Mark("square", self._color_of(low), f"up to {low:.2g} to {high:.2g} m/s")]

    def _strength_of(self, limits: FloatArray) -> FloatArray:
        share = np.clip(1.0 - limits / self._top_speed, 0.0, 1.0)
        return np.where(np.isfinite(limits), 0.25 + 0.45 * share, 0.0)

    def _color_of(self, limit: float) -> Rgb:
        strength = float(self._strength_of(np.array(limit)))
        red, green, blue = (round(free + strength * (slow - free)) for free, slow in zip(FREE, SLOW, strict=True))
        return red, green, blue


def speed_zones(mask: SpeedMask | None, robot: Robot) -> SpeedZones | None:
    """The zones of a mask for a robot, or None without a mask."""
    return None if mask is None else SpeedZones(mask, robot.limits.linear_speed)


def zone_marks(costmap: Costmap, zones: SpeedZones | None) -> list[Mark]:
    """Entries of the legend for the existing zones."""
    kept_out = costmap.keepout is not None and bool((costmap.keepout == LETHAL).any())
    marks = [Mark("square", KEPT_OUT, "kept out")] if kept_out else []
    return marks + ([] if zones is None else zones.marks())
