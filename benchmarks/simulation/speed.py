"""How fast MuJoCo and PhysX drive: alone, with a lidar, in a ROS map and in two made-up maps of 4000 × 4000 cells.

    python benchmarks/simulation/speed.py [--map MAP.yaml] [--out speed.md]

PhysX where ovphysx is installed, and also among movers.

Every case runs in a separate process, so that start time and peak memory are its own. Times are the processor's: on
a quiet core they are the wall's, and on a busy machine they are nearer to that than the wall's.
"""

from __future__ import annotations

import argparse
import importlib.util
import json
import platform
import resource
import subprocess
import sys
import time
from pathlib import Path

PERIOD = 0.05
SECONDS = 50.0
REPEATS = 5


def made_up_map(kind: str):
    """4000 × 4000 cells of 0.05 m: rooms of straight spent ("sparse"), or clutter on every square metre ("dense")."""
    import numpy as np

    from trundle.maps import OccupancyGrid

    cells = np.zeros((4000, 4000), dtype=np.int8)
    cells[[0, -1]], cells[:, [0, -1]] = 100, 100
    if kind == "sparse":
        cells[400::400, :] = 100
        cells[:, 400::400] = 100
        for start in range(180, 4000, 400):  # doors
            cells[:, start : start + 40] = np.where(
                cells[:, start : start + 40] == 100, 0, cells[:, start : start + 40]
            )
            cells[start : start + 40] = np.where(cells[start : start + 40] == 100, 0, cells[start : start + 40])
        cells[[0, -1]], cells[:, [0, -1]] = 100, 100
    else:
        rng = np.random.default_rng(0)
        for row, col in rng.integers(0, 3990, (40_000, 2)):
            cells[row : row + rng.integers(1, 8), col : col + rng.integers(1, 8)] = 100
    return OccupancyGrid(cells, 0.05)


def roomy_place(grid) -> tuple[float, float]:
    """The middle of some 2.6 × 2.6 m of free cells."""
    side = round(2.6 / grid.resolution)
    rows, cols = grid.shape
    for row in range(0, rows - side, 3):
        for col in range(0, cols - side, 3):
            if not grid.data[row : row + side, col : col + side].any():
                x, y = grid.cell_to_world(row + side // 2, col + side // 2)
                return float(x), float(y)
    raise SystemExit("no room for the robot to drive loops in this map")


def among_movers(world, x: float, y: float):
    """The world with four movers that walk around the place where the robot drives its loops."""
    from dataclasses import replace

    from trundle.geometry import Pose3D
    from trundle.geometry.solids import Cylinder, Solid
    from trundle.worlds.movers import AlongPath, Mover

    post = (Solid("post", Cylinder(0.2, 1.5), Pose3D((0.0, 0.0, 0.75))),)
    corners = [(x + dx, y + dy) for dx, dy in ((-2.5, -2.5), (2.5, -2.5), (2.5, 2.5), (-2.5, 2.5))]
    paths = [AlongPath((*corners[index:], *corners[:index]), 0.5, repeat="loop") for index in range(4)]
    movers = tuple(Mover(f"post {index}", post, path, may_cross=True) for index, path in enumerate(paths))
    return replace(world, movers=movers)


def run_case(case: str, lidar: bool, map_path: str, backend: str) -> dict[str, float]:
    begin = time.process_time()
    from trundle.geometry import Pose2D, Twist2D
    from trundle.maps import OccupancyGrid
    from trundle.robots import Robot
    from trundle.sim import simulate
    from trundle.worlds import World

    x, y = 0.0, 0.0
    if case == "empty":
        world = World("empty", ())
    elif case in ("warehouse", "movers"):
        world = World.generate("warehouse", seed=0)
        x, y = world.seeds[0]
        world = among_movers(world, x, y) if case == "movers" else world
    else:
        grid = OccupancyGrid.load(map_path) if case == "map" else made_up_map(case)
        x, y = roomy_place(grid)
        begin = time.process_time()  # making the map is not part of the start
        world = World.from_map(map_path if case == "map" else grid)
    robot = Robot.load("nova_carter")
    simulator = simulate(world, robot, backend=backend, lidar="front" if lidar else False)
    start = Pose2D(x, y)
    simulator.reset(start)
    again = time.process_time()
    simulator.reset(start)
    again = time.process_time() - again
    simulator.step(Twist2D(), PERIOD)
    started = time.process_time() - begin
    spent: list[float] = []
    touched = 0
    for _ in range(REPEATS):
        simulator.reset(start)
        before = time.process_time()
        for index in range(round(SECONDS / PERIOD)):
            # Small loops one way and the other, so that neither casters nor servos ever rest.
            turn = 0.6 if index // 200 % 2 == 0 else -0.6
            touched += bool(simulator.step(Twist2D(0.12, turn), PERIOD).contacts)
        spent.append(time.process_time() - before)
    spent.sort()
    return {
        "solids": len(world.solids),
        "reset_s": again,
        "start_s": started,
        "memory_mb": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
        "median": SECONDS / spent[len(spent) // 2],
        "best": SECONDS / spent[0],
        "steps": SECONDS / 0.005 / spent[0],
        "touched": touched,
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--map", default="", help="a ROS map YAML to drive in as well")
    parser.add_argument("--out", type=Path, help="write the table here as well")
    parser.add_argument("--case", help=argparse.SUPPRESS)
    parser.add_argument("--lidar", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--backend", default="mujoco", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.case:
        sys.stdout.write(json.dumps(run_case(options.case, options.lidar, options.map, options.backend)))
        return
    lines = [
        "# Speed of the simulators",
        "",
        f"Nova Carter driving loops for {SECONDS:g} s, {REPEATS} times; 5 ms steps, {platform.machine()}, "
        "one thread. Real-time factor: simulated over processor time, with contacts read at every step. Lidar: 720 "
        "beams of 12 m at 20 Hz. Movers: four posts that walk around the robot in the warehouse.",
        "",
        "| simulator | world | solids | lidar | start [s] | reset [s] | peak [MB] | real-time factor, median | best | "
        "steps/s, best |",
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |",
    ]
    names = {"map": Path(options.map).stem, "sparse": "4000 × 4000, rooms", "dense": "4000 × 4000, clutter"}
    names["movers"] = "warehouse, four movers"
    maps = ["map"] if options.map else []
    runs = [
        ("mujoco", case, lidar) for case in ("empty", "warehouse", *maps, "sparse", "dense") for lidar in (False, True)
    ]
    runs += [("mujoco", "movers", False)]
    if importlib.util.find_spec("ovphysx") is not None:
        runs += [("physx", case, lidar) for case in ("empty", "warehouse", *maps) for lidar in (False, True)]
        runs += [("physx", "movers", False)]
    for backend, case, lidar in runs:
        command = [sys.executable, __file__, "--case", case, "--map", options.map, "--backend", backend]
        output = subprocess.run(
            [*command, *(["--lidar"] if lidar else [])], check=True, capture_output=True, text=True
        ).stdout
        got = json.loads(output)
        if got["touched"]:
            raise SystemExit(f"{case}: the robot touched something, so this measures another thing")
        lines.append(
            f"| {backend} | {names.get(case, case)} | {got['solids']} | {'yes' if lidar else 'no'} | "
            f"{got['start_s']:.2f} | {got['reset_s']:.4f} | {got['memory_mb']:.0f} | {got['median']:.0f} | "
            f"{got['best']:.1f} | {got['steps']:,.0f} |"
        )
        sys.stderr.write(lines[-1] + "\n")
    text = "\n".join(lines) + "\n"
    sys.stdout.write(text)
    if options.out:
        options.out.write_text(text)


if __name__ == "__main__":
    main()
