"""Drives on estimates: whether what lidars mark lies where it was seen, and how often the robot plans again.

    python -m benchmarks.sensing.marks_on_estimates [--missions 3] [--worlds warehouse office cylinders]
    python -m benchmarks.sensing.marks_on_estimates --jump 0.2 --every 5
    python -m benchmarks.sensing.marks_on_estimates --localizer amcl

Each mission is driven with the true pose, and with a stand-in for a localizer: the truth with an error that wanders by
1 cm and 0.2 degrees, put on odometry that is wrong by 1 % and 1 degree per metre, at every scan. With `--jump`, its
error jumps by that much now and then, and stays there until the next jump.

Once a second the costmap is compared with the world. A cell that was sensed is wrong if it is farther than 0.15 m from
every cell of the world's own map, unmapped boxes included.
"""

from __future__ import annotations

import argparse
import math
import sys
import time as clock
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from benchmarks.sensing.ticks import noisy
from benchmarks.timing import describe_machine, print_table
from scipy import ndimage

import trundle
from trundle.costmap import LETHAL, Costmap
from trundle.errors import TrundleError
from trundle.geometry import Goal, Pose2D, wrap_angle
from trundle.localization import create_localizer
from trundle.maps import OccupancyGrid
from trundle.maps.cells import OCCUPIED
from trundle.mission.obstacles import Unmapped
from trundle.mission.sampling import sample_mission
from trundle.navigation import Navigator
from trundle.observation import Estimate, Observation
from trundle.planning import create_planner
from trundle.robots import Robot
from trundle.sim.odometry_errors import OdometryErrors
from trundle.worlds import World

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from support.estimates import Watched

WRONG_M = 0.15
OPTIONS: dict[str, dict[str, Any]] = {kind: {"low_objects": False} for kind in ("warehouse", "office")}
WANDERS_S = 1.0  # time constant of the error


class StandIn:
    """Knows the truth, and adds an error to it; between scans it adds up odometry.

    Args:
        sim: Where the truth is.
        error: Standard deviation of x and y [m].
        turn: Standard deviation of the yaw [rad].
        jump: By how much the error jumps now and then [m]; its yaw by 0.1 degrees for every centimetre.
        every: Mean time between two jumps [s].
    """

    def __init__(self, sim: Watched, error: float, turn: float, jump: float = 0.0, every: float = 5.0) -> None:
        self._sim, self._sigma = sim, np.array([error, error, turn])
        self._jump, self._every = jump, every
        self.reset(Pose2D(0.0, 0.0))

    def reset(self, pose: Pose2D, *, seed: int = 0) -> None:
        """Start over."""
        self._rng = np.random.default_rng([seed, 17])
        self._error = np.zeros(3)
        self._offset = np.zeros(3)
        self._time: float | None = None
        self._T_map_odom: Pose2D | None = None

    def update(self, observation: Observation) -> Estimate:
        """Return the truth with an error."""
        if observation.scans or self._T_map_odom is None:
            self._wander(0.0 if self._time is None else observation.time - self._time)
            self._time = observation.time
            true, (x, y, yaw) = self._sim.pose, (self._error + self._offset).tolist()
            believed = Pose2D(true.x + x, true.y + y, wrap_angle(true.yaw + yaw))
            self._T_map_odom = believed @ observation.odometry.inverse()
        return Estimate(observation.time, self._T_map_odom @ observation.odometry, None, self._T_map_odom)

    def _wander(self, seconds: float) -> None:
        keeps = math.exp(-seconds / WANDERS_S)
        self._error = keeps * self._error + math.sqrt(1.0 - keeps**2) * self._sigma * self._rng.normal(size=3)
        if self._jump and self._rng.random() < seconds / self._every:
            way, turn = self._rng.uniform(-math.pi, math.pi), math.radians(10.0 * self._jump)
            self._offset = np.array([self._jump * math.cos(way), self._jump * math.sin(way), turn * self._rng.normal()])


@dataclass
class Found:
    """What one drive gave.

    Attributes:
        status: Outcome.
        error_m: How far from the goal it truly ended [m].
        replans: Number of plans after the first.
        stops: Control periods in which the navigator said that it was blocked.
        marked: Cells that were sensed, summed over all looks at the costmap.
        wrong: Those of them that are wrong.
        most_wrong: The most at one look.
        contacts: What was touched.
        seconds: Of the drive [s].
        cpu_us: CPU time of a control period, simulator and all [µs].
    """

    status: str
    error_m: float
    replans: int
    stops: int
    marked: int
    wrong: int
    most_wrong: int
    contacts: str
    seconds: float
    cpu_us: float


@dataclass
class Mission:
    """A world with boxes that are not on the map, a start and a goal."""

    name: str
    seed: int
    world: World
    grid: OccupancyGrid
    truth: OccupancyGrid
    start: Pose2D
    goal: Pose2D


def make_missions(kinds: Sequence[str], count: int, robot: Robot) -> list[Mission]:
    """The first missions of each kind of world that have a path among the boxes."""
    made: list[Mission] = []
    for kind in kinds:
        seed, first = 0, len(made)
        while len(made) < first + count:
            world = World.generate(kind, seed=seed, **OPTIONS.get(kind, {}))
            grid = OccupancyGrid.from_world(world)
            costmap = Costmap.from_grid(grid, robot)
            start, goal = sample_mission(costmap, seed)
            try:
                filled = Unmapped(height=(1.0, 1.0)).add_to(world, costmap, [start.as_tuple(), goal.as_tuple()], seed)
                truth = OccupancyGrid.from_world(filled)
                create_planner("least_cost").plan(Costmap.from_grid(truth, robot), start, Goal.of(goal))
            except TrundleError:
                seed += 1
                continue
            made.append(Mission(kind, seed, filled, grid, truth, start, goal))
            seed += 1
    return made


def on_map(cells: npt.NDArray[np.bool_], mission: Mission) -> npt.NDArray[np.bool_]:
    """Cells of the world, at the places of the map's: the boxes may stand beyond it."""
    rows, cols = np.indices(mission.grid.shape)
    row, col = mission.truth.world_to_cell(*mission.grid.cell_to_world(rows.ravel(), cols.ravel()))
    row, col = np.clip(row, 0, cells.shape[0] - 1), np.clip(col, 0, cells.shape[1] - 1)
    return cells[row, col].reshape(mission.grid.shape)


def drive(mission: Mission, robot: Robot, options: argparse.Namespace, *, estimated: bool) -> Found:
    """Drive a mission with the true pose, or on estimates."""
    navigator = Navigator(mission.grid, robot)
    static = Costmap.from_grid(mission.grid, robot).data == LETHAL
    free = mission.truth.data != OCCUPIED
    cells = np.asarray(ndimage.distance_transform_edt(free))
    far = on_map(cells * mission.truth.resolution > WRONG_M, mission)
    errors = OdometryErrors(scale=options.scale, heading=math.radians(options.heading))
    looks: list[tuple[int, int]] = []
    stops = 0
    began = clock.thread_time()
    looked_s = 0.0
    with trundle.simulate(mission.world, robot, backend=options.backend, lidar=True) as inner:
        sim = Watched(errors.simulate(inner) if estimated else inner)
        stand_in = StandIn(sim, options.error, math.radians(options.turn), options.jump, options.every)
        named = options.localizer and create_localizer(options.localizer, mission.grid, robot)
        localizer = (named or stand_in) if estimated else None
        with trundle.Session(
            sim, navigator, mission.start, mission.goal, seed=mission.seed, localizer=localizer, time_limit_s=300.0
        ) as session:
            steps = 0
            while (step := session.step()) is not None:
                steps += 1
                stops += navigator.message.startswith("blocked")
                if step.index % 20 == 0:
                    look = clock.thread_time()
                    sensed = (navigator.costmap.data == LETHAL) & ~static
                    looks.append((int(sensed.sum()), int((sensed & far).sum())))
                    looked_s += clock.thread_time() - look
            episode = session.finish()
    spent = clock.thread_time() - began - looked_s
    return Found(
        str(episode.outcome.value),
        sim.pose.distance_to(mission.goal),
        episode.metrics.replans,
        stops,
        sum(marked for marked, _ in looks),
        sum(wrong for _, wrong in looks),
        max((wrong for _, wrong in looks), default=0),
        ", ".join(episode.metrics.contacts),
        steps * navigator.dt,
        1e6 * spent / max(1, steps),
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--missions", type=int, default=3, help="of each kind of world")
    parser.add_argument("--worlds", nargs="+", default=["warehouse", "office", "cylinders"])
    parser.add_argument("--backend", default="kinematic")
    parser.add_argument("--scale", type=float, default=0.01, help="error of the odometry, as a share of the distance")
    parser.add_argument("--heading", type=float, default=1.0, help="the same of its heading [degrees per metre]")
    parser.add_argument("--error", type=float, default=0.01, help="of the estimate [m]")
    parser.add_argument("--turn", type=float, default=0.2, help="the same of its yaw [degrees]")
    parser.add_argument("--jump", type=float, default=0.0, help="of the estimate, now and then [m]")
    parser.add_argument("--every", type=float, default=5.0, help="mean time between jumps [s]")
    parser.add_argument("--localizer", help="such as amcl, instead of the stand-in")
    parser.add_argument("--noise", type=float, default=0.02, help="of the lidars [m]")
    options = parser.parse_args()
    robot = noisy(Robot.load("nova_carter"), options.noise)
    rows: list[tuple[str, ...]] = []
    totals = {False: [0, 0, 0], True: [0, 0, 0]}
    for mission in make_missions(options.worlds, options.missions, robot):
        for estimated in (False, True):
            found = drive(mission, robot, options, estimated=estimated)
            total = totals[estimated]
            total[0] += found.replans
            total[1] += found.marked
            total[2] += found.wrong
            rows.append(
                (
                    f"{mission.name} {mission.seed}",
                    "estimate" if estimated else "true",
                    found.status,
                    f"{found.error_m:.2f}",
                    f"{found.seconds:.0f}",
                    str(found.replans),
                    str(found.stops),
                    found.contacts,
                    str(found.most_wrong),
                    f"{100.0 * found.wrong / max(1, found.marked):.2f}",
                    f"{found.cpu_us:.0f}",
                )
            )
    print(describe_machine() + "\n")
    heads = ("world", "pose", "outcome", "off [m]", "s", "replans", "blocked", "contacts", "most wrong", "wrong [%]")
    print_table((*heads, "us a period"), rows)
    print()
    for estimated, (replans, marked, wrong) in totals.items():
        name = "estimates" if estimated else "true pose"
        print(f"{name}: {replans} replans, {100.0 * wrong / max(1, marked):.2f} % of cells marked are wrong")


if __name__ == "__main__":
    main()
