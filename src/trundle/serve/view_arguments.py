"""What `show` and `View.update` take, checked: worlds, poses, paths and scans in the forms that loops have them."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path as FilePath
from types import EllipsisType
from typing import Any, TypeAlias, TypeVar, cast

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError, UnknownNameError
from trundle.files.kinds import MAP, WORLD, find_kind
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.localization.localizer import check_covariance
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate, Scan
from trundle.path import Path
from trundle.robots import Robot
from trundle.values import as_array, as_number, check_kind, show_value
from trundle.worlds import World, world_names

AnyPose: TypeAlias = Pose2D | Sequence[float] | FloatArray
AnyPath: TypeAlias = Path | npt.NDArray[Any] | Sequence[Sequence[float]]
AnyScans: TypeAlias = Scan | Sequence[Scan]

MOST_ROBOTS, MOST_POINTS, _MOST_TEXT = 100, 100_000, 1000
_RESOLUTION_M = 0.05

_Value = TypeVar("_Value")


def read_place(
    world: World | OccupancyGrid | str | os.PathLike[str] | None, robot: Robot
) -> tuple[World | None, OccupancyGrid | None]:
    """Return a world and its map, of whichever is given.

    Raises:
        InputError: If it is no world, map, name or file of one.
    """
    if isinstance(world, str | os.PathLike):
        world = _load(os.fspath(world))
    if world is None:
        return None, None
    if isinstance(world, OccupancyGrid):
        return World.from_map(world, unknown="free"), world
    check_kind(
        world, (World, OccupancyGrid), "the world of a view", "give one of these, a world's name, a file, or None"
    )
    try:
        return world, OccupancyGrid.from_world(world, resolution=_RESOLUTION_M, z_range=robot.z_range)
    except InputError:  # too large for a map of these cells: the page shows it in 3D
        return world, None


def _load(text: str) -> World | OccupancyGrid:
    if text in world_names():
        return World.generate(text)
    kind = find_kind(text)
    if kind == MAP:
        return OccupancyGrid.load(text)
    if kind is None and not FilePath(text).exists() and os.sep not in text and "." not in text:
        raise UnknownNameError("world", text, world_names())
    if kind not in (WORLD, None):
        raise InputError(f"{text}: this is {kind}, not a world or a map; give a world's name, or the file of one")
    return World.load(text)


def read_poses(pose: AnyPose | Mapping[str, AnyPose]) -> dict[str, Pose2D]:
    """Return the poses of all robots by name; a single one has the name "".

    Raises:
        InputError: If they are no poses.
    """
    if not isinstance(pose, Mapping):
        return {"": _pose_of(cast("AnyPose", pose))}
    given = cast("Mapping[str, AnyPose]", pose)
    if not 1 <= len(given) <= MOST_ROBOTS:
        raise InputError(f"a view shows 1 to {MOST_ROBOTS} robots, got {len(given)} poses")
    for name in given:
        check_kind(name, str, "the name of a robot in a view", "give poses as {name: pose}")
    return {name[:60]: _pose_of(value) for name, value in given.items()}


def read_paths(
    path: AnyPath | Mapping[str, AnyPath | None] | None, robots: Mapping[str, Pose2D]
) -> dict[str, FloatArray]:
    """Return the path [m] of each robot that has one, shape (N, 2).

    Raises:
        InputError: If one is no path, or of no robot.
    """
    found = {name: _points_of(value) for name, value in _by_robot("path", path, robots).items() if value is not None}
    return {name: points for name, points in found.items() if len(points)}


def read_scans(
    scan: AnyScans | Mapping[str, AnyScans] | None, robots: Mapping[str, Pose2D]
) -> dict[tuple[str, str], tuple[Scan, Pose2D]]:
    """Return the scans by robot and lidar, each with the robot's pose.

    Raises:
        InputError: If one is no scan, or of no robot.
    """
    found: dict[tuple[str, str], tuple[Scan, Pose2D]] = {}
    for name, value in _by_robot("scan", scan, robots).items():
        scans = [value] if isinstance(value, Scan) or not isinstance(value, Sequence) else value
        for one in scans:
            check_kind(one, Scan, "scan", "give a trundle.Scan, several in a list, or None for none")
            found[name, one.lidar] = one, robots[name]
    return found


def read_particles(particles: npt.ArrayLike) -> FloatArray:
    """Return particles as (x, y, yaw, weight), shape (N, 4); those without weights weigh the same.

    Raises:
        InputError: If they are no such array.
    """
    given = as_array(particles, np.float64, "particles", copy=False)
    if given.ndim != 2 or given.shape[1] not in (3, 4) or len(given) > MOST_POINTS:
        raise InputError(
            "particles must be an array of shape (N, 3), (x, y, yaw), or (N, 4) with weights, of at most "
            f"{MOST_POINTS} rows; got shape {given.shape}"
        )
    if not np.isfinite(given).all():
        raise InputError("particles must have finite numbers [m, rad], in the map frame")
    return np.c_[given, np.ones(len(given))][:, :4].copy()


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """What a loop has given of what its robot believes.

    Attributes:
        estimate: The estimate, or None where the pose of the robot is it.
        covariance: Covariance of (x, y, yaw), shape (3, 3), in place of that of the estimate; None gives none.
        particles: Particles in place of those of the estimate, shape (N, 4); None gives none.
    """

    estimate: Estimate | None = None
    covariance: FloatArray | None = None
    particles: FloatArray | None = None

    def of(self, robots: Mapping[str, Pose2D]) -> Estimate | None:
        """Return the estimate to draw for these robots; None where nothing was given.

        Raises:
            InputError: If there are several robots.
        """
        if self.estimate is None and self.covariance is None and self.particles is None:
            return None
        if len(robots) > 1:
            raise InputError("a view draws estimate, covariance and particles of a single robot; give a single pose")
        shown = Estimate(0.0, next(iter(robots.values()))) if self.estimate is None else self.estimate
        if self.covariance is not None:
            shown = replace(shown, covariance=self.covariance)
        return shown if self.particles is None else replace(shown, particles=self.particles)


def read_belief(
    before: Belief,
    estimate: Estimate | EllipsisType | None,
    covariance: npt.ArrayLike | EllipsisType | None,
    particles: npt.ArrayLike | EllipsisType | None,
) -> Belief:
    """Return what is believed after an update; what is not given stays as it was before.

    Raises:
        InputError: If something is of another kind.
    """
    if estimate is not ... and estimate is not None:
        check_kind(estimate, Estimate, "estimate", "give the trundle.Estimate of a localizer, or None for none")
        before = replace(before, estimate=estimate)
    elif estimate is None:
        before = replace(before, estimate=None)
    if covariance is not ...:
        before = replace(before, covariance=None if covariance is None else check_covariance(covariance, "the pose"))
    if particles is not ...:
        before = replace(before, particles=None if particles is None else read_particles(particles))
    return before


def read_text(text: object) -> str:
    """Return the headline.

    Raises:
        InputError: If it is no text.
    """
    check_kind(text, str, "text", 'write values into it, as in f"at {pose}"')
    return str(text)[:_MOST_TEXT]


def _pose_of(value: AnyPose) -> Pose2D:
    """Return a pose; the yaw of a loop's own numbers may add up over many turns."""
    if isinstance(value, Pose2D) or not isinstance(value, Sequence | np.ndarray) or len(value) != 3:
        return Pose2D.of(cast("Any", value))
    x, y, yaw = cast("Sequence[float]", value)
    yaw = as_number(yaw, "yaw of a pose")
    return Pose2D(x, y, wrap_angle(yaw) if math.isfinite(yaw) else yaw)


def _by_robot(
    what: str, value: _Value | Mapping[str, _Value] | None, robots: Mapping[str, Pose2D]
) -> Mapping[str, _Value]:
    """Return what is given for each robot; a single value is that of the only robot."""
    if value is None:
        return {}
    if not isinstance(value, Mapping):
        if len(robots) > 1:
            raise InputError(f"there are several robots: give {what} as {{name: {what}}}, with the names of the poses")
        return {next(iter(robots)): value}
    given = cast("Mapping[str, _Value]", value)
    for name in given:
        if name not in robots:
            known = ", ".join(map(repr, robots)) if "" not in robots else "none, as pose is a single pose"
            raise InputError(f"{what} of {show_value(name)}, which is no robot of this update; its robots: {known}")
    return given


def _points_of(path: AnyPath) -> FloatArray:
    poses = path.poses if isinstance(path, Path) else as_array(path, np.float64, "path", copy=False)
    if poses.size == 0:
        return np.zeros((0, 2))
    if poses.ndim != 2 or poses.shape[1] not in (2, 3):
        raise InputError(f"path must be a Path, or an array of shape (N, 2) or (N, 3), got shape {poses.shape}")
    if len(poses) > MOST_POINTS:
        raise InputError(f"path has {len(poses)} points; give at most {MOST_POINTS}, such as every tenth")
    if not np.isfinite(poses).all():
        raise InputError("path must have finite numbers [m], in the map frame")
    return poses[:, :2].copy()
