"""`HeightField`: the height of the floor, for maps of places with ramps and several levels."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from trundle.errors import MapError
from trundle.files.npz import read_arrays
from trundle.files.writing import atomic_path, output_path
from trundle.geometry import FloatArray
from trundle.values import as_path

_KEYS = ("heights", "resolution", "origin")
_MOST_SAMPLES = 100_000_000  # which take 800 MB
_FARTHEST = 1e9  # [m]: as far as a map's origin may be


@dataclass(frozen=True, slots=True)
class HeightField:
    """Heights of a floor, sampled on a grid along x and y, with bilinear interpolation.

    Attributes:
        heights: Heights [m], shape (rows, cols), at least 2 x 2, read-only; `heights[row, col]` is the floor at
            `origin + (col, row) * resolution`, row 0 at the lowest y. NaN where the floor is unknown: the four
            patches around that sample are then unknown.
        resolution: Distance between two samples [m].
        origin: Position (x, y) [m] of sample (0, 0), map frame.

    Raises:
        MapError: If the heights have another shape or are infinite, or another number is invalid.
    """

    heights: FloatArray
    resolution: float
    origin: tuple[float, float] = (0.0, 0.0)

    def __post_init__(self) -> None:
        try:
            heights = np.array(self.heights, dtype=np.float64, order="C", copy=True)
            resolution = float(self.resolution)
            x, y = (float(number) for number in self.origin)
        except (TypeError, ValueError) as error:
            raise MapError(f"a height field needs heights, a resolution and an origin (x, y): {error}") from error
        if heights.ndim != 2 or min(heights.shape) < 2:
            raise MapError(f"a height field needs heights of shape (rows, cols), at least 2 x 2, got {heights.shape}")
        if (np.abs(heights) > _FARTHEST).any():
            raise MapError(f"a height field's heights must be at most {_FARTHEST:g} m, or NaN where unknown")
        if not (math.isfinite(resolution) and resolution > 0.0):
            raise MapError(f"a height field's resolution must be a positive number of metres, got {self.resolution}")
        if not all(abs(number) <= _FARTHEST for number in (x, y, max(heights.shape) * resolution)):
            raise MapError(
                f"a height field's origin must be two numbers of metres (x, y), got {self.origin}; neither it nor the "
                f"field's width may be more than {_FARTHEST:g} m"
            )
        heights.flags.writeable = False
        object.__setattr__(self, "heights", heights)
        object.__setattr__(self, "resolution", resolution)
        object.__setattr__(self, "origin", (x, y))

    def __repr__(self) -> str:
        rows, cols = self.heights.shape
        return f"HeightField({cols} x {rows} samples {self.resolution:g} m apart, origin {self.origin})"

    @classmethod
    def from_function(
        cls,
        height: Callable[[FloatArray, FloatArray], FloatArray | float],
        bounds: tuple[tuple[float, float], tuple[float, float]],
        *,
        resolution: float = 0.05,
    ) -> HeightField:
        """Sample a function.

        Args:
            height: The floor's height [m] at arrays x and y [m] of one shape; NaN where it is unknown.
            bounds: ((x_min, y_min), (x_max, y_max)) [m]; the upper corner is moved out to whole samples.
            resolution: Distance between two samples [m].

        Raises:
            MapError: If the bounds or the resolution are invalid, or there would be more than 100 million samples.
        """
        corners = np.asarray(bounds, dtype=np.float64)
        if corners.shape != (2, 2) or not np.isfinite(corners).all() or (corners[1] <= corners[0]).any():
            raise MapError(f"bounds must be ((x_min, y_min), (x_max, y_max)) in metres, smaller first, got {bounds}")
        if not (math.isfinite(resolution) and resolution > 0.0):
            raise MapError(f"a height field's resolution must be a positive number of metres, got {resolution}")
        cols, rows = np.ceil((corners[1] - corners[0]) / resolution - 1e-9) + 1
        if rows * cols > _MOST_SAMPLES:
            raise MapError(
                f"a height field of {cols:.0f} x {rows:.0f} samples {resolution} m apart is more than "
                f"{_MOST_SAMPLES} samples: use a larger resolution or smaller bounds"
            )
        x, y = np.meshgrid(
            corners[0, 0] + np.arange(int(cols)) * resolution, corners[0, 1] + np.arange(int(rows)) * resolution
        )
        heights = np.broadcast_to(np.asarray(height(x, y), dtype=np.float64), x.shape)
        return cls(heights, resolution, (float(corners[0, 0]), float(corners[0, 1])))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> HeightField:
        """Read a .npz file with the arrays `heights`, `resolution` and, unless it is (0, 0), `origin`.

        Raises:
            MapError: If it cannot be read, or an array is missing; the message names it.
        """
        file = Path(as_path(path, "a height field's file", MapError))
        found, names = read_arrays(file, _KEYS, error=MapError)
        missing = [key for key in _KEYS[:2] if key not in found]
        if missing:
            there = ", ".join(names) or "none"
            raise MapError(f"{file}: no array named {' or '.join(map(repr, missing))} in it; there are: {there}")
        try:
            origin = tuple(np.asarray(found.get("origin", (0.0, 0.0)), dtype=np.float64).ravel().tolist())
            return cls(found["heights"], found["resolution"].item(), origin)  # pyright: ignore[reportArgumentType]
        except (MapError, TypeError, ValueError, OverflowError) as error:
            raise MapError(f"{file}: {error}") from error

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write a .npz file that `load` reads.

        Raises:
            MapError: If the file's name does not end in .npz.
            OutputError: If the folder cannot be written to. No partial file is left.
        """
        file = output_path(path)
        if file.suffix != ".npz":
            raise MapError(f"{file}: the name of a height field's file must end in .npz")
        with atomic_path(file) as temporary, temporary.open("wb") as stream:
            np.savez_compressed(stream, heights=self.heights, resolution=self.resolution, origin=self.origin)

    @property
    def bounds(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Extent of the samples: ((x_min, y_min), (x_max, y_max)) [m]."""
        rows, cols = self.heights.shape
        (x, y), step = self.origin, self.resolution
        return (x, y), (x + (cols - 1) * step, y + (rows - 1) * step)

    def height_at(self, x: FloatArray | float, y: FloatArray | float) -> FloatArray:
        """Return the floor's height [m] at points (x, y) [m]; NaN outside, and where it is unknown."""
        rows, cols = self.heights.shape
        u = (np.asarray(x, dtype=np.float64) - self.origin[0]) / self.resolution
        v = (np.asarray(y, dtype=np.float64) - self.origin[1]) / self.resolution
        inside = (u >= 0.0) & (u <= cols - 1) & (v >= 0.0) & (v <= rows - 1)
        col = np.clip(np.nan_to_num(np.floor(u)), 0, cols - 2).astype(np.int64)
        row = np.clip(np.nan_to_num(np.floor(v)), 0, rows - 2).astype(np.int64)
        s, t = u - col, v - row
        low = (1.0 - s) * self.heights[row, col] + s * self.heights[row, col + 1]
        high = (1.0 - s) * self.heights[row + 1, col] + s * self.heights[row + 1, col + 1]
        return np.where(inside, (1.0 - t) * low + t * high, np.nan)
