"""Drives with lidars that err: what the collision monitor, the marks and the planner make of it, with the true pose.

    python -m benchmarks.sensing.lidar_errors [--missions 10] [--worlds office warehouse]
    python -m benchmarks.sensing.lidar_errors --people 8 --worlds warehouse --backend mujoco

Each mission is driven with exact lidars, with a noise of 2 cm, with 1 % of the beams without a return, with 1 % of them
returned too soon, and with all three; among boxes that are not on the map. Once a second the costmap is compared with
the world, as in `marks_on_estimates`. `false tracks` counts control periods in which something is tracked as moving,
where nothing moves.
"""

from __future__ import annotations

import argparse
import time as clock
from dataclasses import dataclass, replace

import numpy as np
from benchmarks.sensing.marks_on_estimates import WRONG_M, Mission, make_missions, on_map
from benchmarks.timing import describe_machine, print_table
from scipy import ndimage

import trundle
from trundle.control import CollisionMonitor
from trundle.costmap import LETHAL, Costmap
from trundle.maps.cells import OCCUPIED
from trundle.navigation import Navigator
from trundle.robots import Robot
from trundle.sim.lidar_errors import LidarErrors
from trundle.worlds.movers import Crowd

CONDITIONS = {
    "exact": LidarErrors(),
    "noise": LidarErrors(noise=0.02),
    "dropouts": LidarErrors(dropouts=0.01),
    "short": LidarErrors(short_returns=0.01),
    "all": LidarErrors(noise=0.02, dropouts=0.01, short_returns=0.01),
}


class TimedMonitor(CollisionMonitor):
    """A monitor that counts its CPU time [s]."""

    spent = 0.0

    def check(self, *arguments, **named):
        """Judge one command."""
        began = clock.thread_time()
        report = super().check(*arguments, **named)
        self.spent += clock.thread_time() - began
        return report


@dataclass
class Total:
    """What the missions of one condition gave, summed."""

    arrived: int = 0
    missions: int = 0
    contacts: int = 0
    stops: int = 0
    stopped: int = 0
    replans: int = 0
    marked: int = 0
    wrong: int = 0
    false_tracks: int = 0
    steps: int = 0
    monitor_s: float = 0.0
    agent_s: float = 0.0


def drive(mission: Mission, errors: LidarErrors, robot: Robot, people: int, backend: str, total: Total) -> None:
    """Drive a mission with the true pose."""
    crowds = (Crowd("person", people, seed=mission.seed),) if people else ()
    world = replace(mission.world, movers=crowds)
    navigator, monitor = Navigator(mission.grid, robot), TimedMonitor(robot)
    static = Costmap.from_grid(mission.grid, robot).data == LETHAL
    cells = np.asarray(ndimage.distance_transform_edt(mission.truth.data != OCCUPIED))
    far = on_map(cells * mission.truth.resolution > WRONG_M, mission)
    with trundle.simulate(world, robot, backend=backend, lidar=True) as inner:
        sim = errors.simulate(inner)
        with trundle.Session(
            sim, navigator, mission.start, mission.goal, seed=mission.seed, time_limit_s=180.0, monitor=monitor
        ) as session:
            while True:
                began, before = clock.thread_time(), monitor.spent
                step = session.step()
                total.agent_s += clock.thread_time() - began - (monitor.spent - before)
                if step is None:
                    break
                total.steps += 1
                total.stopped += step.monitor is not None and step.monitor.action == "stop"
                if not people:
                    total.false_tracks += any(track.moving for track in navigator.tracks)
                if step.index % 20 == 0:
                    sensed = (navigator.costmap.data == LETHAL) & ~static
                    total.marked += int(sensed.sum())
                    total.wrong += int((sensed & far).sum())
            episode = session.finish()
    total.missions += 1
    total.arrived += str(episode.outcome.value) == "arrived"
    total.contacts += len(episode.metrics.contacts)
    total.stops += episode.metrics.monitor_stops or 0
    total.replans += episode.metrics.replans
    total.monitor_s += monitor.spent


def main() -> None:
    """Drive the missions under each condition, and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--missions", type=int, default=10, help="of each kind of world")
    parser.add_argument("--worlds", nargs="+", default=["office", "warehouse"])
    parser.add_argument("--conditions", nargs="+", default=list(CONDITIONS), choices=list(CONDITIONS))
    parser.add_argument("--people", type=int, default=0)
    parser.add_argument("--backend", default="kinematic")
    options = parser.parse_args()
    robot = Robot.load("nova_carter")
    missions = make_missions(options.worlds, options.missions, robot)
    rows: list[tuple[str, ...]] = []
    for name in options.conditions:
        total = Total()
        for mission in missions:
            drive(mission, CONDITIONS[name], robot, options.people, options.backend, total)
        wrong = "–" if options.people else f"{100.0 * total.wrong / max(1, total.marked):.2f} %"
        rows.append(
            (
                *(name, f"{total.arrived} of {total.missions}", str(total.contacts), str(total.stops)),
                *(str(total.stopped), str(total.replans), wrong, str(total.false_tracks)),
                f"{1e6 * total.monitor_s / total.steps:.0f}",
                f"{1e6 * total.agent_s / total.steps:.0f}",
            )
        )
        print("  ".join(rows[-1]), flush=True)
    print(describe_machine() + "\n")
    heads = ("lidars", "arrive", "contacts", "stops", "periods stopped", "replans", "wrong marks", "false tracks")
    print_table((*heads, "monitor [us]", "all else [us]"), rows)


if __name__ == "__main__":
    main()
