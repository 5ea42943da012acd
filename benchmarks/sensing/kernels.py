"""Scans into a costmap: CPU time of a call, median and 99th percentile.

    python -m benchmarks.sensing.kernels [--ticks 200]

One lidar of 720 beams that reaches 12 m, 1 cm noise, cells of 5 cm, Nova Carter's footprint. `mark_scan` is the kernel
alone; `LayeredCostmap.update` is everything from the scan to an immutable costmap with inflation.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable, Iterator

import numpy as np
from benchmarks.timing import describe_machine, print_table

from trundle import _core
from trundle.costmap import Costmap, LayeredCostmap, LayersSettings, ObstacleLayerSettings
from trundle.geometry import FloatArray, Pose2D
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate, Scan
from trundle.robots import Robot

BEAMS, REACH, EDGE, NOISE = 720, 12.0, 0.05, 0.01
ANGLES = np.linspace(-math.pi, math.pi, BEAMS, endpoint=False)
ROBOT = Robot.load("nova_carter")
SETTINGS = ObstacleLayerSettings(obstacle_max_range=REACH, raytrace_max_range=REACH)


def room(rng: np.random.Generator, half: float, centre: Pose2D) -> FloatArray:
    """Ranges in a square room of ±`half` [m] around (0, 0); infinity beyond the lidar's reach."""
    cos, sin = np.cos(ANGLES + centre.yaw), np.sin(ANGLES + centre.yaw)
    with np.errstate(divide="ignore"):
        x = np.where(cos > 0, half - centre.x, half + centre.x) / np.abs(cos)
        y = np.where(sin > 0, half - centre.y, half + centre.y) / np.abs(sin)
    ranges = np.minimum(x, y)
    return np.where(ranges <= REACH, ranges + rng.normal(0.0, NOISE, BEAMS), math.inf)


def sparse(rng: np.random.Generator, half: float, centre: Pose2D) -> FloatArray:
    """Ranges of things all around at every distance, and of nothing for a third of the beams."""
    ranges = np.random.default_rng(3).uniform(0.5, REACH, BEAMS).repeat(12)[:BEAMS]
    far = np.random.default_rng(4).random(BEAMS // 12).repeat(12) < 0.33
    return np.where(far, math.inf, np.minimum(ranges + rng.normal(0.0, NOISE, BEAMS), REACH))


def kernel_times(ticks: int, ranges_of: Callable[..., FloatArray], half: float) -> list[float]:
    """Of `mark_scan` on a grid of 60 x 60 m while the sensor moves at 1 m/s, 20 scans a second."""
    side, rng = round(60.0 / EDGE), np.random.default_rng(0)
    evidence, points = np.zeros((side, side), np.uint8), np.zeros((side, side, 2), np.uint8)
    limits = np.array([0.05, REACH, 0.0, REACH, 0.0, REACH])
    times: list[float] = []
    for tick in range(ticks):
        pose = Pose2D(-0.05 * tick % 4.0, 0.02 * tick % 4.0, 0.01 * tick)
        ranges = ranges_of(rng, half, pose)
        arguments = np.array([pose.as_tuple()]), ANGLES, ranges, np.zeros((0, 2)), limits, True, 5, 2, 0.0
        begin = time.process_time()
        _core.mark_scan(evidence, points, np.zeros((0, 0)), -side // 2, -side // 2, EDGE, *arguments)
        times.append(time.process_time() - begin)
    return times


def drives(ticks: int, ranges_of: Callable[..., FloatArray], half: float) -> Iterator[tuple[Scan, Estimate]]:
    """Scans and estimates of a drive at 1 m/s, to and fro over 4 m."""
    rng = np.random.default_rng(0)
    for tick in range(ticks):
        pose = Pose2D(abs(0.05 * tick % 8.0 - 4.0) - 2.0, 0.5, 0.2)
        ranges = ranges_of(rng, half, pose)
        yield (
            Scan("front", 0.05 * tick, Pose2D(0.0, 0.0), 0.4, ANGLES, ranges, 0.05, REACH),
            Estimate(0.05 * tick, pose),
        )


def update_times(layered: LayeredCostmap, steps: Iterator[tuple[Scan, Estimate]]) -> list[float]:
    """Of `LayeredCostmap.update`; the first 20, which make the costmap, are left out."""
    times: list[float] = []
    for scan, estimate in steps:
        begin = time.process_time()
        layered.update([scan], estimate)
        times.append(time.process_time() - begin)
    return times[20:]


def change_times(ticks: int) -> list[float]:
    """Of a change of 12 x 12 m in a costmap of 60 x 60 m, `Costmap.update` alone."""
    costmap = Costmap.from_grid(empty_map(60.0), ROBOT)
    rng, times = np.random.default_rng(0), list[float]()
    for _ in range(ticks):
        cells = np.where(rng.random((240, 240)) < 0.02, np.int8(100), np.int8(0))
        begin = time.process_time()
        costmap = costmap.update(slice(480, 720), slice(480, 720), cells)
        times.append(time.process_time() - begin)
    return times


def empty_map(side: float) -> OccupancyGrid:
    count = round(side / EDGE)
    return OccupancyGrid(np.zeros((count, count), np.int8), EDGE, Pose2D(-side / 2.0, -side / 2.0))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--ticks", type=int, default=200, help="calls of each kind")
    ticks = parser.parse_args().ticks
    window = LayersSettings(obstacle=SETTINGS, rolling_window=True, width=12.0, height=12.0)
    whole = LayersSettings(obstacle=SETTINGS)
    near = LayersSettings(obstacle=ObstacleLayerSettings(obstacle_max_range=6.0, raytrace_max_range=6.0))
    kinds: list[tuple[str, str, Callable[[], list[float]]]] = [
        ("mark and clear, room of 16 m", "0.3", lambda: kernel_times(ticks, room, 8.0)),
        ("mark and clear, things at 0.5 to 12 m", "0.3", lambda: kernel_times(ticks, sparse, 8.0)),
        ("mark and clear, nothing in reach", "0.3", lambda: kernel_times(ticks, room, 1000.0)),
    ]
    for what, aim, static, settings in (
        ("12 m window, no map", "0.5", None, window),
        ("12 m window, map of 60 m", "0.5", empty_map(60.0), window),
        ("map of 60 m, scans of 12 x 12 m", "1", empty_map(60.0), near),
        ("map of 60 m, scans of 24 x 24 m", "", empty_map(60.0), whole),
    ):
        for name, half, ranges_of in (("room", 5.5, room), ("things", 5.5, sparse)):
            kinds.append(
                (
                    f"update, {what}, {name}",
                    aim,
                    lambda static=static, settings=settings, half=half, ranges_of=ranges_of: update_times(
                        LayeredCostmap(static, ROBOT, layers=settings), drives(ticks, ranges_of, half)
                    ),
                )
            )
    kinds.append(("Costmap.update of 12 x 12 m in 60 x 60 m", "1", lambda: change_times(ticks)))
    rows: list[tuple[str, ...]] = []
    for what, aim, measure in kinds:
        found = 1e3 * np.array(measure())
        rows.append((what, aim, f"{np.median(found):.2f}", f"{np.percentile(found, 99):.2f}"))
    print(describe_machine() + "\n")
    print_table(("what", "aim [ms]", "median [ms]", "p99 [ms]"), rows)


if __name__ == "__main__":
    main()
