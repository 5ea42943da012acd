"""Robots stepped and scanned a second by the batch core, and steps of the environments: `throughput.py [--threads N]`.

Figures are of CPU time with one thread, and of the clock with more.
"""

from __future__ import annotations

import argparse
import platform
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from trundle.costmap import Costmap
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.sim import BatchSimulator, MoverRecording
from trundle.worlds import World
from trundle.worlds.movers import Crowd

ROBOTS, PERIOD = 1024, 0.05


def processor() -> str:
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    return next((line.partition(": ")[2] for line in lines if line.startswith("model name")), platform.processor())


def clock(threads: int) -> float:
    return time.process_time() if threads == 1 else time.perf_counter()


def rate(work, count: int, threads: int) -> float:
    """Robots a second; the best of three."""
    best = 0.0
    for _ in range(3):
        started = clock(threads)
        for _ in range(count):
            work()
        best = max(best, count * ROBOTS / (clock(threads) - started))
    return best


def make_robot() -> Robot:
    robot = Robot.load("nova_carter")
    front = robot.lidars["front"].model_copy(update={"beams": 180, "range_max": 12.0, "noise": 0.0})
    return robot.model_copy(update={"lidars": {"front": front}})


def make_grid(robot: Robot, cells: float) -> OccupancyGrid:
    """A square of offices side by side with so many million cells."""
    office = OccupancyGrid.from_world(World.generate("office", seed=3), z_range=robot.z_range)
    edge = round((cells * 1e6) ** 0.5)
    tiles = [-(-edge // size) for size in office.shape]
    return OccupancyGrid(np.ascontiguousarray(np.tile(office.data, tiles)[:edge, :edge]), office.resolution)


def draw(grid: OccupancyGrid, robot: Robot, count: int, *, clear: bool) -> tuple[np.ndarray, np.ndarray]:
    """Poses and commands."""
    costmap = Costmap.from_grid(grid, robot)
    cells = np.argwhere(costmap.data == 0) if clear else np.argwhere(costmap.data < 128)
    rng = np.random.default_rng(0)
    x, y = costmap.cell_to_world(*cells[rng.choice(len(cells), count)].T)
    poses = np.column_stack([x, y, rng.uniform(-3.0, 3.0, count)])
    return poses, np.column_stack([rng.uniform(0.2, 0.6, count), rng.uniform(-1.0, 1.0, count)])


def core(threads: int, *, clear: bool) -> None:
    robot = make_robot()
    grid = make_grid(robot, 0.25)
    poses, commands = draw(grid, robot, ROBOTS, clear=clear)
    sim = BatchSimulator(grid, robot, count=ROBOTS, lidar=True, threads=threads)

    def drive() -> None:
        sim.reset(poses)
        for _ in range(10):
            sim.step(commands, PERIOD)

    where = "in open space" if clear else "near walls"
    print(
        f"{grid.data.size / 1e6:.2f} M cells, {where}: drive and contact {10 * rate(drive, 10, threads) / 1e6:.2f} M/s"
    )

    def both() -> None:
        sim.step(commands, PERIOD)
        sim.scan()

    sim.reset(poses)
    print(f"    with 180 beams to 12 m {rate(both, 5, threads) / 1e3:.1f} k/s")


def fill_office(robot: Robot, people: int) -> tuple[OccupancyGrid, list[tuple[bool, MoverRecording]]]:
    """Return the map of an office, and half a minute of its people: live, and recorded."""
    office = World.generate("office", seed=3)
    crowded = replace(office, movers=(Crowd("people", people),))
    kinds = [
        (live, MoverRecording.of_world(crowded, robot, duration_s=30.0, live_crowds=live)) for live in (True, False)
    ]
    return OccupancyGrid.from_world(office, z_range=robot.z_range), kinds


def crowds(threads: int, people: int) -> None:
    """Half a minute in an office among people that each robot has for itself, and among recorded ones."""
    robot, count = make_robot(), 64
    grid, recordings = fill_office(robot, people)
    poses, commands = draw(grid, robot, count, clear=True)
    for live, recording in recordings:
        sim = BatchSimulator(grid, robot, count=count, recordings=[recording], threads=threads)
        started = clock(threads)
        sim.reset(poses, recordings=0, seeds=np.arange(count))
        placed = clock(threads)
        for _ in range(600):
            sim.step(commands, PERIOD)
        print(
            f"{people} {'live' if live else 'recorded'} people, {grid.data.size / 1e6:.2f} M cells: "
            f"{count * 600 / (clock(threads) - placed) / 1e3:.1f} k/s, reset {(placed - started) / count * 1e3:.2f} ms"
        )


def gpu(device: str, count: int, cells: float) -> None:
    """Steps of 50 ms with commands that lie on the device; seconds of the clock until it is done."""
    import warp as wp

    robot = make_robot()
    grid = make_grid(robot, cells)
    poses, commands = draw(grid, robot, count, clear=False)
    sim = BatchSimulator(grid, robot, count=count, lidar=True, device=device)
    there = wp.array(commands, device=sim.poses.device)

    def measure(steps: int, *, scans: bool, drives: bool = True) -> float:
        best = 0.0
        for _ in range(4):
            sim.reset(poses)
            sim.synchronize()
            started = time.perf_counter()
            for _ in range(steps):
                if drives:
                    sim.step(there, PERIOD)
                if scans:
                    sim.scan()
            sim.synchronize()
            best = max(best, steps * count / (time.perf_counter() - started))
        return best

    print(
        f"{count:,} robots, {cells:g} M cells: drive and contact {measure(100, scans=False) / 1e6:.1f} M/s, 180 beams "
        f"{measure(100, scans=True, drives=False) / 1e6:.1f} M/s, both {measure(100, scans=True) / 1e6:.1f} M/s",
        flush=True,
    )


def gpu_crowds(device: str, count: int, people: int) -> None:
    """Half a minute in an office among people that each robot has for itself, and among recorded ones."""
    import warp as wp

    robot = make_robot()
    grid, recordings = fill_office(robot, people)
    poses, commands = draw(grid, robot, count, clear=True)
    for live, recording in recordings:
        sim = BatchSimulator(grid, robot, count=count, lidar=True, recordings=[recording], device=device)
        there = wp.array(commands, device=sim.poses.device)
        drives, resets = [], []
        for _ in range(3):
            started = time.perf_counter()
            sim.reset(poses, recordings=0, seeds=np.arange(count))
            sim.synchronize()
            placed = time.perf_counter()
            for _ in range(600):
                sim.step(there, PERIOD)
            sim.synchronize()
            drives.append(count * 600 / (time.perf_counter() - placed))
            resets.append((placed - started) / count)
        started = time.perf_counter()
        for _ in range(100):
            sim.step(there, PERIOD)
            sim.scan()
        sim.synchronize()
        both = count * 100 / (time.perf_counter() - started)
        print(
            f"{count:,} robots, {people} {'live' if live else 'recorded'} people each, {grid.data.size / 1e6:.2f} M "
            f"cells: {max(drives) / 1e6:.3f} M/s, with 180 beams {both / 1e6:.3f} M/s, "
            f"reset {min(resets) * 1e3:.3f} ms a robot",
            flush=True,
        )


def environments(threads: int) -> None:
    import gymnasium

    import trundle.gym  # noqa: F401 - registers

    for count, steps in ((1, 1500), (16, 600), (1024, 20)):
        env = gymnasium.make_vec("trundle/Navigation-v0", num_envs=count, world="office", worlds=1, threads=threads)
        env.reset(seed=0)
        actions = np.random.default_rng(0).uniform(0.0, 1.0, (steps, count, 2)).astype(np.float32)
        started = clock(threads)
        for action in actions:
            env.step(action)
        print(f"VectorEnv, N = {count}: {count * steps / (clock(threads) - started) / 1e3:.1f} k steps/s")
    one = gymnasium.make("trundle/Navigation-v0", world="office", worlds=1, threads=threads)
    one.reset(seed=0)
    actions = np.random.default_rng(0).uniform(0.0, 1.0, (1500, 2)).astype(np.float32)
    started = clock(threads)
    for action in actions:
        *_, terminated, truncated, _ = one.step(action)
        if terminated or truncated:
            one.reset()
    print(f"single environment: {len(actions) / (clock(threads) - started) / 1e3:.1f} k steps/s")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--no-gym", action="store_true", help="without the environments, which need the extra gym")
    parser.add_argument("--device", default="cpu", help="cuda: the rows of a GPU alone")
    parser.add_argument("--crowds", action="store_true", help="the rows of crowds alone")
    chosen = parser.parse_args()
    if chosen.device != "cpu":
        import warp as wp

        for cells in (0.25, 9.8) if not chosen.crowds else ():
            for count in (4096, 65536):
                gpu(chosen.device, count, cells)
        for count in (64, 4096, 16384):
            gpu_crowds(chosen.device, count, 8)
        print(wp.get_device(chosen.device).name)
        raise SystemExit
    print(f"{processor()}, {chosen.threads} thread{'s' * (chosen.threads > 1)}")
    for clear in (True, False) if not chosen.crowds else ():
        core(chosen.threads, clear=clear)
    crowds(chosen.threads, 8)
    if not (chosen.no_gym or chosen.crowds):
        environments(chosen.threads)
