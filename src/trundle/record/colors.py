"""The colours of pictures."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from trundle.costmap import INSCRIBED, LETHAL, NO_INFORMATION

Rgb: TypeAlias = tuple[int, int, int]

PAGE: Rgb = (255, 255, 255)
INK: Rgb = (31, 36, 48)
FAINT: Rgb = (107, 114, 128)
BESIDE: Rgb = (238, 240, 244)
HAIRLINE: Rgb = (214, 218, 226)
FREE: Rgb = (252, 252, 253)
OCCUPIED: Rgb = (45, 51, 64)
UNKNOWN: Rgb = (205, 210, 219)
INFLATED: Rgb = (247, 214, 188)
KEPT_OUT: Rgb = (226, 132, 132)
SLOW: Rgb = (94, 122, 214)
INSCRIBED_TINT: Rgb = (240, 186, 150)
PLANNED: Rgb = (140, 198, 242)
ROBOT: Rgb = (31, 36, 48)
START: Rgb = (15, 118, 110)
GOAL: Rgb = (190, 24, 93)
GOOD: Rgb = (21, 128, 61)
BAD: Rgb = (185, 28, 28)
WARNING: Rgb = (180, 83, 9)

# P. Tol's "bright" and "vibrant" schemes, which the colour-blind can tell apart, for things side by side.
SEVERAL: tuple[Rgb, ...] = (
    (187, 187, 187),
    (204, 187, 68),
    (102, 204, 238),
    (170, 51, 119),
    (34, 136, 51),
    (238, 119, 51),
    (68, 119, 170),
    (204, 51, 17),
)

# Anchors of matplotlib's "plasma" (S. van der Walt, N. Smith, 2015, CC0), which reads well in grey and for the
# colour-blind; cut before its yellow end, which would fade on a white map.
_SPEED_ANCHORS = ((13, 8, 135), (106, 0, 168), (177, 42, 144), (225, 100, 98), (252, 150, 55))


def map_palette() -> npt.NDArray[np.uint8]:
    """Colours of all costs, shape (256, 3)."""
    palette = np.empty((256, 3))
    share = (np.arange(INSCRIBED) / (INSCRIBED - 1.0))[:, None] ** 0.8
    palette[:INSCRIBED] = np.array(FREE) + share * (np.array(INFLATED, dtype=float) - np.array(FREE))
    palette[INSCRIBED] = INSCRIBED_TINT
    palette[LETHAL] = OCCUPIED
    palette[NO_INFORMATION] = UNKNOWN
    return palette.round().astype(np.uint8)


def speed_color(share: float) -> Rgb:
    """Colour of a speed that is `share` (0..1) of the largest."""
    place = min(1.0, max(0.0, share)) * (len(_SPEED_ANCHORS) - 1)
    low = min(int(place), len(_SPEED_ANCHORS) - 2)
    weight = place - low
    red, green, blue = (
        round(a + weight * (b - a)) for a, b in zip(_SPEED_ANCHORS[low], _SPEED_ANCHORS[low + 1], strict=True)
    )
    return red, green, blue
