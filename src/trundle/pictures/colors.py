"""The colours of pictures."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import numpy.typing as npt

Rgb: TypeAlias = tuple[int, int, int]

PAGE: Rgb = (255, 255, 255)
INK: Rgb = (31, 36, 48)
FAINT: Rgb = (107, 114, 128)
BESIDE: Rgb = (238, 240, 244)
HAIRLINE: Rgb = (214, 218, 226)
PAPER_LINE: Rgb = (228, 232, 238)
FREE: Rgb = (252, 252, 253)
OCCUPIED: Rgb = (45, 51, 64)
UNKNOWN: Rgb = (205, 210, 219)
INFLATED: Rgb = (247, 214, 188)
KEPT_OUT: Rgb = (226, 132, 132)
SLOW: Rgb = (94, 122, 214)
INSCRIBED_TINT: Rgb = (240, 186, 150)
LINE: Rgb = (37, 99, 205)
BACKED: Rgb = (217, 119, 6)
PLANNED: Rgb = (140, 198, 242)
ROBOT: Rgb = (31, 36, 48)
START: Rgb = (15, 118, 110)
GOAL: Rgb = (190, 24, 93)
GOOD: Rgb = (21, 128, 61)
BAD: Rgb = (185, 28, 28)
WARNING: Rgb = (180, 83, 9)
SAMPLED: Rgb = (139, 92, 246)
ESTIMATED: Rgb = (0, 135, 155)

# P. Tol's "bright" and "vibrant" schemes, which the colour-blind can tell apart, for things side by side.
SEVERAL: tuple[Rgb, ...] = (
    (68, 119, 170),
    (238, 119, 51),
    (34, 136, 51),
    (170, 51, 119),
    (102, 204, 238),
    (204, 51, 17),
    (204, 187, 68),
    (187, 187, 187),
)

# Anchors of matplotlib's "plasma" (S. van der Walt, N. Smith, 2015, CC0), which reads well in grey and for the
# colour-blind; cut before its yellow end, which would fade on a white map.
_SPEED_ANCHORS = ((13, 8, 135), (106, 0, 168), (177, 42, 144), (225, 100, 98), (252, 150, 55))


COST_ORDER = (*range(254), 255, 254)
"""Nav2's costs, those that may be hidden first: where several cells share a pixel, an obstacle shows."""


def cost_palette() -> npt.NDArray[np.uint8]:
    """Return colours of Nav2's costs, shape (256, 3): 0..252, 253 inscribed, 254 lethal, 255 unknown."""
    palette = np.empty((256, 3))
    share = (np.arange(253) / 252.0)[:, None] ** 0.8
    palette[:253] = np.array(FREE) + share * (np.array(INFLATED, dtype=float) - np.array(FREE))
    palette[253] = INSCRIBED_TINT
    palette[254] = OCCUPIED
    palette[255] = UNKNOWN
    return palette.round().astype(np.uint8)


def occupancy_palette() -> npt.NDArray[np.uint8]:
    """Return colours of occupancies as bytes, shape (256, 3): 0 free to 100 occupied, 255 (−1) unknown."""
    palette = np.empty((256, 3))
    share = np.minimum(np.arange(256) / 100.0, 1.0)[:, None]
    palette[:] = np.array(FREE) + share * (np.array(OCCUPIED, dtype=float) - np.array(FREE))
    palette[255] = UNKNOWN
    return palette.round().astype(np.uint8)


def speed_color(share: float) -> Rgb:
    """Return the colour of a speed that is `share` (0..1) of the largest."""
    place = min(1.0, max(0.0, share)) * (len(_SPEED_ANCHORS) - 1)
    low = min(int(place), len(_SPEED_ANCHORS) - 2)
    weight = place - low
    red, green, blue = (
        round(a + weight * (b - a)) for a, b in zip(_SPEED_ANCHORS[low], _SPEED_ANCHORS[low + 1], strict=True)
    )
    return red, green, blue
