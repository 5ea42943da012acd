"""The check that every layer of a costmap must pass."""

from __future__ import annotations

import itertools
import math
import warnings
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from trundle.costmap.layers import Layer, MapPart, MapWindow
from trundle.errors import InputError, SensorWarning
from trundle.geometry import Pose2D
from trundle.observation import Estimate, Scan
from trundle.robots import Robot
from trundle.testing.conformance import expect

_DT = 0.05
_TICKS = 12
_EDGE = 0.05
_SIDE = 160
_CORNER = Pose2D(-4.0, -4.0)
_VALUES = (-1, 0, 100)


def check_layer(make: Callable[[Robot], Layer], *, robot: Robot | None = None) -> None:
    """Check that a layer meets the contract of `trundle.costmap.layers.Layer`.

    It takes scans of a wall while the robot drives, and does not modify them. What it paints is unknown, free or
    occupied, changes only within the windows that it reports, and respects what is kept. Broken and late scans, and
    those of unknown lidars, raise nothing. A time that does not increase raises `InputError`. After a reset, and in
    another object, the same scans give the same cells; two objects share nothing.

    Args:
        make: Creates the layer for a robot.
        robot: A robot with a lidar; Nova Carter by default.

    Raises:
        ConformanceError: If a requirement is not met.
    """
    driven = Robot.load("nova_carter") if robot is None else robot
    expect(bool(driven.lidars), f"a layer is checked with a robot that has a lidar; {driven.name} has none")
    layer, other = make(driven), make(driven)
    expect(isinstance(layer, Layer), f"a layer needs reset, update, paint and obstacles; found: {type(layer).__name__}")
    before = _paint(other)
    first = _drive(layer, driven)
    expect(np.array_equal(_paint(other), before), "two layers must share nothing; one changed with the other")
    expect(np.array_equal(_drive(other, driven), first), "the same scans must give the same cells in two objects")
    _check_kept(layer)
    for _ in range(2):
        layer.reset()
        fresh = np.array_equal(_paint(layer), before)
        expect(fresh, "after a reset a layer must be as when it was new; found: other cells")
        expect(np.array_equal(_drive(layer, driven), first), "after a reset the same scans must give the same cells")
        _check_bad_input(layer, driven)


def _drive(layer: Layer, robot: Robot) -> npt.NDArray[np.int8]:
    """Let the robot drive towards a wall; return what the layer paints at the end."""
    painted = _paint(layer)
    for tick in range(_TICKS):
        pose = Pose2D(0.02 * tick, 0.0, 0.01 * tick)
        scan = _wall_scan(robot, _DT * tick, pose)
        angles, ranges = scan.angles.copy(), scan.ranges.copy()
        window = layer.update([scan], Estimate(_DT * tick, pose))
        same = np.array_equal(scan.angles, angles) and np.array_equal(scan.ranges, ranges, equal_nan=True)
        expect(same, "a layer must not modify scans; found: other ranges or angles")
        now = _paint(layer)
        _check_window(window, painted != now)
        painted = now
    points = np.asarray(layer.obstacles())
    expect(
        points.ndim == 2 and points.shape[1] == 2 and bool(np.isfinite(points).all()),
        f"obstacles must be finite points of shape (N, 2); found: shape {points.shape}",
    )
    return painted


def _check_window(window: MapWindow | None, changed: npt.NDArray[np.bool_]) -> None:
    rows, cols = np.nonzero(changed)
    if window is None:
        expect(not len(rows), f"an update that returns None must change nothing; found: {len(rows)} other cells")
        return
    low_x, low_y, high_x, high_y = window
    x, y = _CORNER.x + (cols + 0.5) * _EDGE, _CORNER.y + (rows + 0.5) * _EDGE
    outside = (x < low_x - _EDGE) | (x > high_x + _EDGE) | (y < low_y - _EDGE) | (y > high_y + _EDGE)
    expect(not outside.any(), f"what changes must lie within {window}; found: {int(outside.sum())} cells outside")


def _check_kept(layer: Layer) -> None:
    kept = np.ones((_SIDE, _SIDE), np.uint8)
    cells = _paint(layer, kept)
    expect(not (cells == 100).any(), "a layer must mark nothing where kept is not 0; found: occupied cells")


def _check_bad_input(layer: Layer, robot: Robot) -> None:
    time, pose = _DT * _TICKS, Pose2D(0.0, 0.0)
    name = next(iter(robot.lidars))
    bad = [
        _scan(robot, name, time, [math.nan, -math.inf, math.inf, 0.001, 99.0]),
        _scan(robot, name, time, []),
        _scan(robot, name, time - 100.0, [1.0] * 9),
        _scan(robot, name, time + 100.0, [1.0] * 9),
        _scan(robot, "a lidar that the robot lacks", time, [1.0] * 9),
    ]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SensorWarning)
        for tick, scan in itertools.chain(enumerate(bad), enumerate(bad, len(bad))):
            layer.update([scan], Estimate(time + 0.01 * tick, pose))
        layer.update([], Estimate(time + 1.0, Pose2D(5.0, 0.0)))
    for again in (time + 1.0, time):
        try:
            layer.update([], Estimate(again, pose))
        except InputError:
            continue
        expect(False, f"a time that does not increase must raise InputError; {again:g} s was accepted")


def _paint(layer: Layer, kept: npt.NDArray[np.uint8] | None = None) -> npt.NDArray[np.int8]:
    cells = np.full((_SIDE, _SIDE), -1, np.int8)
    nothing = np.zeros((_SIDE, _SIDE), np.uint8)
    layer.paint(MapPart(cells, nothing if kept is None else kept, _EDGE, _CORNER))
    found = np.setdiff1d(cells, _VALUES).tolist()
    expect(not found, f"a layer paints -1 (unknown), 0 (free) and 100 (occupied); found: {found}")
    return cells


def _wall_scan(robot: Robot, time: float, pose: Pose2D) -> Scan:
    """Return a wall at x = 2 m, as the first lidar sees it."""
    name = next(iter(robot.lidars))
    lidar = robot.lidars[name]
    sensor = pose @ Pose2D(lidar.x, lidar.y, lidar.yaw)
    ahead = np.cos(np.linspace(-math.pi, math.pi, 180, endpoint=False) + sensor.yaw)
    ranges = np.where(ahead > 0.1, (2.0 - sensor.x) / np.maximum(ahead, 0.1), math.inf)
    return _scan(robot, name, time, ranges.tolist())


def _scan(robot: Robot, name: str, time: float, ranges: list[float]) -> Scan:
    lidar = robot.lidars[name if name in robot.lidars else next(iter(robot.lidars))]
    angles = np.linspace(-math.pi, math.pi, len(ranges), endpoint=False)
    mount = Pose2D(lidar.x, lidar.y, lidar.yaw)
    return Scan(name, time, mount, lidar.z, angles, np.array(ranges), 0.05, 12.0)
