"""Pixels to cells against a scalar model that was written on its own, after Nav2's map server."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest

from trundle.maps.images.pixels import Pixels, compute_greys
from trundle.maps.occupancy import PixelRule, compute_cells

MODES = ("trinary", "scale", "raw")
THRESHOLDS = [(0.65, 0.196), (0.65, 0.25), (0.5, 0.5), (1.0, 0.0), (0.2, 0.1), (0.9999, 0.6)]
f32 = np.float32


def grey8(*channels: int) -> int:
    """Grey of 16-bit channels."""
    if len(channels) == 1:
        return channels[0] // 257
    red, green, blue = channels
    return math.floor(math.floor(0.299 * red + 0.587 * green + 0.114 * blue + 0.5) / 257)


def current(grey: int, opaque: bool, mode: str, negate: bool, occupied: float, free: float) -> int:
    if mode == "raw":
        return grey if grey <= 100 else -1
    if not opaque:
        return -1
    n = f32(grey) / f32(255)
    if not negate:
        n = f32(1) - n
    if n <= f32(free):
        return 0
    if n >= f32(occupied):
        return 100
    if mode == "trinary":
        return -1
    scaled = (n - f32(free)) / (f32(occupied) - f32(free)) * f32(100)
    return math.floor(scaled + f32(0.5))


def humble(channels: list[int], alpha: int | None, mode: str, negate: bool, occupied: float, free: float) -> int:
    colour = channels * 3 if len(channels) == 1 else list(channels)
    if mode == "trinary" and alpha is not None:
        colour.append(alpha)
    shade = sum(colour) / len(colour) / 65535
    if mode == "raw":
        value = math.floor(shade * 255 + 0.5)
        return value if value <= 100 else -1
    if mode == "scale" and alpha is not None and alpha != 65535:
        return -1
    n = shade if negate else 1.0 - shade
    if occupied < n:
        return 100
    if n < free:
        return 0
    if mode == "trinary" or occupied == free:
        return -1
    return round((n - free) / (occupied - free) * 100)


def image(kind: str) -> Pixels:
    generator = np.random.default_rng(5)
    dtype, top = (np.uint16, 65536) if "16" in kind else (np.uint8, 256)
    if kind == "grey8":
        return Pixels(np.arange(256, dtype=np.uint8).reshape(8, 32))
    colour = generator.integers(0, top, (24, 21, 3) if "rgb" in kind else (24, 21)).astype(dtype)
    alpha = generator.choice([0, 1, top // 2, top - 2, top - 1], (24, 21)).astype(dtype) if "a" in kind[-2:] else None
    return Pixels(colour, alpha)


KINDS = ("grey8", "grey16", "grey8a", "grey16a", "rgb8", "rgb16", "rgb8a", "rgb16a")


@pytest.mark.parametrize("compat", [None, "humble"])
@pytest.mark.parametrize("kind", KINDS)
def test_cells_are_those_of_the_model(kind, compat):
    pixels = image(kind)
    wide = 1 if pixels.colour.dtype == np.uint16 else 257
    rows, cols = pixels.shape
    for mode, negate, (occupied, free) in itertools.product(MODES, (False, True), THRESHOLDS):
        expected = np.empty((rows, cols), dtype=int)
        for row, col in np.ndindex(rows, cols):
            channels = [int(value) * wide for value in np.atleast_1d(pixels.colour[row, col])]
            alpha = None if pixels.alpha is None else int(pixels.alpha[row, col]) * wide
            if compat == "humble":
                value = humble(channels, alpha, mode, negate, occupied, free)
            else:
                value = current(grey8(*channels), alpha in (None, 65535), mode, negate, occupied, free)
            expected[rows - 1 - row, col] = value
        cells = compute_cells(pixels, PixelRule(mode, negate, occupied, free), compat)
        assert np.array_equal(cells, expected), (mode, negate, occupied, free)
        assert cells.dtype == np.int8


def test_every_8_bit_grey_is_kept_in_colour():
    greys = np.arange(256, dtype=np.uint8)[None, :]
    assert np.array_equal(compute_greys(Pixels(np.repeat(greys[..., None], 3, axis=-1))), greys)
    assert np.array_equal(compute_greys(Pixels(greys.astype(np.uint16) * 257)), greys)


def test_known_cells():
    greys = Pixels(np.array([[0, 89, 90, 205, 206, 254, 255]], dtype=np.uint8))
    assert compute_cells(greys, PixelRule()).tolist() == [[100, 100, -1, -1, 0, 0, 0]]
    assert compute_cells(greys, PixelRule(free_thresh=0.25)).tolist() == [[100, 100, -1, 0, 0, 0, 0]]
    assert compute_cells(greys, PixelRule(negate=True)).tolist() == [[0, -1, -1, 100, 100, 100, 100]]
    assert compute_cells(greys, PixelRule("raw")).tolist() == [[0, 89, 90, -1, -1, -1, -1]]


def test_wide_images_are_worked_in_blocks():
    colour = np.random.default_rng(0).integers(0, 256, (3, 700_000, 3), dtype=np.uint8)
    pixels = Pixels(colour)
    assert len(list(pixels.row_blocks())) == 3
    rule = PixelRule()
    for compat in (None, "humble"):
        cells = compute_cells(pixels, rule, compat)
        assert np.array_equal(cells[2], compute_cells(Pixels(colour[:1]), rule, compat)[0])
