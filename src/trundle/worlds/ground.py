"""Level planes that face up in a world's file: choosing the ground, and making rectangles of the others."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from trundle.geometry import Pose3D
from trundle.geometry.solids import Color, Solid, solids_bounds
from trundle.worlds.shapes import Names, Part, make_solids

LARGE = 10.0
"""Minimum area [m²] of a floor: a smaller level surface may be a table top, a pallet or a landing."""

NEAR_ZERO = 0.01
"""A plane this near to z = 0 [m] is the ground whatever its size; surfaces this little above it belong to it."""

ENDLESS = math.inf
"""Area of a plane that collides: in physics it is infinite, whatever size it is drawn with."""


class LevelPlane(NamedTuple):
    """A level plane that faces up.

    Attributes:
        height: Height of the plane [m].
        area: Area of the plane [m²]; `ENDLESS` for one that collides.
    """

    height: float
    area: float


def is_level(normal_z: float) -> bool:
    """Return whether a plane whose unit normal has this third component is level and faces up."""
    return normal_z > 1.0 - 1e-9


def find_ground(planes: Iterable[LevelPlane], solids: Sequence[Solid]) -> float | None:
    """Return the height [m] of the ground that a file declares, or None.

    It is the highest plane at or below z = 0, which hides the others. Without one it is the lowest large plane above
    z = 0, unless a solid ends below that: then the plane is a deck or a roof.
    """
    wide = sorted(plane.height for plane in planes if plane.area >= LARGE or abs(plane.height) <= NEAR_ZERO)
    low = [height for height in wide if height <= NEAR_ZERO]
    if low:
        return low[-1]
    if not wide:
        return None
    ends_below = len(solids) > 0 and bool((solids_bounds(solids)[1][:, 2] <= wide[0] + NEAR_ZERO).any())
    return None if ends_below else wide[0]


def is_ground(plane: LevelPlane, ground: float | None) -> bool:
    """Return whether a plane is the ground or hidden by it, and so makes no rectangle."""
    return ground is not None and plane.height <= ground + NEAR_ZERO


@dataclass(slots=True)
class LevelPlanes:
    """Level planes of a file, kept until all solids are known, which determine the ground."""

    _put_aside: list[tuple[LevelPlane, str, Sequence[Part], Pose3D, Color | None]] = field(
        default_factory=list[tuple[LevelPlane, str, Sequence[Part], Pose3D, Color | None]]
    )

    def take(self, name: str, parts: Sequence[Part], pose: Pose3D, area: float, color: Color | None) -> bool:
        """Keep a plane for later if it is level and faces up; return whether it was kept.

        Args:
            name: Name of its solid, if it is not the ground.
            parts: Its rectangle; empty for a plane without a size.
            pose: Pose of its parts' frame, whose z is the normal.
            area: Area of the plane [m²].
            color: Colour of the solid.
        """
        if not is_level(float(pose.rotation()[2, 2])):
            return False
        self._put_aside.append((LevelPlane(pose.position[2], area), name, parts, pose, color))
        return True

    def settle(self, solids: Sequence[Solid], names: Names) -> tuple[float | None, list[Solid], list[str]]:
        """Return the ground's height [m] or None, rectangles of the other planes, and names of those without a size."""
        ground = find_ground((plane for plane, *_ in self._put_aside), solids)
        rectangles: list[Solid] = []
        endless: list[str] = []
        for plane, name, parts, pose, color in self._put_aside:
            if is_ground(plane, ground):
                continue
            endless += [] if parts else [name]
            rectangles += make_solids(names, name, parts, pose, color=color, kind="model")
        return ground, rectangles, endless
