"""Several lines on one map, striped in the colours of all where they overlap."""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from trundle.geometry import FloatArray, arc_lengths
from trundle.pictures.colors import Rgb
from trundle.record.map_view import MapView

_DASH = 18.0
"""Length of a stripe [px]."""


def draw_striped(view: MapView, lines: Sequence[tuple[FloatArray, Rgb]], *, width: float = 5.0) -> None:
    """Draw lines so that each stays visible along its whole length.

    Overlapping lines alternate in stripes of their colours; the stripes follow the first of them.

    Args:
        view: The map to draw on.
        lines: Points [m] in the map frame, shape (N, 2), and a colour, for each line.
        width: Width of the lines [px].
    """
    sampled = [_resample(view.to_pixels(points)) for points, _ in lines]
    stripes = np.stack([_stripe_numbers(samples, view.size, width) for samples in sampled])
    colors = [color for _, color in lines]
    for index, samples in enumerate(sampled):
        cols, rows = np.floor(samples).astype(int).T
        inside = (cols >= 0) & (cols < view.size[0]) & (rows >= 0) & (rows < view.size[1])
        here = np.where(inside, stripes[:, rows.clip(0, view.size[1] - 1), cols.clip(0, view.size[0] - 1)], 0)
        here[index] = np.maximum(here[index], 1)  # a line covers its own ends, too
        shown = _choose(here)
        changes = np.flatnonzero(np.diff(shown)) + 1
        for first, last in itertools.pairwise([0, *changes.tolist(), len(samples) - 1]):
            view.line_pixels(samples[first : last + 1], colors[shown[first]], width)


def _choose(here: npt.NDArray[np.int32]) -> npt.NDArray[np.int64]:
    """The line visible at each sample of one, from the stripe numbers of all lines there, shape (lines, samples)."""
    on = here > 0
    first = on.argmax(axis=0)
    turn = here[first, np.arange(here.shape[1])] % on.sum(axis=0)
    return (np.cumsum(on, axis=0) > turn).argmax(axis=0)


def _resample(pixels: FloatArray) -> FloatArray:
    """Points about a pixel apart along a line, shape (N, 2) with N ≥ 2."""
    along = arc_lengths(pixels)
    marks = np.linspace(0.0, along[-1], max(2, int(along[-1]) + 1))
    return np.column_stack([np.interp(marks, along, pixels[:, axis]) for axis in (0, 1)])


def _stripe_numbers(samples: FloatArray, size: tuple[int, int], width: float) -> npt.NDArray[np.int32]:
    """The number of the stripe, from 1, at every pixel that a line of this width covers, else 0; (height, width)."""
    image = Image.new("I", size, 0)
    draw = ImageDraw.Draw(image)
    along = arc_lengths(samples)
    numbers = (along / _DASH).astype(int) + 1
    changes = np.flatnonzero(np.diff(numbers)) + 1
    for first, last in itertools.pairwise([0, *changes.tolist(), len(samples) - 1]):
        part = [(float(x), float(y)) for x, y in samples[first : last + 1]]
        if len(part) > 1:
            draw.line(part, fill=int(numbers[first]), width=max(1, round(width)), joint="curve")
    return np.asarray(image, dtype=np.int32)
