"""Pixels of a map image: 8 or 16-bit colour with or without alpha, and their greys."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray

SampleArray: TypeAlias = npt.NDArray[np.uint8 | np.uint16]

FULL_SCALE = 65535
"""A fully bright 16-bit sample. An 8-bit sample v is the 16-bit sample 257·v."""

_BLOCK_CELLS = 1 << 20  # pixels worked on at once, whose floats take 8 MB


@dataclass(frozen=True, slots=True)
class Pixels:
    """A decoded image, top row first.

    Attributes:
        colour: uint8 or uint16, shape (rows, cols) for greys or (rows, cols, 3) for red, green, blue.
        alpha: Opacity in the same type, shape (rows, cols), or None where the image has no alpha.
    """

    colour: SampleArray
    alpha: SampleArray | None = None

    @property
    def shape(self) -> tuple[int, int]:
        """(rows, cols)."""
        return self.colour.shape[0], self.colour.shape[1]

    def row_blocks(self) -> Iterator[slice]:
        """Return slices of rows of about a million pixels, so that wide intermediates stay small."""
        rows, cols = self.shape
        step = max(1, _BLOCK_CELLS // cols)
        for first in range(0, rows, step):
            yield slice(first, min(rows, first + step))


def compute_greys(pixels: Pixels) -> npt.NDArray[np.uint8]:
    """Return greys 0..255, shape (rows, cols), as Nav2's image library makes them.

    A grey is ⌊round(0.299 R + 0.587 G + 0.114 B at 16 bit) / 257⌋, the luma of ITU-R BT.601; a grey image keeps
    ⌊v / 257⌋.
    """
    if pixels.colour.ndim == 2:
        wide = pixels.colour.dtype != np.uint8
        return (pixels.colour // 257 if wide else pixels.colour).astype(np.uint8, copy=False)
    greys = np.empty(pixels.shape, dtype=np.uint8)
    weights = np.array([0.299, 0.587, 0.114]) * (257.0 if pixels.colour.dtype == np.uint8 else 1.0)
    for rows in pixels.row_blocks():
        red, green, blue = np.moveaxis(pixels.colour[rows], -1, 0)
        luma = weights[0] * red + weights[1] * green + weights[2] * blue
        greys[rows] = (luma + 0.5).astype(np.uint16) // 257
    return greys


def compute_transparent(pixels: Pixels) -> npt.NDArray[np.bool_] | None:
    """Return which pixels are not fully opaque, shape (rows, cols); None where all are."""
    if pixels.alpha is None:
        return None
    mask = pixels.alpha < np.iinfo(pixels.alpha.dtype).max
    return mask if mask.any() else None


def compute_channel_means(pixels: Pixels, rows: slice, *, with_alpha: bool) -> FloatArray:
    """Return the mean of red, green, blue (and alpha) of a slice of rows, 0..1: the shade that Nav2 Humble used."""
    colour = _at_16_bit(pixels.colour[rows])
    channels = 3
    total = colour.sum(axis=-1) if colour.ndim == 3 else colour * 3.0
    if with_alpha and pixels.alpha is not None:
        total = total + _at_16_bit(pixels.alpha[rows])
        channels = 4
    return total / channels / FULL_SCALE


def _at_16_bit(samples: SampleArray) -> FloatArray:
    return samples.astype(np.float64) * (257.0 if samples.dtype == np.uint8 else 1.0)
