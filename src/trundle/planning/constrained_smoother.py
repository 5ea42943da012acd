"""`ConstrainedSmoother`: a path made of curves that a robot can drive, clear of costs; by name `constrained`."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle import _core
from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError, InputError, OutsideMapError
from trundle.geometry import FloatArray, Footprint, arc_lengths, wrap_angles
from trundle.path import Path
from trundle.planning.motions import CHECK_STEP_M
from trundle.planning.path_check import PathCheck
from trundle.registry import CopiedAsNew

PADDING_SHARE = 0.9
"""Share of the padding that may pass between two checked poses; the rest is for a path's chords instead of arcs."""

LEAST_STEP_M = 0.005
"""Checked poses are no closer than this, however small the padding."""

LEAST_PADDING_M = LEAST_STEP_M / (2.0 * PADDING_SHARE)
"""With less, something might fit between two checked poses."""

_ASKEW_RAD = 0.1
"""A leg whose yaws differ more than this from its direction is a straight line between two turns in place."""


@dataclass(frozen=True, slots=True)
class SmoothingSettings:
    """Settings of `ConstrainedSmoother`, under the names of Nav2's constrained smoother where it has them.

    Attributes:
        minimum_turning_radius: Radius of the tightest new curve [m].
        w_cost: A cell of cost c has 1 + w_cost · c / 252 times the cost of a free one. 4 is NavFn's.
        w_smooth: Price of bending [m]: of the square of the curvature, integrated along the path.
        cost_tolerance: Share by which the integral of the cells' price along the path may rise.
        reverse_penalty: Cost of a metre backwards, in that of one forwards; at least 1.
        change_penalty: Price of a change between forward and backward [m].
        turn_penalty: Price of turning in place [m/rad].
        padding: Distance from everything that the footprint keeps on new curves [m]. Poses are checked so closely that
            nothing can pass between two of them.
        spacing: Largest distance between two poses of a new curve [m].
    """

    minimum_turning_radius: float = 0.4
    w_cost: float = 4.0
    w_smooth: float = 0.1
    cost_tolerance: float = 0.02
    reverse_penalty: float = 2.0
    change_penalty: float = 0.3
    turn_penalty: float = 0.5
    padding: float = 0.02
    spacing: float = 0.05

    def __post_init__(self) -> None:
        limits = {
            "minimum_turning_radius": (0.01, 1e4),
            "reverse_penalty": (1.0, 1e3),
            "padding": (0.0, 1e4),
            "spacing": (1e-3, 1e4),
        }
        for option in dataclasses.fields(self):
            value, (least, most) = getattr(self, option.name), limits.get(option.name, (0.0, 1e3))
            if isinstance(value, bool) or not isinstance(value, int | float) or not least <= value <= most:
                raise InputError(f"{option.name} must be a number from {least:g} to {most:g}, got {value!r}")


@dataclass(frozen=True, slots=True, eq=False)
class Smoothing:
    """The result of smoothing a path.

    Attributes:
        path: The new path.
        kept: For each of its legs, whether it is part of the old path, shape (N − 1,).
        cost_before: Integral of the cells' price along the old path [m], clipped at the cells' borders; on a border the
            higher cost counts.
        cost_after: The same integral along the new path; at most `cost_tolerance` above.
        price_before: The integral along the old path with the prices of driving back, changing direction and turning in
            place [m].
        price_after: The same price of the new path [m].
    """

    path: Path
    kept: npt.NDArray[np.bool_]
    cost_before: float
    cost_after: float
    price_before: float
    price_after: float


class ConstrainedSmoother(CopiedAsNew):
    """Replaces a path by arcs and lines of a least radius that are free and keep clear of costs.

    Where the path has room the new course consists of curves of at least `minimum_turning_radius`, each joining the
    next without a kink; where no curve is free within `cost_tolerance`, a piece of the old path
    stays as it was. So the result is free wherever the path was, and has a kink, a turn in place or a tighter bend only
    where the path had one that had to stay. Its ends are exactly those of the path. Changes of direction are moved or
    removed, never added.

    It alternates between an elastic band (Quinlan and Khatib 1993), which finds where costs are low and the path is
    straight, and dynamic programming over Dubins and Reeds-Shepp curves between poses of the path and of the band. Its
    memory is kept for the next path; several threads may use one smoother.

    Args:
        settings: Any field of `SmoothingSettings`.

    Raises:
        InputError: If a setting is out of range.
    """

    def __init__(self, **settings: Any) -> None:
        self.settings = SmoothingSettings(**settings)
        self._curves = _core.PathSmoother()

    def smooth(self, path: Path, costmap: Costmap) -> Path:
        """Return a smoother path with the same ends, with its `cost` scaled by the change in its price.

        Raises:
            OutsideMapError: If a pose of the path lies outside the map; `error.pose` and `error.cell` say which.
            BlockedPoseError: If the footprint collides on the path by more than about 1 cm.
            InputError: If an argument is not a `Path` and a `Costmap`.
        """
        return self.explain(path, costmap).path

    def explain(self, path: Path, costmap: Costmap) -> Smoothing:
        """Smooth a path, and say what stayed and what it costs; see `smooth` for the errors."""
        if not (isinstance(path, Path) and isinstance(costmap, Costmap)):
            got = f"{type(path).__name__} and {type(costmap).__name__}"
            raise InputError(f"a smoother needs a Path and a Costmap, got {got}")
        driven = as_driven(path)
        _check(driven, costmap)
        return self.smooth_free(driven, costmap)

    def smooth_free(self, path: Path, costmap: Costmap) -> Smoothing:
        """Smooth a path of a planner of trundle, which is known to be free and whose yaws point along its legs."""
        settings = self.settings
        padding = float(settings.padding)
        checked = CheckedOutline.of(costmap.planar, padding)
        on_grid = _on_grid(costmap, path.poses)
        poses, backward, source, kept, prices = self._curves.smooth(
            costmap.data,
            costmap.resolution,
            checked.outline,
            on_grid,
            path.backward.view(np.uint8),
            radius=float(settings.minimum_turning_radius),
            reverse_penalty=float(settings.reverse_penalty),
            change_cost=float(settings.change_penalty),
            turn_cost=float(settings.turn_penalty),
            cost_weight=float(settings.w_cost),
            curve_weight=float(settings.w_smooth),
            cost_tolerance=float(settings.cost_tolerance),
            step=checked.step_m,
            spacing=pose_spacing(settings.spacing, settings.minimum_turning_radius, padding),
            inner=checked.inner,
        )
        if len(poses) == 0:
            return Smoothing(path, np.ones(len(path) - 1, dtype=np.bool_), 0.0, 0.0, 0.0, 0.0)
        line_before, before, line_after, after = prices
        new = np.column_stack(
            [costmap.origin.transform_points(poses[:, :2]), wrap_angles(poses[:, 2] + costmap.origin.yaw)]
        )
        old = source >= 0
        new[old] = path.poses[source[old]]
        smooth = dataclasses.replace(
            path,
            poses=new,
            backward=backward.view(np.bool_),
            cost=path.cost * (after / before) if before > 0.0 else path.cost,
        )
        return Smoothing(smooth, kept.view(np.bool_), line_before, line_after, before, after)


@dataclass(frozen=True, slots=True)
class CheckedOutline:
    """How the kernels check a footprint that keeps a padding.

    Attributes:
        outline: The padded footprint, shape (N, 2): it is free at every checked pose.
        step_m: How far a point of it moves at most between two of them [m]. Nothing can pass between.
        inner: Where the padding is too small for that, `outline` has more of it; then only what this one sweeps over
            has to be free.
    """

    outline: FloatArray
    step_m: float
    inner: FloatArray | None

    @classmethod
    def of(cls, footprint: Footprint, padding: float) -> CheckedOutline:
        """Choose the outline and the step for a footprint and a padding [m]."""
        if padding >= LEAST_PADDING_M:
            return cls(footprint.padded(padding).outline, 2.0 * PADDING_SHARE * padding, None)
        inner = footprint.padded((1.0 - PADDING_SHARE) * padding)
        return cls(inner.padded(0.5 * LEAST_STEP_M).outline, LEAST_STEP_M, inner.outline)


def pose_spacing(spacing: float, radius: float, padding: float) -> float:
    """Return the largest distance between two poses of an arc [m] at which its chords keep within the padding.

    A chord of length s leaves an arc of radius r by s² / 8 r at most (the sagitta, for s much smaller than r).
    """
    room = max((1.0 - PADDING_SHARE) * padding, 1e-5)
    return min(float(spacing), math.sqrt(8.0 * radius * room))


def _on_grid(costmap: Costmap, poses: FloatArray) -> FloatArray:
    """Return poses of the map frame in the frame of the grid's corner, shape (N, 3)."""
    inverse = costmap.origin.inverse()
    return np.column_stack([inverse.transform_points(poses[:, :2]), poses[:, 2] + inverse.yaw])


def as_driven(path: Path) -> Path:
    """Return the path with yaws that lead along its legs; other legs get turns in place at both ends."""
    change = np.diff(path.poses, axis=0)
    heading = np.arctan2(change[:, 1], change[:, 0]) + np.where(path.backward, math.pi, 0.0)
    turn = wrap_angles(change[:, 2])
    moves = np.hypot(change[:, 0], change[:, 1]) > 1e-9
    askew = moves & (np.abs(wrap_angles(heading - path.poses[:-1, 2] - 0.5 * turn)) > _ASKEW_RAD)
    if not askew.any():
        return path
    poses: list[tuple[float, float, float]] = []
    backward: list[bool] = []
    for k, pose in enumerate(path.poses.tolist()):
        x, y, yaw = pose
        arrives = float(heading[k - 1]) if k > 0 and askew[k - 1] else yaw
        leaves = float(heading[k]) if k < len(askew) and askew[k] else yaw
        inside = 0 < k < len(askew)
        # Between two such legs the yaw of the pose is not used.
        yaws = [arrives, leaves] if inside and askew[k - 1] and askew[k] else [arrives, yaw, leaves]
        for number, value in enumerate(yaws):
            if number > 0 and abs(math.remainder(value - poses[-1][2], 2.0 * math.pi)) <= 1e-9:
                continue
            if poses:
                backward.append(bool(path.backward[k - 1]) if number == 0 else False)
            poses.append((x, y, value))
    return dataclasses.replace(path, poses=np.array(poses), backward=np.array(backward, dtype=np.bool_))


def _check(path: Path, costmap: Costmap) -> None:
    """Raise the error for a path that cannot be driven as it is."""
    rows, cols = costmap.world_to_cell(path.poses[:, 0], path.poses[:, 1])
    outside = np.flatnonzero(~costmap.contains(rows, cols))
    if len(outside):
        k = int(outside[0])
        x, y, yaw = path.poses[k].tolist()
        raise OutsideMapError(
            f"the path's pose {k} ({x:.2f}, {y:.2f}) lies outside the map",
            pose=(x, y, yaw),
            cell=(int(rows[k]), int(cols[k])),
        )
    check = PathCheck(path)
    if check.first_hit(costmap) is None:
        return
    # A path of another planner may have been checked at its poses only: between two it may touch something.
    reach = costmap.inscribed_radius
    shallow = costmap.footprint * (1.0 - min(0.5, 0.5 * CHECK_STEP_M / reach))
    hits = np.flatnonzero(costmap.footprint_collides(check.poses, outline=shallow))
    if len(hits) == 0:
        return
    x, y, yaw = check.poses[hits[0]].tolist()
    driven = arc_lengths(path.poses)
    k = int(np.searchsorted(driven, check.along[hits[0]] - 1e-9))
    row, col = (int(index) for index in costmap.world_to_cell(x, y))
    raise BlockedPoseError(
        f"the path's pose {k} collides: the footprint touches something at ({x:.2f}, {y:.2f}, "
        f"{math.degrees(yaw):.0f}°), {check.along[hits[0]]:.2f} m along it; plan it on this map before it is smoothed",
        pose=(x, y, yaw),
        cell=(row, col),
    )
