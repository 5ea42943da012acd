"""`MapView`: a costmap with masks as a picture to draw on, cropped; and where a localizer believed the robot to be."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from trundle.costmap import INSCRIBED, LETHAL, NO_INFORMATION, Costmap
from trundle.geometry import FloatArray, Pose2D
from trundle.maps import OccupancyGrid
from trundle.maps.masks import SpeedMask
from trundle.mission import Episode, Trajectory
from trundle.observation import LOCALIZATION_STATES, LocalizationState
from trundle.pictures.cells import keep_last
from trundle.pictures.colors import (
    BAD,
    COST_ORDER,
    ESTIMATED,
    FREE,
    KEPT_OUT,
    PAGE,
    SLOW,
    UNKNOWN,
    WARNING,
    Rgb,
    cost_palette,
)
from trundle.pictures.plan import SMOOTH, Canvas, as_points
from trundle.record.page import Mark
from trundle.robots import Robot

LONG_SIDE = 1000
MAX_SIDE = 2000
_MOST_MARKS = 2  # limits that the legend lists one by one
_MARGIN_M = 2.0  # around what is in focus
_LEAST_VIEW_M = 8.0  # a short path is shown with so much around it, so that one sees where it is
_FLOOR_CELL_M = 0.1
_LEAST_RATIO = 0.85  # ratio of the shorter to the longer side of a view, if the map is wide enough
_WHOLE_MAP_SHARE = 0.6  # a view of more than this share of the map shows all of it


class MapView(Canvas):
    """The part of a map in focus, to draw on.

    Args:
        costmap: The robot's costmap.
        focus: Points [m] in the map frame, shape (N, 2), that must be visible. If None, the whole map is shown.
        long_side: Least length of the longer side, in pixels of the finished picture.
        max_side: Largest length of the longer side; larger maps have several cells per pixel.
        zones: Speed limits; keep-out zones are part of the costmap.

    Attributes:
        costmap: The costmap.
        zones: The speed limits, or None.
    """

    def __init__(
        self,
        costmap: Costmap,
        focus: FloatArray | None = None,
        *,
        long_side: int = LONG_SIDE,
        max_side: int = MAX_SIDE,
        zones: SpeedZones | None = None,
    ) -> None:
        self.costmap, self.zones = costmap, zones
        self._crop = _find_crop(costmap, focus)
        row0, row1, col0, col1 = self._crop
        cells = costmap.data[row0:row1, col0:col1]
        longest = max(cells.shape)
        merged = math.ceil(longest / max_side)
        cells = keep_last(cells, COST_ORDER, merged)
        enlarged = max(1, math.ceil(long_side / max(cells.shape)))
        self._pixels_per_cell = enlarged / merged
        rows, cols = cells.shape
        pixels = cost_palette()[cells]
        if costmap.unseen is not None:
            unseen = costmap.unseen[row0:row1, col0:col1].view(np.uint8)
            open_ = (keep_last(unseen, COST_ORDER, merged) == 1) & (cells < INSCRIBED)
            pixels[open_] = (pixels[open_].astype(int) + UNKNOWN) // 2
        if zones is not None:
            self._tint(pixels, zones, merged)
        if costmap.keepout is not None:
            keepout = costmap.keepout[row0:row1, col0:col1]
            pixels[keep_last(keepout, COST_ORDER, merged) == LETHAL] = KEPT_OUT
        large = (cols * enlarged * SMOOTH, rows * enlarged * SMOOTH)
        image = Image.fromarray(pixels[::-1]).resize(large, Image.Resampling.NEAREST)
        super().__init__(image, self._pixels_per_cell / costmap.resolution)

    def _tint(self, pixels: npt.NDArray[np.uint8], zones: SpeedZones, merged: int) -> None:
        """Blend the colour of speed limits into the colours of cells, each of which covers `merged` by `merged`."""
        row0, _, col0, _ = self._crop
        rows, cols = pixels.shape[:2]
        middle = (merged - 1) / 2.0
        row, col = row0 + middle + merged * np.arange(rows)[:, None], col0 + middle + merged * np.arange(cols)
        strength = zones.strength(*self.costmap.cell_to_world(*np.broadcast_arrays(row, col)))[..., None]
        pixels[...] = (pixels + strength * (np.array(SLOW) - pixels.astype(np.float64))).round().astype(np.uint8)

    def to_pixels(self, points: npt.ArrayLike) -> FloatArray:
        """Return pixels of points [m] in the map frame, shape (N, 2), in the finished picture; y points down."""
        local = self.costmap.origin.inverse().transform_points(np.asarray(points, dtype=np.float64).reshape(-1, 2))
        cells = local / self.costmap.resolution
        _, row1, col0, _ = self._crop
        return np.column_stack([cells[:, 0] - col0, row1 - cells[:, 1]]) * self._pixels_per_cell

    def refresh(self, picture: Image.Image, points: npt.ArrayLike, margin: float) -> None:
        """Update a finished picture around points [m], shape (N, 2), with a `margin` [px]."""
        box = self._box(self.to_pixels(points), margin)
        picture.paste(self._image.crop(_enlarged(box)).reduce(SMOOTH), box)

    def stamp(self, picture: Image.Image, pose: Pose2D, corners: FloatArray, color: Rgb) -> None:
        """Draw a robot into a finished picture, without changing the view."""
        points = pose.transform_points(corners)
        box = self._box(self.to_pixels(points), 4.0)
        patch = _enlarge(picture, box)
        draw = ImageDraw.Draw(patch, "RGBA")
        outline = as_points((self.to_pixels(points) - box[:2]) * SMOOTH)
        draw.polygon(outline, fill=(*color, 200))
        draw.line([*outline, outline[0]], fill=color, width=2 * SMOOTH)
        nose = (
            self.to_pixels([(pose.x, pose.y), pose.transform_points([(float(corners[:, 0].max()), 0.0)])[0]]) - box[:2]
        ) * SMOOTH
        draw.line(as_points(nose), fill=PAGE, width=2 * SMOOTH)
        picture.paste(patch.reduce(SMOOTH), box)

    def stamp_trail(self, picture: Image.Image, points: FloatArray, color: Rgb, width: float) -> None:
        """Draw a polyline through points [m], shape (N, 2), into a finished picture, without changing the view."""
        if len(points) > 1:
            self.stamp_lines(picture, points[None], color, width)

    def stamp_lines(self, picture: Image.Image, lines: npt.NDArray[np.floating], color: Rgb, width: float) -> None:
        """Draw polylines through points [m], shape (N, T, 2), into a finished picture, without changing the view."""
        pixels = self.to_pixels(lines)
        box = self._box(pixels, width + 1.0)
        patch = _enlarge(picture, box)
        draw = ImageDraw.Draw(patch, "RGBA")
        for line in ((pixels - box[:2]) * SMOOTH).reshape(lines.shape):
            draw.line(as_points(line), fill=color, width=max(1, round(width * SMOOTH)), joint="curve")
        picture.paste(patch.reduce(SMOOTH), box)

    def ring(self, point: Sequence[float], radius: float, color: Rgb, width: float) -> None:
        """Draw a circle about a point [m]."""
        x, y = self._large([point])[0]
        reach = radius * SMOOTH
        box = (x - reach, y - reach, x + reach, y + reach)
        self._draw.ellipse(box, outline=color, width=max(1, round(width * SMOOTH)))

    def outline(
        self, pose: Pose2D, corners: FloatArray, color: Rgb, width: float, *, alpha: int = 255, fill: int = 0
    ) -> None:
        """Draw a robot's footprint at a pose, map frame; `alpha` and `fill` are 0..255, for line and interior."""
        points = self._large(pose.transform_points(corners))
        if fill:
            self._draw.polygon(points, fill=(*color, fill))
        self._draw.line([*points, points[0]], fill=(*color, alpha), width=max(1, round(width * SMOOTH)))

    def cross(self, point: Sequence[float], radius: float, color: Rgb, width: float) -> None:
        """Draw a cross (×) at a point [m]."""
        x, y = self.to_pixels([point])[0]
        for side in (-1.0, 1.0):
            ends = np.array([[x - radius, y - side * radius], [x + radius, y + side * radius]])
            self.line_pixels(ends, color, width)

    def _box(self, pixels: FloatArray, margin: float) -> tuple[int, int, int, int]:
        """Return whole pixels (left, top, right, bottom) around points, inside the picture and never empty."""
        low, high = pixels.min(axis=0) - margin, pixels.max(axis=0) + margin
        left = min(max(0, math.floor(low[0])), self.size[0] - 1)
        top = min(max(0, math.floor(low[1])), self.size[1] - 1)
        right = min(max(left + 1, math.ceil(high[0])), self.size[0])
        bottom = min(max(top + 1, math.ceil(high[1])), self.size[1])
        return left, top, right, bottom


def _enlarged(box: tuple[int, int, int, int]) -> tuple[int, int, int, int]:
    left, top, right, bottom = box
    return left * SMOOTH, top * SMOOTH, right * SMOOTH, bottom * SMOOTH


def _enlarge(picture: Image.Image, box: tuple[int, int, int, int]) -> Image.Image:
    """Return a part of a finished picture, large enough to draw smooth lines on."""
    part = picture.crop(box)
    return part.resize((part.width * SMOOTH, part.height * SMOOTH), Image.Resampling.NEAREST)


def _find_crop(costmap: Costmap, focus: FloatArray | None) -> tuple[int, int, int, int]:
    """Return first and last + 1 row and column of the part to show: the known cells, restricted to the focus."""
    rows, cols = costmap.shape
    known = costmap.data != NO_INFORMATION
    margin = math.ceil(0.5 / costmap.resolution)
    row0, row1 = _extent(np.flatnonzero(known.any(axis=1)), margin, rows)
    col0, col1 = _extent(np.flatnonzero(known.any(axis=0)), margin, cols)
    if focus is None or len(focus) == 0:
        return row0, row1, col0, col1
    row, col = costmap.world_to_cell(focus[:, 0], focus[:, 1])
    low, high = int(row.min()), int(row.max()) + 1
    left, right = int(col.min()), int(col.max()) + 1
    span = max(high - low, right - left) * costmap.resolution
    longest = max(span + 2.0 * max(_MARGIN_M, 0.1 * span), _LEAST_VIEW_M) / costmap.resolution
    height = max(_LEAST_RATIO * longest, (high - low) + 2.0 * _MARGIN_M / costmap.resolution)
    width = max(_LEAST_RATIO * longest, (right - left) + 2.0 * _MARGIN_M / costmap.resolution)
    near = (*_around(low, high, height, row0, row1), *_around(left, right, width, col0, col1))
    if (near[1] - near[0]) * (near[3] - near[2]) > _WHOLE_MAP_SHARE * (row1 - row0) * (col1 - col0):
        return row0, row1, col0, col1
    return near


def _around(low: int, high: int, length: float, first: int, last: int) -> tuple[int, int]:
    """Widen low..high to a length, shifted to lie within first..last as far as possible."""
    wanted = min(math.ceil(length), last - first)
    begin = (low + high - wanted) // 2
    begin = max(first, min(begin, last - wanted))
    # The focus may lie outside the map; some of the map is always shown.
    return begin, begin + wanted


def _extent(known: npt.NDArray[np.intp], margin: int, size: int) -> tuple[int, int]:
    if len(known) == 0:
        return 0, size
    return max(0, int(known[0]) - margin), min(size, int(known[-1]) + margin + 1)


def view_run(
    costmap: Costmap | None,
    robot: Robot,
    episode: Episode,
    speed_mask: SpeedMask | None,
    *,
    long_side: int = LONG_SIDE,
    max_side: int = MAX_SIDE,
) -> MapView:
    """Return a view of all that a run planned and drove, on its costmap; if that is None, on an empty floor."""
    goals = np.array([goal[:2] for goal in episode.goals]).reshape(-1, 2)
    seen = np.concatenate([episode.trajectory.poses[:, :2], goals, *(path.poses[:, :2] for path in episode.paths)])
    costmap = _empty_floor(seen, robot) if costmap is None else costmap
    return MapView(costmap, seen, long_side=long_side, max_side=max_side, zones=speed_zones(speed_mask, robot))


def _empty_floor(points: FloatArray, robot: Robot) -> Costmap:
    """Return a free costmap around points [m], shape (N, 2), to draw the run of an agent on that has no costmap."""
    low, high = points.min(axis=0) - _LEAST_VIEW_M, points.max(axis=0) + _LEAST_VIEW_M
    edge = _FLOOR_CELL_M
    cols, rows = np.ceil((high - low) / edge).astype(int).tolist()
    grid = OccupancyGrid(np.zeros((rows, cols), dtype=np.int8), edge, Pose2D(float(low[0]), float(low[1])))
    return Costmap.from_grid(grid, robot)


# Zones ----------------------------------------------------------------------------------------------------------------


class SpeedZones:
    """The limits of a speed mask as colours: stronger for lower limits.

    Args:
        mask: The mask.
        top_speed: Maximum speed of the robot [m/s].
    """

    def __init__(self, mask: SpeedMask, top_speed: float) -> None:
        self._mask = mask
        self._top_speed = top_speed

    def strength(self, x: npt.ArrayLike, y: npt.ArrayLike) -> FloatArray:
        """Return the strength of the colour at points [m], map frame: 0 without a limit, 0.25 to 0.7 with one."""
        return self._strength_of(self._mask.limit_at(x, y, self._top_speed))

    def marks(self) -> list[Mark]:
        """Return entries of the legend: the limits if they are few, else their range."""
        values = np.flatnonzero(np.bincount(np.maximum(self._mask.grid.data, 0).ravel(), minlength=101))
        limits = np.unique(self._mask.limits(self._top_speed)[values[values > 0]])
        if len(limits) == 0:
            return []
        if len(limits) <= _MOST_MARKS:
            return [Mark("square", self._color_of(limit), f"up to {limit:.2g} m/s") for limit in limits.tolist()]
        low, high = float(limits[0]), float(limits[-1])
        return [Mark("square", self._color_of(low), f"up to {low:.2g} to {high:.2g} m/s")]

    def _strength_of(self, limits: FloatArray) -> FloatArray:
        share = np.clip(1.0 - limits / self._top_speed, 0.0, 1.0)
        return np.where(np.isfinite(limits), 0.25 + 0.45 * share, 0.0)

    def _color_of(self, limit: float) -> Rgb:
        strength = float(self._strength_of(np.array(limit)))
        red, green, blue = (round(free + strength * (slow - free)) for free, slow in zip(FREE, SLOW, strict=True))
        return red, green, blue


def speed_zones(mask: SpeedMask | None, robot: Robot) -> SpeedZones | None:
    """Return the zones of a mask for a robot, or None without a mask."""
    return None if mask is None else SpeedZones(mask, robot.limits.linear_speed)


def zone_marks(costmap: Costmap, zones: SpeedZones | None) -> list[Mark]:
    """Return the entries of the legend for the zones that there are."""
    kept_out = costmap.keepout is not None and bool((costmap.keepout == LETHAL).any())
    marks = [Mark("square", KEPT_OUT, "kept out")] if kept_out else []
    return marks + ([] if zones is None else zones.marks())


STATE_COLORS: dict[LocalizationState, Rgb] = {"ambiguous": WARNING, "lost": BAD}

_JUMP_M = 0.5
"""Where an estimate moves by more between two rows, it was corrected: a line there would look like a path."""


def draw_doubts(view: MapView, trajectory: Trajectory, *, width: float = 12.0) -> list[Mark]:
    """Mark on the true trajectory where the localizer was not sure, and return the marks of the legend."""
    marks: list[Mark] = []
    for state, color in STATE_COLORS.items():
        rows = np.flatnonzero(trajectory.localization == LOCALIZATION_STATES.index(state))
        if not len(rows):
            continue
        marks.append(Mark("line", color, state))
        for part in np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1):
            points = trajectory.poses[part, :2]
            view.disc(points[0].tolist(), 0.5 * width, color)  # it often stands then
            if len(points) > 1:
                view.line(points, color, width)
    return marks


def draw_estimated(view: MapView, trajectory: Trajectory, *, width: float = 3.0) -> list[Mark]:
    """Draw the estimated trajectory, and return the mark of the legend; nothing where it is the true one."""
    if not has_estimates(trajectory):
        return []
    points = trajectory.estimates[:, :2]
    jumps = np.flatnonzero(np.hypot(*np.diff(points, axis=0).T) > _JUMP_M) + 1
    for part in np.split(points, jumps):
        if len(part) > 1:
            view.line(part, ESTIMATED, width)
    return [Mark("line", ESTIMATED, "estimated")]


def has_estimates(trajectory: Trajectory) -> bool:
    """Return whether a localizer estimated the poses: they are not the true ones."""
    return bool((trajectory.estimates != trajectory.poses).any())
