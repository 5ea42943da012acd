"""`Canvas`: a picture on which lines and shapes with smooth edges are drawn, at places in metres."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from trundle.geometry import FloatArray, Pose2D
from trundle.pictures.colors import Rgb

SMOOTH = 2
"""Everything is drawn at this multiple of the resolution and averaged in the end (anti-aliasing)."""

Points = list[tuple[float, float]]

_ARROWHEAD = np.array([[0.62, 0.0], [-0.38, 0.38], [-0.18, 0.0], [-0.38, -0.38]])
"""Corners of an arrowhead of length 1 along the x axis, with its middle at the origin."""


class Canvas(ABC):
    """A picture to draw on; widths and radii are in pixels of the finished picture, places in metres.

    Args:
        image: What is drawn on, `SMOOTH` times as large as the finished picture.
        pixels_per_metre: Scale of the finished picture.

    Attributes:
        size: Width and height of the finished picture [px].
        pixels_per_metre: Scale of the finished picture.
    """

    def __init__(self, image: Image.Image, pixels_per_metre: float) -> None:
        self._image = image
        self._draw = ImageDraw.Draw(image, "RGBA")
        self.size = (image.width // SMOOTH, image.height // SMOOTH)
        self.pixels_per_metre = pixels_per_metre

    @abstractmethod
    def to_pixels(self, points: npt.ArrayLike) -> FloatArray:
        """Return where points [m], shape (N, 2), map frame, are in the finished picture [px]; y goes down."""

    def finish(self) -> Image.Image:
        """Return the finished picture; the canvas can still be drawn on."""
        return self._image.reduce(SMOOTH)

    def line(self, points: npt.ArrayLike, color: Rgb, width: float) -> None:
        """Draw a polyline through points [m], shape (N, 2), with round ends."""
        self.line_pixels(self.to_pixels(points), color, width)

    def line_pixels(self, pixels: FloatArray, color: Rgb, width: float) -> None:
        """Draw a polyline through pixels of the finished picture, shape (N, 2), with round ends."""
        large = as_points(pixels * SMOOTH)
        thick = max(1, round(width * SMOOTH))
        if len(large) > 1:
            self._draw.line(large, fill=color, width=thick, joint="curve")
        for x, y in (large[0], large[-1]):
            self._draw.ellipse((x - thick / 2, y - thick / 2, x + thick / 2, y + thick / 2), fill=color)

    def disc(self, point: Sequence[float], radius: float, color: Rgb) -> None:
        """Draw a filled circle about a point [m]."""
        x, y = self._large([point])[0]
        reach = radius * SMOOTH
        self._draw.ellipse((x - reach, y - reach, x + reach, y + reach), fill=color)

    def arrow(self, pose: Pose2D, length: float, color: Rgb) -> None:
        """Draw an arrowhead of `length` [px] that points along a pose's x axis, with its middle on the pose."""
        shape = _ARROWHEAD * (length / self.pixels_per_metre)
        self._draw.polygon(self._large(pose.transform_points(shape)), fill=color)

    def _large(self, points: npt.ArrayLike) -> Points:
        """Return where points [m] are on what is drawn on."""
        return as_points(self.to_pixels(points) * SMOOTH)


def as_points(pixels: FloatArray) -> Points:
    """Return pixels of shape (N, 2) as Pillow takes them."""
    return [(x, y) for x, y in pixels.tolist()]
