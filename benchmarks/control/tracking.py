"""Tracks against the truth: speed error, how many are found within half a second, and false tracks per minute.

    python -m benchmarks.control.tracking --scenes open shelves still --runs 4
    python -m benchmarks.control.tracking --scenes dynabarn --worlds WORLDS.json

`open` is a room of 16 × 16 m with walkers, where the robot drives curves; in `shelves` it drives missions between the
shelves of a generated warehouse, among people and forklifts that do not see it; `still` is the same without movers; and
`dynabarn` is that benchmark's cylinders, from its file of worlds. MuJoCo, Nova Carter's two lidars, 1 cm of noise.

A mover is in sight while five beams or more end on it within 10 m. It is found if a confirmed track is within half a
metre of its outline at most half a second after it came into sight, for those that are in sight for so long and then
move faster than 0.3 m/s. A track is false that is confirmed, faster than 0.3 m/s, and more than 0.5 m from every mover;
each counts once.
"""

from __future__ import annotations

import argparse
import json
import math
import time as clock
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from benchmarks.timing import print_table

import trundle
from trundle.costmap import Costmap
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Cylinder, Solid
from trundle.maps import OccupancyGrid
from trundle.mission.sampling import sample_mission
from trundle.navigation import Navigator
from trundle.navigation.state import FINAL
from trundle.observation import Scan, Track
from trundle.robots import Robot
from trundle.sim import MoverState
from trundle.tracking import Tracker
from trundle.worlds import World
from trundle.worlds.movers import Crowd, Mover, Waypoints

ROBOT = Path(__file__).parents[1] / "sensing" / "carter.yaml"
DT = 0.05
SIGHT_M, SIGHT_BEAMS = 10.0, 5
FOUND_S, NEAR_M, FALSE_MPS = 0.5, 0.5, 0.3


@dataclass
class Tally:
    """What is counted over the runs of a scene."""

    seconds: float = 0.0
    errors: list[float] = field(default_factory=list)
    found: list[float] = field(default_factory=list)
    false: int = 0
    cost_ms: list[float] = field(default_factory=list)


class Scoring:
    """Compares tracks with movers, tick by tick, in one run."""

    def __init__(self, tally: Tally, *, listed: bool) -> None:
        self._tally, self._listed = tally, listed
        self._since: dict[str, float] = {}
        self._last: dict[str, float] = {}
        self._settled: set[str] = set()
        self._false: dict[int, list[Track]] = defaultdict(list)

    def add(self, time: float, tracks: tuple[Track, ...], movers: tuple[MoverState, ...], hits: np.ndarray) -> None:
        """Take one tick; hits [m] are in the map frame, shape (N, 2)."""
        confirmed = [track for track in tracks if track.confirmed]
        for mover in movers:
            apart = [distance(mover, track.x, track.y) for track in confirmed]
            nearest = confirmed[int(np.argmin(apart))] if apart and min(apart) < NEAR_M else None
            self._look_for(mover, nearest, time, hits)
            speed = math.hypot(mover.vx, mover.vy)
            if nearest is not None and nearest.moving and 0.5 <= speed <= 2.0 and mover.name in self._since:
                self._tally.errors.append(math.hypot(nearest.vx - mover.vx, nearest.vy - mover.vy))
        for track in confirmed:
            if track.speed > FALSE_MPS and all(distance(mover, track.x, track.y) > NEAR_M for mover in movers):
                self._false[track.id].append(track)
        self._tally.seconds += DT

    def _look_for(self, mover: MoverState, track: Track | None, time: float, hits: np.ndarray) -> None:
        near = hits[np.hypot(hits[:, 0] - mover.pose.x, hits[:, 1] - mover.pose.y) < 2.5]
        on_it = sum(distance(mover, x, y) < 0.05 for x, y in near.tolist()) if len(near) else 0
        name = mover.name
        if on_it >= SIGHT_BEAMS:
            self._last[name] = time
            self._since.setdefault(name, time)
        elif name in self._since and time - self._last[name] > 0.2:
            del self._since[name]
            self._settled.discard(name)
        if name not in self._since or name in self._settled:
            return
        waited = time - self._since[name]
        if track is not None or waited >= FOUND_S - 1e-9:
            self._settled.add(name)
            if self._since[name] > DT and math.hypot(mover.vx, mover.vy) > FALSE_MPS:
                self._tally.found.append(waited if track is not None else math.inf)

    def finish(self) -> None:
        """Count the false tracks."""
        self._tally.false += len(self._false)
        for number, tracks in self._false.items() if self._listed else ():
            first, last = tracks[0], tracks[-1]
            print(
                f"    false track {number}: {first.time:.2f} to {last.time:.2f} s, ({first.x:.2f}, {first.y:.2f}) to "
                f"({last.x:.2f}, {last.y:.2f}), up to {max(track.speed for track in tracks):.2f} m/s, "
                f"radius {last.radius:.2f}"
            )


def distance(mover: MoverState, x: float, y: float) -> float:
    """From the outline of a mover [m], 0 inside."""
    point = np.array([x, y])
    corners = mover.pose.transform_points(mover.outline)
    along = np.roll(corners, -1, axis=0) - corners
    if (along[:, 0] * (y - corners[:, 1]) >= along[:, 1] * (x - corners[:, 0])).all():
        return 0.0
    share = np.clip(((point - corners) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    return float(np.hypot(*(corners + share[:, None] * along - point).T).min())


def hits_of(scans: tuple[Scan, ...], pose: Pose2D) -> np.ndarray:
    """Hits within sight, map frame."""
    points = np.vstack([np.zeros((0, 2)), *(scan.points() for scan in scans)])
    return pose.transform_points(points[np.hypot(points[:, 0], points[:, 1]) <= SIGHT_M])


def walkers(seed: int) -> tuple[World, Pose2D]:
    """A room with walkers of four speeds."""
    block = Box((16.4, 0.2, 1.0))
    walls = tuple(
        Solid(f"wall_{index}", block, Pose3D.planar(*at, 0.5, yaw))
        for index, (at, yaw) in enumerate(
            (((0, -8.1), 0.0), ((0, 8.1), 0.0), ((-8.1, 0), 0.5 * math.pi), ((8.1, 0), 0.5 * math.pi))
        )
    )
    crowds = tuple(Crowd(f"walkers_{speed:g}", 2, speed=speed, seed=seed) for speed in (0.7, 1.2, 1.6, 2.0))
    return World("room", walls, movers=crowds), Pose2D(0.0, 0.0)


def warehouse(seed: int, *, moving: bool) -> tuple[World, Pose2D]:
    """A generated warehouse with a crowd."""
    crowds = (Crowd("forklift", 4, kind="forklift", sees_robot=False), Crowd("person", 8, sees_robot=False))
    return replace(World.generate("warehouse", seed=seed), movers=crowds if moving else ()), Pose2D(0.0, 0.0)


def dynabarn(path: str, seed: int) -> tuple[World, Pose2D]:
    """One of DynaBARN's worlds, from its start."""
    worlds = json.loads(Path(path).read_text(encoding="utf-8"))
    name = sorted(worlds)[seed % len(worlds)]
    body = (Solid("body", Cylinder(0.5, 1.0), Pose3D((0.0, 0.0, 0.5))),)
    movers = tuple(
        Mover(f"cylinder_{index}", body, Waypoints(tuple(map(tuple, item["waypoints"])), "catmull_rom"))
        for index, item in enumerate(worlds[name]["obstacles"])
    )
    walls = tuple(Solid(f"wall_{y}", Box((24.0, 0.2, 1.0)), Pose3D.planar(0.0, y, 0.5, 0.0)) for y in (-10.1, 10.1))
    return World(name, walls, movers=movers), Pose2D(11.0, 0.0, math.pi)


def commands(world: World, robot: Robot, start: Pose2D, seed: int) -> Iterator[tuple[Pose2D, Navigator | None]]:
    """Where a run begins, and what drives it: a mission between shelves, else curves."""
    if not world.name.startswith("warehouse"):
        yield start, None
        return
    grid = OccupancyGrid.from_world(replace(world, movers=()))
    begin, goal = sample_mission(Costmap.from_grid(grid, robot), seed)
    navigator = Navigator(grid, robot, tracking=False)
    navigator.set_goal(goal)
    yield begin, navigator


def run(world: World, start: Pose2D, robot: Robot, seed: int, tally: Tally, options: argparse.Namespace) -> None:
    """Drive one run."""
    scoring, tracker = Scoring(tally, listed=options.listed), Tracker(robot)
    for begin, navigator in commands(world, robot, start, seed):
        with trundle.simulate(world, robot, backend=options.backend, lidar=True) as sim:
            state = sim.reset(begin, seed=seed)
            while state.time < options.seconds and (navigator is None or navigator.status not in FINAL):
                if navigator is None:
                    command = Twist2D(0.6, 0.4 * math.sin(0.7 * state.time) + 0.3)
                else:
                    command = navigator.update(state.pose, state.twist, time=state.time, scans=state.scans)
                began = clock.process_time()
                tracks = tracker.update(state.scans, state.time, state.pose)
                tally.cost_ms.append(1e3 * (clock.process_time() - began) / max(len(state.scans), 1))
                scoring.add(state.time, tracks, state.movers, hits_of(state.scans, state.pose))
                state = sim.step(command, DT)
    scoring.finish()


def main() -> None:
    """Run the scenes and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", nargs="+", default=["open", "shelves", "still"])
    parser.add_argument("--runs", type=int, default=2)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=40.0)
    parser.add_argument("--backend", default="mujoco")
    parser.add_argument("--worlds", help="DynaBARN's file of worlds")
    parser.add_argument("--listed", action="store_true", help="list the false tracks")
    options = parser.parse_args()
    robot = Robot.load(str(ROBOT))
    lines = []
    for scene in options.scenes:
        tally = Tally()
        for seed in range(options.first, options.first + options.runs):
            if options.listed:
                print(f"{scene}, run {seed}", flush=True)
            world, start = (
                walkers(seed)
                if scene == "open"
                else dynabarn(options.worlds, seed)
                if scene == "dynabarn"
                else warehouse(seed, moving=scene == "shelves")
            )
            run(world, start, robot, seed, tally, options)
        lines.append((scene, *describe(tally)))
    print_table(
        ("scene", "minutes", "speed error", "p90", "found in 0.5 s", "of", "false a minute", "ms a scan", "p99"), lines
    )


def describe(tally: Tally) -> tuple[str, ...]:
    """The figures of a scene."""
    median, most = np.percentile(tally.errors, [50, 90]) if tally.errors else (math.nan, math.nan)
    found = [delay <= FOUND_S + 1e-9 for delay in tally.found]
    return (
        f"{tally.seconds / 60.0:.1f}",
        f"{median:.3f}",
        f"{most:.3f}",
        f"{100.0 * sum(found) / len(found):.1f} %" if found else "–",
        str(len(found)),
        f"{tally.false / (tally.seconds / 60.0):.2f}",
        f"{np.median(tally.cost_ms):.2f}",
        f"{np.percentile(tally.cost_ms, 99):.2f}",
    )


if __name__ == "__main__":
    main()
