"""`Canvas`: a picture with smooth lines and shapes at places in metres; `Plan`: one over a grid, with north up."""

from __future__ import annotations

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from trundle.geometry import FloatArray, Pose2D
from trundle.pictures.colors import BACKED, GOAL, LINE, PAGE, PAPER_LINE, START, Rgb
from trundle.pictures.figure import make_figure, scale_length

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


_LONG_SIDE = 720
_LEAST_RATIO = 0.3  # of the shorter to the longer side
_MARGIN = 0.06  # of the longer side


class Plan(Canvas):
    """A drawing in the map frame.

    Lengths whose names end in `_m` are in metres, others in pixels of the finished picture.

    Args:
        points: What must be seen [m], shape (N, 2), N ≥ 1.
        least_m: Smallest width and height that are shown.
        long_side: Longer side of the finished picture [px].
        margin_m: Least margin around the points.
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
        scale = long_side / float(extent.max())
        width, height = (round(float(side) * scale) for side in extent)
        self._west, self._north = float(middle[0] - extent[0] / 2.0), float(middle[1] + extent[1] / 2.0)
        super().__init__(Image.new("RGB", (width * SMOOTH, height * SMOOTH), PAGE), scale)
        self._rule()

    def _rule(self) -> None:
        """Draw the lines of round metres."""
        step = scale_length(self.pixels_per_metre)
        width, height = (side * SMOOTH for side in self.size)
        south, east = (
            self._north - self.size[1] / self.pixels_per_metre,
            self._west + self.size[0] / self.pixels_per_metre,
        )
        for number in range(math.ceil(self._west / step), math.floor(east / step) + 1):
            x, _ = self._large([(number * step, 0.0)])[0]
            self._draw.line((x, 0, x, height), fill=PAPER_LINE, width=SMOOTH)
        for number in range(math.ceil(south / step), math.floor(self._north / step) + 1):
            _, y = self._large([(0.0, number * step)])[0]
            self._draw.line((0, y, width, y), fill=PAPER_LINE, width=SMOOTH)

    def to_pixels(self, points: npt.ArrayLike) -> FloatArray:
        """Return where points [m], shape (N, 2), are in the finished picture [px]; y goes down."""
        numbers = np.asarray(points, dtype=np.float64).reshape(-1, 2)
        scale = self.pixels_per_metre
        return np.column_stack([(numbers[:, 0] - self._west) * scale, (self._north - numbers[:, 1]) * scale])

    def polygon(self, points: npt.ArrayLike, color: Rgb, *, fill: int = 0, width: float = 2.0) -> None:
        """Draw a closed outline through points [m]; `fill`, 0..255, is how opaque its inside is."""
        large = self._large(points)
        if fill:
            self._draw.polygon(large, fill=(*color, fill))
        self._draw.line([*large, large[0]], fill=color, width=max(1, round(width * SMOOTH)), joint="curve")

    def circle(self, point: Sequence[float], radius_m: float, color: Rgb, *, fill: int = 0, width: float = 2.0) -> None:
        """Draw a circle about a point [m]."""
        x, y = self._large([point])[0]
        reach = radius_m * self.pixels_per_metre * SMOOTH
        box = (x - reach, y - reach, x + reach, y + reach)
        self._draw.ellipse(box, fill=(*color, fill), outline=color, width=max(1, round(width * SMOOTH)))

    def marker(self, pose: Pose2D, color: Rgb, *, radius: float = 10.0) -> None:
        """Draw a disc with an arrowhead along a pose's x axis."""
        self.disc((pose.x, pose.y), radius + 1.5, PAGE)
        self.disc((pose.x, pose.y), radius, color)
        self.arrow(pose, 1.3 * radius, PAGE)

    def target(self, point: Sequence[float], color: Rgb) -> None:
        """Draw a ring with a dot in it about a point [m]: a goal of any yaw."""
        for radius, paint in ((11.5, PAGE), (10.0, color), (7.0, PAGE), (4.0, color)):
            self.disc(point, radius, paint)

    @property
    def inner_scale(self) -> float:
        """Pixels per metre of the drawing before it is averaged."""
        return self.pixels_per_metre * SMOOTH

    def inner_points(self) -> tuple[FloatArray, FloatArray]:
        """Return where the pixels of the drawing are before it is averaged [m]: x of the columns, y of the rows."""
        wide, high = self._image.size
        return (
            self._west + (np.arange(wide, dtype=np.float64) + 0.5) / self.inner_scale,
            self._north - (np.arange(high, dtype=np.float64) + 0.5) / self.inner_scale,
        )

    def paste(self, pixels: npt.NDArray[np.uint8], covered: npt.NDArray[np.bool_]) -> None:
        """Put colours of pixels, as many as `inner_points` has, where they are covered."""
        self._image.paste(Image.fromarray(pixels), (0, 0), Image.fromarray(covered.astype(np.uint8) * 255))


def draw_path(poses: FloatArray, backward: npt.NDArray[np.bool_], title: str, lines: Sequence[str]) -> Image.Image:
    """Draw poses (x, y, yaw), shape (N, 3), and in another colour the legs that are driven backwards."""
    plan = Plan(poses[:, :2])
    draw_legs(plan, poses, backward)
    start, goal = Pose2D(*poses[0].tolist()), Pose2D(*poses[-1].tolist())
    plan.marker(goal, GOAL)
    plan.marker(start, START)
    return make_figure(plan.finish(), plan.pixels_per_metre, title, lines)


def draw_legs(plan: Plan, poses: FloatArray, backward: npt.NDArray[np.bool_], *, width: float = 5.0) -> None:
    """Draw the legs of a path, shape (N, 3): forward ones in `LINE`, backward ones in `BACKED`."""
    turns = np.flatnonzero(np.diff(backward.astype(np.int8))) + 1
    for first, last in itertools.pairwise([0, *turns.tolist(), len(poses) - 1]):
        color = BACKED if len(backward) and backward[first] else LINE
        plan.line(poses[first : last + 1, :2], color, width)
