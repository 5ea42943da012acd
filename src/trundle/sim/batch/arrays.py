"""What the batch kernel is made of: maps, robot, lidars and recordings as arrays."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple, TypeVar

import numpy as np
import numpy.typing as npt

from trundle._core import chebyshev_field
from trundle.errors import InputError
from trundle.geometry import FloatArray
from trundle.maps import OccupancyGrid
from trundle.maps.cells import OCCUPIED, UNKNOWN
from trundle.robots import Lidar, Robot
from trundle.sim.batch.recording import MoverRecording
from trundle.sim.lidar import beam_angles
from trundle.values import as_array, show_value

_Item = TypeVar("_Item", bound=np.generic)


def check_maps(maps: Sequence[OccupancyGrid], robot: Robot) -> None:
    """Check that a batch can use these maps.

    Raises:
        InputError: If there are none, one is no map, their resolutions differ, or the robot is larger than one of them.
    """
    if not maps:
        raise InputError("a batch needs at least one map")
    for number, grid in enumerate(maps):
        if not isinstance(grid, OccupancyGrid):
            raise InputError(
                f"map {number} must be an OccupancyGrid, got {type(grid).__name__}; OccupancyGrid.from_world(world, "
                "z_range=robot.z_range) makes one of a world"
            )
        if not math.isclose(grid.resolution, maps[0].resolution, rel_tol=1e-9):
            raise InputError(
                f"map {number} has cells of {grid.resolution:g} m, map 0 of {maps[0].resolution:g} m: all maps of a "
                "batch need one resolution; make or resample them with the same one"
            )
        room, swing = min(grid.shape) * grid.resolution, 2.0 * robot.planar.circumscribed_radius
        if swing > room:
            raise InputError(
                f"map {number} is {room:g} m wide, and {robot.name} needs {swing:.3g} m to turn: the robot is larger "
                "than the map; check the map's resolution"
            )


class BatchModel(NamedTuple):
    """What the robots of a batch share, as the kernel's `Batch` takes it.

    Attributes:
        fields: Chebyshev distances to blocked cells, one map after the other, uint8.
        shapes: Rows and columns of the maps, shape (M, 2).
        frames: (x, y, yaw) of the maps [m, rad], shape (M, 3).
        resolution: Edge of a cell [m].
        outline: Outline of the footprint [m], base_link, counter-clockwise, shape (K, 2).
        limits: Speeds forwards, backwards and of turning, their largest changes in a substep, radius of the wheels,
            track, largest speed of a wheel, and length of a substep, shape (9,).
        lidars: (x, y, yaw, range_min, range_max) [m, rad], base_link, shape (L, 5).
        beams: Beams of each lidar.
        angles: Angles of the beams [rad], one lidar after the other.
        corners: Corners of the movers that are polygons [m], shape (C, 2).
        corner_counts: Number of corners of each mover, 0 for a disc.
        radii: Radii of the movers that are discs [m].
        tracks: (x, y, yaw) of the movers [m, rad], shape (movers, samples, 3).
        recordings: Where in these the movers of each recording begin, and the end of the last one.
        period: Time between two samples [s].
    """

    fields: npt.NDArray[np.uint8]
    shapes: npt.NDArray[np.int64]
    frames: FloatArray
    resolution: float
    outline: FloatArray
    limits: FloatArray
    lidars: FloatArray
    beams: npt.NDArray[np.int64]
    angles: FloatArray
    corners: FloatArray
    corner_counts: npt.NDArray[np.int64]
    radii: FloatArray
    tracks: FloatArray
    recordings: npt.NDArray[np.int64]
    period: float


def make_model(
    maps: Sequence[OccupancyGrid],
    blocked: Sequence[npt.NDArray[np.bool_]],
    robot: Robot,
    lidars: Sequence[Lidar],
    recordings: Sequence[MoverRecording],
    timestep: float,
) -> BatchModel:
    """Make the kernel's model of checked arguments."""
    fields = [chebyshev_field(cells.view(np.uint8)) for cells in blocked]
    limits, drive = robot.limits, robot.drive
    angles = [beam_angles(lidar) for lidar in lidars]
    shapes = [outline for recording in recordings for outline in recording.outlines]
    polygons = [np.zeros((0, 2)) if isinstance(shape, float) else np.asarray(shape, dtype=float) for shape in shapes]
    samples = {recording.tracks.shape[1:] for recording in recordings}
    tracks = np.concatenate([recording.tracks for recording in recordings]) if samples else np.zeros((0, 1, 3))
    ends = np.cumsum([0, *(len(recording.outlines) for recording in recordings)])
    return BatchModel(
        np.concatenate([field.ravel() for field in fields]),
        np.array([field.shape for field in fields], dtype=np.int64),
        np.array([grid.origin.as_tuple() for grid in maps]),
        maps[0].resolution,
        np.ascontiguousarray(robot.planar.outline),
        np.array(
            [
                limits.linear_speed,
                limits.linear_speed if limits.reverse_speed is None else limits.reverse_speed,
                limits.angular_speed,
                limits.linear_acceleration * timestep,
                limits.angular_acceleration * timestep,
                drive.wheel_radius,
                drive.track_width,
                math.inf if drive.max_wheel_speed is None else drive.max_wheel_speed,
                timestep,
            ]
        ),
        np.array([(each.x, each.y, each.yaw, each.range_min, each.range_max) for each in lidars]).reshape(-1, 5),
        np.array([each.beams for each in lidars], dtype=np.int64),
        np.concatenate([np.zeros(0), *angles]),
        np.concatenate([np.zeros((0, 2)), *polygons]),
        np.array([len(polygon) for polygon in polygons], dtype=np.int64),
        np.array([shape if isinstance(shape, float) else 0.0 for shape in shapes]),
        tracks,
        ends.astype(np.int64),
        recordings[0].period if recordings else 1.0,
    )


def check_recordings(recordings: Sequence[MoverRecording]) -> None:
    """Check that a batch can use these recordings.

    Raises:
        InputError: If they are no list, one is none, or they have different periods or numbers of samples.
    """
    if not isinstance(recordings, Sequence):
        raise InputError(f"recordings must be a list of MoverRecordings, got {type(recordings).__name__}")
    for number, recording in enumerate(recordings):
        if not isinstance(recording, MoverRecording):
            raise InputError(f"recording {number} must be a MoverRecording, got {type(recording).__name__}")
        first = recordings[0]
        if recording.period != first.period or recording.tracks.shape[1] != first.tracks.shape[1]:
            raise InputError(
                f"recording {number} has {recording.tracks.shape[1]} samples of {recording.period:g} s, recording 0 "
                f"{first.tracks.shape[1]} of {first.period:g} s: those of a batch must be alike"
            )


def spread(values: object, kind: type[_Item], shape: tuple[int, ...], what: str) -> npt.NDArray[_Item]:
    """Return values as an array with a row for each robot; one row may be given for all of them.

    Args:
        values: Numbers, of this shape or of that of one row.
        kind: Their type. Integers are not rounded.
        shape: Rows first.
        what: Their name in messages.

    Raises:
        InputError: If they have another shape, or are no numbers of this type.
    """
    array = as_array(values, kind, what) if issubclass(kind, np.floating) else _as_integers(values, kind, what)
    if array.shape == shape:
        return array
    if array.shape != shape[1:]:
        row = f"shape {shape[1:]}" if shape[1:] else "one number"
        raise InputError(f"{what} need shape {shape}, or {row} for all, got {array.shape}")
    return np.full(shape, array, dtype=kind)  # np.broadcast_to takes twice as long


def _as_integers(values: object, kind: type[_Item], what: str) -> npt.NDArray[_Item]:
    given = as_array(values, np.object_, what) if isinstance(values, list | tuple) else np.asarray(values)
    if given.dtype == kind:
        return np.array(given, dtype=kind, order="C")
    with np.errstate(invalid="ignore"):  # NaN
        array = as_array(given, kind, what)
    if given.dtype == np.bool_ or not np.all(array == given):
        raise InputError(f"{what} must be integers ({np.dtype(kind).name}), got {show_value(values)}")
    return array


def blocked_cells(grid: OccupancyGrid, *, unknown_is_solid: bool) -> npt.NDArray[np.bool_]:
    """Return cells that are walls: as in a costmap, only 100 is occupied and 1 to 99 are free."""
    blocked = grid.data == OCCUPIED
    return blocked | (grid.data == UNKNOWN) if unknown_is_solid else blocked
