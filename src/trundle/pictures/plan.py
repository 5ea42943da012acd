"""`Plan`: a drawing of lines and shapes in the plane, with north up, over a grid of round metres."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from trundle.geometry import FloatArray, Pose2D
from trundle.pictures.colors import PAGE, PAPER_LINE, Rgb
from trundle.pictures.text import scale_length

_SMOOTH = 2  # drawn so much larger, then averaged
_LONG_SIDE = 720
_LEAST_RATIO = 0.3  # of the shorter to the longer side
_MARGIN = 0.06  # of the longer side


class Plan:
    """A drawing in the map frame; lengths that end in `_m` are in metres, others in pixels of the finished picture.

    Args:
        points: What must be seen [m], shape (N, 2), N ≥ 1.
        least_m: Smallest width and height that are shown.
        long_side: Of the finished picture [px].
        margin_m: Around the points, at least.
    """

    def __init__(
        self,
        points: npt.ArrayLike,
        *,
        least_m: float = 1.0,
        long_side: int = _LONG_SIDE,
        margin_m: float = 0.0,
    ) -> None:
        seen = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        low, high = seen.min(axis=0), seen.max(axis=0)
        middle, extent = (low + high) / 2.0, np.maximum(high - low, least_m)
        extent = extent + 2.0 * max(margin_m, _MARGIN * float(extent.max()))
        extent = np.maximum(extent, _LEAST_RATIO * extent.max())
        self.pixels_per_metre = long_side / float(extent.max())
        """Scale of the finished picture."""
        self.size = (round(float(extent[0]) * self.pixels_per_metre), round(float(extent[1]) * self.pixels_per_metre))
        """Width and height of the finished picture [px]."""
        self._west, self._north = float(middle[0] - extent[0] / 2.0), float(middle[1] + extent[1] / 2.0)
        self._image = Image.new("RGB", (self.size[0] * _SMOOTH, self.size[1] * _SMOOTH), PAGE)
        self._draw = ImageDraw.Draw(self._image, "RGBA")
        self._rule()

    def _rule(self) -> None:
        """Draw the lines of round metres."""
        step = scale_length(self.pixels_per_metre)
        width, height = (side * _SMOOTH for side in self.size)
        south, east = (
            self._north - self.size[1] / self.pixels_per_metre,
            self._west + self.size[0] / self.pixels_per_metre,
        )
        for number in range(math.ceil(self._west / step), math.floor(east / step) + 1):
            x = float(self._large([(number * step, 0.0)])[0, 0])
            self._draw.line((x, 0, x, height), fill=PAPER_LINE, width=_SMOOTH)
        for number in range(math.ceil(south / step), math.floor(self._north / step) + 1):
            y = float(self._large([(0.0, number * step)])[0, 1])
            self._draw.line((0, y, width, y), fill=PAPER_LINE, width=_SMOOTH)

    def to_pixels(self, points: npt.ArrayLike) -> FloatArray:
        """Where points [m], shape (N, 2), are in the finished picture [px]; y goes down."""
        return self._large(points) / _SMOOTH

    def finish(self) -> Image.Image:
        """Return the picture."""
        return self._image.reduce(_SMOOTH)

    def line(self, points: npt.ArrayLike, color: Rgb, width: float) -> None:
        """Draw a polyline through points [m], shape (N, 2), with round ends."""
        large = self._pairs(points)
        thick = max(1, round(width * _SMOOTH))
        if len(large) > 1:
            self._draw.line(large, fill=color, width=thick, joint="curve")
        for x, y in (large[0], large[-1]):
            self._draw.ellipse((x - thick / 2, y - thick / 2, x + thick / 2, y + thick / 2), fill=color)

    def polygon(self, points: npt.ArrayLike, color: Rgb, *, fill: int = 0, width: float = 2.0) -> None:
        """Draw a closed outline through points [m]; `fill`, 0..255, is how opaque its inside is."""
        large = self._pairs(points)
        if fill:
            self._draw.polygon(large, fill=(*color, fill))
        self._draw.line([*large, large[0]], fill=color, width=max(1, round(width * _SMOOTH)), joint="curve")

    def circle(self, point: Sequence[float], radius_m: float, color: Rgb, *, fill: int = 0, width: float = 2.0) -> None:
        """Draw a circle about a point [m]."""
        x, y = self._pairs([point])[0]
        reach = radius_m * self.pixels_per_metre * _SMOOTH
        box = (x - reach, y - reach, x + reach, y + reach)
        self._draw.ellipse(box, fill=(*color, fill), outline=color, width=max(1, round(width * _SMOOTH)))

    def disc(self, point: Sequence[float], radius: float, color: Rgb) -> None:
        """Draw a filled circle of `radius` [px] about a point [m]."""
        x, y = self._pairs([point])[0]
        reach = radius * _SMOOTH
        self._draw.ellipse((x - reach, y - reach, x + reach, y + reach), fill=color)

    def marker(self, pose: Pose2D, color: Rgb, *, radius: float = 10.0) -> None:
        """Draw a disc with an arrowhead along a pose's x axis."""
        self.disc((pose.x, pose.y), radius + 1.5, PAGE)
        self.disc((pose.x, pose.y), radius, color)
        self.arrow(pose, 1.3 * radius, PAGE)

    def arrow(self, pose: Pose2D, length: float, color: Rgb) -> None:
        """Draw an arrowhead of `length` [px] along a pose's x axis, with its middle on the pose."""
        shape = np.array([[0.62, 0.0], [-0.38, 0.38], [-0.18, 0.0], [-0.38, -0.38]]) * (length / self.pixels_per_metre)
        self._draw.polygon(self._pairs(pose.transform_points(shape)), fill=color)

    def target(self, point: Sequence[float], color: Rgb) -> None:
        """Draw a ring with a dot in it about a point [m]: a goal of any yaw."""
        for radius, paint in ((11.5, PAGE), (10.0, color), (7.0, PAGE), (4.0, color)):
            self.disc(point, radius, paint)

    @property
    def inner_scale(self) -> float:
        """Pixels per metre of the drawing before it is averaged."""
        return self.pixels_per_metre * _SMOOTH

    def inner_points(self) -> tuple[FloatArray, FloatArray]:
        """Where the pixels of the drawing are before it is averaged [m]: x of the columns, y of the rows."""
        wide, high = self._image.size
        return (
            self._west + (np.arange(wide, dtype=np.float64) + 0.5) / self.inner_scale,
            self._north - (np.arange(high, dtype=np.float64) + 0.5) / self.inner_scale,
        )

    def paste(self, pixels: npt.NDArray[np.uint8], covered: npt.NDArray[np.bool_]) -> None:
        """Put colours of pixels, as many as `inner_points` has, where they are covered."""
        self._image.paste(Image.fromarray(pixels), (0, 0), Image.fromarray(covered.astype(np.uint8) * 255))

    def _large(self, points: npt.ArrayLike) -> FloatArray:
        numbers = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        scale = self.inner_scale
        return np.column_stack([(numbers[:, 0] - self._west) * scale, (self._north - numbers[:, 1]) * scale])

    def _pairs(self, points: npt.ArrayLike) -> list[tuple[float, float]]:
        return [(x, y) for x, y in self._large(points).tolist()]
