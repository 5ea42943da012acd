"""Mapping trundle's worlds: errors of the path, and of the map against the world's solids.

python -m benchmarks.mapping.worlds [--worlds warehouse office] [--seeds 1 2] [--seconds 300] [--people 6]
[--backend mujoco]

Drives from goal to goal with the true pose, both lidars at 10 Hz with 2 cm of noise, 1 % of the beams without
a return and 1 % cut short; the odometry is 5 % and 5 degrees per metre off. The map is scored where lidars measure: how
much of what is occupied lies within 0.10 m of a solid, and how much of the surface that beams met within 0.10 m of an
occupied cell. As for the path, the map is first put onto the world by one rigid motion, which is printed: a small
error of the first yaw is no error of the map. Times are CPU time of the mapper alone, and MB what its process holds
more at the end than before the first scan: the simulator and what drives are in another process.
"""

from __future__ import annotations

import argparse
import math
import multiprocessing
import resource
import time
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np
from benchmarks.localization.conditions import spoil_scan
from benchmarks.localization.drives import load_robot
from benchmarks.mapping.slam import align, aligned_error
from scipy import ndimage

import trundle
from trundle import Mapper, Navigator, Observation, OccupancyGrid, Pose2D, Robot, World, draw_map, sample_mission
from trundle.mapping.merging import move_pose_graph
from trundle.navigation.state import NavigationStatus
from trundle.worlds.movers import Crowd

_Item = TypeVar("_Item")

FINE_M = 0.02
WITHIN_M = 0.10
SIDE = 1 << 16  # of a world, in cells


def drive(world: World, robot: Robot, seed: int, seconds: float, backend: str) -> Iterator[tuple[Pose2D, Observation]]:
    """Drive from goal to goal; yield where the robot truly is and what it observes."""
    grid = OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)
    navigator = Navigator(grid, robot)
    start, _ = sample_mission(navigator.costmap, seed=seed)
    draw = np.random.default_rng(seed)
    scale, heading = 1.0 + 0.05 * draw.choice((-1.0, 1.0)), math.radians(5.0) * draw.choice((-1.0, 1.0))
    odometry = Pose2D(0.0, 0.0)
    with trundle.simulate(world, robot, backend=backend, lidar=True) as sim:
        state = sim.reset(start, seed=seed)
        last = state.pose
        while state.time < seconds:
            step, last = last.inverse() @ state.pose, state.pose
            turn = step.yaw + heading * math.hypot(step.x, step.y)
            odometry = odometry @ Pose2D(step.x * scale, step.y * scale, turn)
            scans = tuple(spoil_scan(scan, draw) for scan in state.scans)
            yield state.pose, Observation(state.time, state.twist, odometry, scans)
            if navigator.status not in (NavigationStatus.DRIVING, NavigationStatus.BLOCKED):
                _, goal = sample_mission(navigator.costmap, seed=int(draw.integers(1 << 31)))
                navigator.set_goal(goal)
            state = sim.step(navigator.update(state.pose, state.twist, time=state.time), navigator.dt)


def in_another_process(made: Iterator[_Item]) -> Iterator[_Item]:
    """Yield what an iterator yields in another process, whose memory and time do not count here."""
    context = multiprocessing.get_context("fork")
    ours, theirs = context.Pipe(duplex=False)

    def send() -> None:
        for item in made:
            theirs.send(item)
        theirs.send(None)

    process = context.Process(target=send, daemon=True)
    process.start()
    while (item := ours.recv()) is not None:
        yield item
    process.join()


def score_map(world: World, found: OccupancyGrid, seen: np.ndarray, height: float) -> tuple[float, float]:
    """Shares: of occupied cells near a solid's surface, and of the surface that was seen near an occupied cell."""
    low = (
        math.floor(min(seen[:, 0].min(), found.origin.x)) - 1.0,
        math.floor(min(seen[:, 1].min(), found.origin.y)) - 1.0,
    )
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
    met = surface & (ndimage.uniform_filter(hits.astype(np.float32), 5) * 25 >= 1.9)
    recall = float((ndimage.distance_transform_edt(mapped)[met] * FINE_M <= WITHIN_M).mean())
    return precision, recall


def memory_mb() -> float:
    """What the process holds now [MB]."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize() / 2**20


def run(world: World, robot: Robot, seed: int, options: argparse.Namespace, name: str) -> str:
    """Map while driving; return a row of the table."""
    mapper, anchors, truth, online = Mapper(robot), [], [], []
    met: list[np.ndarray] = []  # cells of 2 cm where beams ended, one number each
    took, held = 0.0, 0.0
    for pose, observation in in_another_process(drive(world, robot, seed, options.seconds, options.backend)):
        if not anchors and observation.scans:
            mapper.reset(pose)
            held = memory_mb()
        began = time.process_time()
        estimate = mapper.update(observation)
        took += time.process_time() - began
        if mapper.anchor is None or not observation.scans:
            continue
        online.append(estimate.pose.distance_to(pose))
        anchors.append(mapper.anchor)
        truth.append(pose.as_tuple())
        if len(truth) % 3 == 0:
            points = np.concatenate([scan.points()[::3] for scan in observation.scans])
            cos, sin = math.cos(pose.yaw), math.sin(pose.yaw)
            ends = points @ np.array(((cos, sin), (-sin, cos))) + (pose.x, pose.y)
            met.append(np.unique(np.floor(ends / FINE_M).astype(np.int32) @ (SIDE, 1)))
    began = time.process_time()
    mapper.finish()
    took += time.process_time() - began
    # The graph and the maps below are copies, and what was met is not the mapper's.
    grown = memory_mb() - held - sum(cells.nbytes for cells in met) / 2**20
    graph = mapper.graph()
    began = time.process_time()
    draw_map(graph)
    drawn = time.process_time() - began
    path = np.array([(Pose2D(*graph.poses[node]) @ at).as_tuple() for node, at in anchors])
    ate, onto = aligned_error(path, np.array(truth)), align(path, np.array(truth))
    grid = draw_map(move_pose_graph(graph, onto))
    if options.picture:
        options.picture.mkdir(parents=True, exist_ok=True)
        (options.picture / f"{name}.png").write_bytes(grid._repr_png_())
    found, times = np.unique(np.concatenate(met), return_counts=True)
    often = found[times >= 2]
    rows = (often + SIDE // 2) // SIDE
    shown = (np.column_stack((rows, often - rows * SIDE)) + 0.5) * FINE_M
    precision, recall = score_map(world, grid, shown, robot.lidars["front"].z)
    length = float(np.hypot(*np.diff(np.array(truth)[:, :2], axis=0).T).sum())
    return (
        f"{name:26} {length:7.0f} {ate:6.3f} {np.percentile(online, 95):9.3f} {100 * precision:10.1f} "
        f"{100 * recall:7.1f} {options.seconds / took:7.0f} {drawn:7.1f} {len(graph.times):6} "
        f"{len(graph.scan_nodes):6} {grown:6.0f}  {math.hypot(onto.x, onto.y):.3f} m, {math.degrees(onto.yaw):.2f}°"
    )


def main() -> None:
    """Run the worlds that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--worlds", nargs="*", default=["warehouse", "office"])
    parser.add_argument("--seeds", nargs="*", type=int, default=[1, 2])
    parser.add_argument("--seconds", type=float, default=300.0)
    parser.add_argument("--backend", default="kinematic")
    parser.add_argument("--people", type=int, default=0)
    parser.add_argument("--size", nargs=2, type=float, help="of the world [m]")
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    header = (
        "world                      metres    ATE  online95  near wall  mapped  x real  draw s  nodes  scans     MB"
    )
    print(f"{header}  moved by")
    robot = load_robot()
    for name in options.worlds:
        for seed in options.seeds:
            extra = {} if options.size is None else {"size": tuple(options.size)}
            world = World.generate(name, seed=seed, **extra)
            if options.people:
                world = replace(world, movers=(*world.movers, Crowd("people", options.people)))
            label = f"{name} {seed}" + (f", {options.people} people" if options.people else "")
            print(run(world, robot, seed, options, label), flush=True)


if __name__ == "__main__":
    main()
