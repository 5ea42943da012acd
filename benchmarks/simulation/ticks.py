"""CPU time of a control tick, part by part: simulator, costmap, tracker and collision monitor, with two lidars.

    python -m benchmarks.simulation.ticks [--map MAP.yaml] [--before CHECKOUT] [--rounds 5] [--seconds 20]

Nova Carter drives to a sampled goal in the generated warehouse, in the generated office, or on a map; once as boxes
and once as a field of cells. Of each control period the least time of all rounds counts, and of these the median: what
other programs take is left out. With `--before`, another checkout, which has its kernels beside its sources, takes
turns with this one, process by process, and the last column says whether both have driven, seen and decided the same,
bit for bit.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

PERIOD_S = 0.05
PARTS = ("step", "sensed step", "costmap", "tracker", "navigator", "monitor", "sensed tick")
AIMS = {"step": "0.012", "sensed step": "0.1", "sensed tick": "0.8"}


def worlds(path: str | None) -> Iterator[tuple[str, Any, Any]]:
    """Name, world and map of each case."""
    from trundle.maps import OccupancyGrid
    from trundle.worlds import World
    from trundle.worlds.walls import extrude

    if path is None:
        for kind in ("warehouse", "office"):
            world = World.generate(kind, seed=2)
            yield kind, world, OccupancyGrid.from_world(world)
    else:
        grid = OccupancyGrid.load(path)
        yield "map, boxes", World.from_map(grid), grid
        yield "map, cells", World(*extrude(grid, most_boxes=0)), grid


def drive(world: Any, grid: Any, seconds: float) -> tuple[dict[str, list[float]], str]:
    """Seconds of each part in each period, and a digest of all that was seen and decided."""
    import numpy as np

    import trundle
    from trundle.control import CollisionMonitor
    from trundle.costmap import Costmap
    from trundle.mission.sampling import sample_mission
    from trundle.navigation import Navigator
    from trundle.navigation.sensing import SensedMap, SensedTracks
    from trundle.navigation.state import FINAL

    robot = trundle.Robot.load("nova_carter")
    lidars = {name: lidar.model_copy(update={"noise": 0.01}) for name, lidar in robot.lidars.items()}
    robot = robot.model_copy(update={"lidars": lidars})
    times: dict[str, list[float]] = {part: [] for part in PARTS}
    spent: dict[str, float] = {"costmap": 0.0, "tracker": 0.0}

    def timed(owner: type, part: str) -> None:
        original: Callable[..., Any] = owner.update  # type: ignore[attr-defined]

        def update(*arguments: Any) -> Any:
            began = time.thread_time()
            result = original(*arguments)
            spent[part] += time.thread_time() - began
            return result

        owner.update = update  # type: ignore[attr-defined]

    timed(SensedMap, "costmap")
    timed(SensedTracks, "tracker")
    digest = hashlib.sha256()
    start, goal = sample_mission(Costmap.from_grid(grid, robot), 3)
    navigator, monitor = Navigator(grid, robot), CollisionMonitor(robot)
    with (
        trundle.simulate(world, robot, backend="kinematic", lidar=True) as sim,
        trundle.simulate(world, robot, backend="kinematic") as blind,
    ):
        state = sim.reset(start, seed=1)
        blind.reset(start, seed=1)
        navigator.set_goal(goal)
        while state.time < seconds and navigator.status not in FINAL:
            spent["costmap"] = spent["tracker"] = 0.0
            began = time.thread_time()
            command = navigator.update(state.pose, state.twist, time=state.time, scans=state.scans)
            decided = time.thread_time()
            report = monitor.check(command, state.twist, state.scans, state.time, state.odometry)
            judged = time.thread_time()
            state = sim.step(report.command, PERIOD_S)
            stepped = time.thread_time()
            blind.step(report.command, PERIOD_S)
            alone = time.thread_time()
            for part, value in (
                ("step", alone - stepped),
                ("sensed step", stepped - judged),
                ("costmap", spent["costmap"]),
                ("tracker", spent["tracker"]),
                ("navigator", decided - began),
                ("monitor", judged - decided),
                ("sensed tick", stepped - began),
            ):
                times[part].append(value)
            said = (state.pose, state.contacts, report, navigator.tracks)
            digest.update(repr(said).encode())
            for scan in state.scans:
                digest.update(scan.ranges.tobytes())
        digest.update(np.ascontiguousarray(navigator.costmap.data).tobytes())
    return times, digest.hexdigest()


def work(options: argparse.Namespace) -> None:
    """Drive every case once and print the times of its control periods [s], and digests."""
    if options.before:  # its sources come before an editable installation of this one
        sys.meta_path[:] = [finder for finder in sys.meta_path if "_editable" not in type(finder).__module__]
        sys.path.insert(0, str(options.before / "src"))
    print(json.dumps({name: drive(world, grid, options.seconds) for name, world, grid in worlds(options.map)}))


def run_once(before: Path | None, options: argparse.Namespace) -> dict[str, Any]:
    """Drive in a separate process, with this package or that of another checkout."""
    command = [sys.executable, __file__, "--work", "--seconds", str(options.seconds)]
    command += ["--map", options.map] if options.map else []
    command += ["--before", str(before)] if before else []
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(done.stderr)
    return json.loads(done.stdout.splitlines()[-1])


def least(rounds: list[list[float]]) -> float:
    """The median over control periods of the least time that each took in any round [s]."""
    return statistics.median(map(min, zip(*rounds, strict=True)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--map", help="a ROS map's YAML file, instead of generated worlds")
    parser.add_argument("--before", type=Path, help="another checkout, with its kernels built")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=20.0, help="of each drive")
    parser.add_argument("--work", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.work:
        work(options)
        return
    from benchmarks.timing import describe_machine, print_table

    checkouts: dict[str, Path | None] = {"before": options.before.resolve()} if options.before else {}
    checkouts["now"] = None
    found: dict[str, list[dict[str, Any]]] = {name: [] for name in checkouts}
    for _ in range(options.rounds):
        for name, checkout in checkouts.items():
            found[name].append(run_once(checkout, options))
    print(describe_machine() + "\n")
    rows: list[tuple[str, ...]] = []
    for case in found["now"][0]:
        alike = len({one[case][1] for runs in found.values() for one in runs}) == 1
        for part in PARTS:
            medians = [f"{1e3 * least([run[case][0][part] for run in found[name]]):.4f}" for name in checkouts]
            rows.append((case, part, AIMS.get(part, ""), *medians, "yes" if alike else "no"))
    print_table(("world", "part", "aim [ms]", *(f"{name} [ms]" for name in checkouts), "same"), rows)


if __name__ == "__main__":
    main()
