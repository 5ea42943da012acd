"""From pixels to cells: the rules of Nav2's map server, current and Humble."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import numpy.typing as npt

from trundle.geometry import FloatArray
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN
from trundle.maps.images.pixels import Pixels, compute_channel_means, compute_greys, compute_transparent

Mode: TypeAlias = Literal["trinary", "scale", "raw"]
Compat: TypeAlias = Literal["humble"]
CellData: TypeAlias = npt.NDArray[np.int8]

MODES: tuple[Mode, ...] = ("trinary", "scale", "raw")
UNKNOWN_GREY = 205
"""The grey that map savers write for unknown cells."""


@dataclass(frozen=True, slots=True)
class PixelRule:
    """The rules by which a map's pixels are read.

    Attributes:
        mode: trinary (occupied, free, unknown), scale (0..100 between the thresholds) or raw (the grey is the value).
        negate: Whether bright means occupied.
        occupied_thresh: A cell of at least this darkness, 0..1, is occupied.
        free_thresh: A cell of at most this darkness is free.
    """

    mode: Mode = "trinary"
    negate: bool = False
    occupied_thresh: float = 0.65
    free_thresh: float = 0.196


def compute_cells(pixels: Pixels, rule: PixelRule, compat: Compat | None = None) -> CellData:
    """Return cells −1, 0..100 of an image, shape (rows, cols), row 0 at the bottom.

    Args:
        pixels: The image, top row first.
        rule: How to read it.
        compat: "humble" for the rules of Nav2 Humble; None for those of current Nav2.
    """
    cells = _compute_humble(pixels, rule) if compat == "humble" else _compute_current(pixels, rule)
    return np.ascontiguousarray(cells[::-1])


def compute_table(rule: PixelRule) -> CellData:
    """Return the cell value of each grey 0..255 in current Nav2, shape (256,)."""
    greys = np.arange(256)
    if rule.mode == "raw":
        return np.where(greys <= OCCUPIED, greys, UNKNOWN).astype(np.int8)
    # Nav2 computes and compares in single precision: the result for a grey at a threshold depends on it.
    darkness = greys.astype(np.float32) / np.float32(255.0)
    if not rule.negate:
        darkness = np.float32(1.0) - darkness
    occupied, free = np.float32(rule.occupied_thresh), np.float32(rule.free_thresh)
    table = np.full(256, UNKNOWN, dtype=np.int8)
    table[darkness >= occupied] = OCCUPIED
    table[darkness <= free] = FREE
    if rule.mode == "scale":
        between = (darkness > free) & (darkness < occupied)
        share = (darkness[between] - free) / (occupied - free) * np.float32(100.0)
        table[between] = np.trunc(share + np.copysign(np.float32(0.5), share)).astype(np.int8)
    return table


def _compute_current(pixels: Pixels, rule: PixelRule) -> CellData:
    cells = compute_table(rule)[compute_greys(pixels)]
    transparent = None if rule.mode == "raw" else compute_transparent(pixels)
    if transparent is not None:
        cells[transparent] = UNKNOWN
    return cells


def _compute_humble(pixels: Pixels, rule: PixelRule) -> CellData:
    cells = np.empty(pixels.shape, dtype=np.int8)
    for rows in pixels.row_blocks():
        shade = compute_channel_means(pixels, rows, with_alpha=rule.mode == "trinary")
        cells[rows] = _humble_cells(shade, rule)
    transparent = compute_transparent(pixels) if rule.mode == "scale" else None
    if transparent is not None:
        cells[transparent] = UNKNOWN
    return cells


def _humble_cells(shade: FloatArray, rule: PixelRule) -> CellData:
    if rule.mode == "raw":
        greys = np.trunc(shade * 255.0 + 0.5)
        return np.where(greys <= OCCUPIED, greys, UNKNOWN).astype(np.int8)
    darkness = shade if rule.negate else 1.0 - shade
    cells = np.full(shade.shape, UNKNOWN, dtype=np.int8)
    occupied, free = darkness > rule.occupied_thresh, darkness < rule.free_thresh
    span = rule.occupied_thresh - rule.free_thresh
    if rule.mode == "scale" and span > 0.0:
        between = ~(occupied | free)
        cells[between] = np.rint((darkness[between] - rule.free_thresh) / span * 100.0).astype(np.int8)
    cells[free] = FREE
    cells[occupied] = OCCUPIED
    return cells
