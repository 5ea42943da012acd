"""How soon a kidnapped robot finds out, and where it is again; and how long a search of a large map takes.

python -m benchmarks.localization.kidnapping --runs 12

A recorded drive is cut: after twenty seconds the robot is where it was at another time of the drive, and goes on from
there. Odometry is 1 % and 1°/m off. "Recovered" is within 0.5 m for good, with the state `localized`.
"""

from __future__ import annotations

import argparse
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
from benchmarks.localization.conditions import CONDITIONS, change_map, observe
from benchmarks.localization.drives import WORLDS, Drive, load_robot, record_drive
from benchmarks.timing import print_table

from trundle.localization import create_localizer
from trundle.maps import OccupancyGrid
from trundle.observation import Observation
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World

CUT_S, AFTER_S, NEAR_M, WITHIN_S = 20.0, 25.0, 0.5, 10.0


def cut_drive(drive: Drive, rng: np.random.Generator) -> Drive:
    """The first twenty seconds, and then a part from elsewhere, with the times of one drive."""
    first = [moment for moment in drive.moments if moment.time < CUT_S]
    last, end = first[-1], drive.moments[-1].time
    for _ in range(200):
        since = rng.uniform(CUT_S, end - AFTER_S)
        rest = [moment for moment in drive.moments if since <= moment.time < since + AFTER_S]
        if rest[0].pose.distance_to(last.pose) > 2.0:
            break
    shift = last.time + 0.05 - rest[0].time
    moved = [
        replace(m, time=m.time + shift, scans=tuple(replace(s, time=s.time + shift) for s in m.scans)) for m in rest
    ]
    return replace(drive, moments=(*first, *moved))


def run(drive: Drive, seed: int, *, changed: bool) -> tuple[float | None, float, int, float]:
    """Seconds until recovery (None: not), share of bad time that is said after 2 s, wrong moments, last error [m]."""
    rng = np.random.default_rng(seed)
    cut = cut_drive(drive, rng)
    grid = change_map(cut.grid, cut.moments, rng) if changed else cut.grid
    localizer = create_localizer("amcl", grid, cut.robot)
    localizer.reset(cut.moments[0].pose, seed=seed)
    odometry_jump = cut.moments[sum(m.time < CUT_S for m in cut.moments)].time
    good_since: float | None = None
    said: list[bool] = []
    wrong = 0
    error = 0.0
    for moment, observation in _observe(cut, rng, odometry_jump):
        estimate = localizer.update(observation)
        error = estimate.pose.distance_to(moment.pose)
        if moment.time < odometry_jump:
            continue
        good = error <= NEAR_M and estimate.state == "localized"
        good_since = (moment.time if good_since is None else good_since) if good else None
        wrong += error > NEAR_M and estimate.state == "localized" and moment.time > odometry_jump + 2.0
        if error > NEAR_M and moment.time > odometry_jump + 2.0:
            said.append(estimate.state != "localized")
    recovered = None if good_since is None else good_since - odometry_jump
    return recovered, float(np.mean(said)) if said else 1.0, wrong, error


def _observe(drive: Drive, rng: np.random.Generator, jump: float):
    """As `observe`, but the robot is carried at the jump, and its odometry does not notice."""
    before = replace(drive, moments=tuple(m for m in drive.moments if m.time < jump))
    after = replace(drive, moments=tuple(m for m in drive.moments if m.time >= jump))
    last = None
    for moment, observation in observe(before, CONDITIONS["A"], rng):
        last = observation.odometry
        yield moment, observation
    for moment, observation in observe(after, CONDITIONS["A"], rng):
        yield moment, replace(observation, odometry=last @ observation.odometry)


def search_large_map() -> list[float]:
    """CPU seconds of the first update after `reinitialize_global`, on a warehouse of 60 by 60 m."""
    robot = load_robot()
    world = World.generate("warehouse", seed=3, size=(60.0, 60.0))
    grid = OccupancyGrid.from_world(world, resolution=0.05, z_range=robot.z_range)
    from trundle.mission import sample_mission
    from trundle.navigation import Navigator

    costmap = Navigator(grid, robot).costmap
    took = []
    localizer = create_localizer("amcl", grid, robot)
    with KinematicSimulator(world, robot, lidar=True) as sim:
        for seed in range(8):
            start, _ = sample_mission(costmap, seed=seed)
            state = sim.reset(start, seed=seed)
            localizer.reset(None, seed=seed)
            began = time.process_time()
            localizer.update(Observation(0.0, state.twist, state.odometry, state.scans))
            took.append(time.process_time() - began)
    return took[1:]  # the tables are made at the first


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", nargs="*", default=list(WORLDS[:5]), help="generators, or map files")
    parser.add_argument("--runs", type=int, default=10, help="kidnappings, on true and on changed maps each")
    parser.add_argument("--cache", type=Path, default=None, help="folder that keeps recorded drives")
    parser.add_argument("--each", action="store_true", help="print each run")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    rows = []
    for changed in (False, True):
        found = []
        for index in range(options.runs):
            world = options.worlds[index % len(options.worlds)]
            drive = record_drive(world, 1, seconds=120.0, cache=options.cache)
            found.append(run(drive, index, changed=changed))
            if options.each:
                print(changed, drive.name, found[-1], flush=True)
        times = [one[0] for one in found if one[0] is not None]
        within = sum(each <= WITHIN_S for each in times)
        rows.append(
            (
                "changed map" if changed else "true map",
                str(len(found)),
                f"{100 * within / len(found):.0f} %",
                f"{np.median(times):.1f}" if times else "–",
                f"{max(times):.1f}" if times else "–",
                f"{100 * np.mean([one[1] for one in found]):.0f} %",
                str(sum(one[2] > 0 for one in found)),
                str(sum(one[3] > NEAR_M for one in found)),
            )
        )
    header = ("kidnapped", "runs", "within 10 s", "median [s]", "longest [s]", "said", "runs wrongly localized", "lost")
    print_table(header, rows)
    took = search_large_map()
    print(f"search of 60 x 60 m: median {1e3 * np.median(took):.0f} ms, longest {1e3 * max(took):.0f} ms")


if __name__ == "__main__":
    main()
