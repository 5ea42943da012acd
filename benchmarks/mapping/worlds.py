"""Mapping trundle's worlds: errors of the path, and of the map against the world's solids.

python -m benchmarks.mapping.worlds [--worlds warehouse office] [--seeds 1 2] [--seconds 300] [--people 6]

Kinematic drives from goal to goal with the true pose, both lidars at 10 Hz with 2 cm of noise, 1 % of the beams without
a return and 1 % cut short; the odometry is 5 % and 5 degrees per metre off. The map is scored where lidars measure: how
much of what is occupied lies within 0.10 m of a solid, and how much of the surface that beams met within 0.10 m of an
occupied cell. Times are CPU time of the mapper alone.
"""

from __future__ import annotations

import argparse
import math
import resource
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
from benchmarks.localization.conditions import Condition, observe
from benchmarks.localization.drives import Drive, Moment, load_robot
from benchmarks.mapping.slam import aligned_error
from scipy import ndimage

from trundle import Mapper, Navigator, OccupancyGrid, Pose2D, World, draw_map, sample_mission
from trundle.navigation.status import NavigationStatus
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds.movers import Crowd

FINE_M = 0.02
WITHIN_M = 0.10


def record(name: str, seed: int, seconds: float, people: int, options: dict[str, object]) -> tuple[World, Drive]:
    """Drive from goal to goal in a generated world."""
    robot = load_robot()
    world = World.generate(name, seed=seed, **options)
    if people:
        world = replace(world, movers=(Crowd("people", people, seed=seed),))
    grid = OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)
    navigator = Navigator(grid, robot)
    start, _ = sample_mission(navigator.costmap, seed=seed)
    draw, moments = np.random.default_rng(seed), []
    with KinematicSimulator(world, robot, lidar=True) as sim:
        state = sim.reset(start, seed=seed)
        while state.time < seconds:
            scans = tuple(replace(scan, ranges=scan.ranges.astype(np.float32)) for scan in state.scans)
            moments.append(Moment(state.time, state.pose, state.twist, scans))
            if navigator.status not in (NavigationStatus.DRIVING, NavigationStatus.BLOCKED):
                _, goal = sample_mission(navigator.costmap, seed=int(draw.integers(1 << 31)))
                navigator.set_goal(goal)
            command = navigator.update(state.pose, state.twist, time=state.time)
            state = sim.step(command, navigator.dt)
    return world, Drive(f"{name} {seed}", grid, robot, tuple(moments))


def score_map(world: World, found: OccupancyGrid, seen: np.ndarray, height: float) -> tuple[float, float]:
    """Shares: of occupied cells near a solid's surface, and of the surface that was seen near an occupied cell."""
    low = (math.floor(min(seen[:, 0].min(), found.origin.x)) - 1.0, math.floor(min(seen[:, 1].min(), found.origin.y)) - 1.0)
    rows, cols = found.shape
    high = (
        max(seen[:, 0].max(), found.origin.x + cols * found.resolution) + 1.0,
        max(seen[:, 1].max(), found.origin.y + rows * found.resolution) + 1.0,
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        truth = OccupancyGrid.from_world(
            world, resolution=FINE_M, z_range=(height - 0.001, height + 0.001), bounds=(low, high), seeds=()
        )
    solid = truth.data >= 65
    surface = solid & ~ndimage.binary_erosion(solid, np.ones((3, 3)))
    x0, y0 = truth.origin.x, truth.origin.y

    def cells(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        col, row = ((points - (x0, y0)) / FINE_M).astype(int).T
        good = (row >= 0) & (col >= 0) & (row < solid.shape[0]) & (col < solid.shape[1])
        return row[good], col[good]

    far = ndimage.distance_transform_edt(~surface) * FINE_M
    at = np.argwhere(found.data >= 65)[:, ::-1]
    marked = (at + 0.5) * found.resolution + (found.origin.x, found.origin.y)
    precision = float((far[cells(marked)] <= WITHIN_M).mean())
    mapped = np.ones_like(solid)
    mapped[cells(marked)] = False
    hits = np.zeros(solid.shape, dtype=np.int32)
    np.add.at(hits, cells(seen), 1)
    met = surface & (ndimage.uniform_filter(hits.astype(np.float32), 5) * 25 >= 3.0)
    recall = float((ndimage.distance_transform_edt(mapped)[met] * FINE_M <= WITHIN_M).mean())
    return precision, recall


def run(world: World, drive: Drive, seed: int, picture: Path | None, name: str) -> str:
    """Map a drive; return a row of the table."""
    rng = np.random.default_rng(seed)
    mapper, anchors, truth, seen, online = Mapper(drive.robot), [], [], [], []
    mapper.reset(drive.moments[0].pose)
    took = 0.0
    for moment, observation in observe(drive, Condition("", 0.05, 5.0), rng):
        began = time.process_time()
        estimate = mapper.update(observation)
        took += time.process_time() - began
        online.append(estimate.pose.distance_to(moment.pose))
        for scan in moment.scans:
            points = scan.points()[::4]
            cos, sin = math.cos(moment.pose.yaw), math.sin(moment.pose.yaw)
            seen.append(points @ np.array(((cos, sin), (-sin, cos))) + (moment.pose.x, moment.pose.y))
        if mapper.anchor is not None and moment.scans:
            anchors.append(mapper.anchor)
            truth.append(moment.pose.as_tuple())
    began = time.process_time()
    mapper.finish()
    took += time.process_time() - began
    graph = mapper.graph()
    began = time.process_time()
    grid = draw_map(graph)
    drawn = time.process_time() - began
    path = np.array([(Pose2D(*graph.poses[node]) @ at).as_tuple() for node, at in anchors])
    ate = aligned_error(path, np.array(truth))
    shown = np.concatenate(seen)
    precision, recall = score_map(world, grid, shown, drive.robot.lidars["front"].z)
    if picture:
        picture.mkdir(parents=True, exist_ok=True)
        (picture / f"{name}.png").write_bytes(grid._repr_png_())
    length = float(np.hypot(*np.diff(np.array(truth)[:, :2], axis=0).T).sum())
    seconds = drive.moments[-1].time
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return (
        f"{name:26} {length:7.0f} {ate:6.3f} {np.percentile(online, 95):7.3f} {100 * precision:9.1f} {100 * recall:7.1f} "
        f"{seconds / took:8.0f} {drawn:6.1f} {len(graph.times):6} {len(graph.scan_nodes):6} {peak:6.0f}"
    )


def main() -> None:
    """Run the worlds that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--worlds", nargs="*", default=["warehouse", "office"])
    parser.add_argument("--seeds", nargs="*", type=int, default=[1, 2])
    parser.add_argument("--seconds", type=float, default=300.0)
    parser.add_argument("--people", type=int, default=0)
    parser.add_argument("--size", nargs=2, type=float, help="of the world [m]")
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    print("world                      metres    ATE online95  near wall  mapped  x real  draw s  nodes  scans  peak MB")
    for name in options.worlds:
        for seed in options.seeds:
            size = {} if options.size is None else {"size": tuple(options.size)}
            world, drive = record(name, seed, options.seconds, options.people, size)
            label = f"{name} {seed}" + (f", {options.people} people" if options.people else "")
            print(run(world, drive, seed, options.picture, label), flush=True)


if __name__ == "__main__":
    main()
