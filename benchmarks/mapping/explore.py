"""Explore generated worlds: how much of the reachable floor is seen, how long it takes, and what touches what.

The time is compared with the shortest tour that is known: places from which all of the floor can be seen, chosen with
the true map by greedy set cover, in an order by nearest neighbour and 2-opt, along the shortest paths of the
footprint's inscribed circle, at the robot's top speed. It is an upper bound of the best tour, found with full
knowledge, without time for turning and for speeding up.

    python benchmarks/mapping/explore.py                      # ten worlds
    python benchmarks/mapping/explore.py --worlds 3 --missions 20

With --missions the whole way is driven: the explored map becomes the map of amcl, on which missions run with bad
odometry in the same world; they count as arrived by the true pose.
"""

import argparse
import json
import math
import time
from itertools import pairwise
from pathlib import Path

import numpy as np

import trundle
from trundle._core import cast_grid_rays, label_components
from trundle.costmap import INSCRIBED, LETHAL
from trundle.errors import PlanningError
from trundle.maps.cells import UNKNOWN, round_trinary
from trundle.mission.exploring import exploring
from trundle.planning import cost_field
from trundle.sim.odometry_errors import OdometryErrors

ROBOT = "nova_carter"
WORLDS = [("warehouse", seed) for seed in (0, 1, 2, 3)] + [("office", seed) for seed in (0, 1, 2, 3)]
WORLDS += [("corridors", 0), ("lot", 0)]
ODOMETRY = {"scale": 0.01, "heading": math.radians(1.0)}
BAD_ODOMETRY = {"scale": 0.05, "heading": math.radians(5.0)}
RANGE_M = 12.0
SPACING_M = 1.0
RAYS = 360
LEAST_SHARE = 0.98


def reachable(costmap, start):
    """Cells that the inscribed circle gets to from the start."""
    labels, _ = label_components((costmap.data < INSCRIBED).view(np.uint8), False)
    row, col = costmap.world_to_cell(start.x, start.y)
    return labels == labels[int(row), int(col)]


def share_seen(grid, costmap, floor):
    """Share of the reachable floor that a map shows as free or occupied."""
    rows, cols = np.nonzero(floor)
    x, y = costmap.cell_to_world(rows, cols)
    row, col = grid.world_to_cell(x, y)
    inside = grid.contains(row, col)
    known = np.zeros(len(rows), np.bool_)
    known[inside] = round_trinary(grid.data)[row[inside], col[inside]] != UNKNOWN
    return float(known.mean())


def visible(blocked, row, col, edge):
    """Cells that a lidar sees from a cell."""
    angles = np.arange(RAYS) * (2.0 * math.pi / RAYS)
    reach = RANGE_M / edge
    free = np.minimum(cast_grid_rays(blocked, col + 0.5, row + 0.5, angles, reach), reach)
    along = np.arange(0.0, reach, 1.0)
    rows = (row + 0.5 + np.outer(np.sin(angles), along)).astype(int)
    cols = (col + 0.5 + np.outer(np.cos(angles), along)).astype(int)
    inside = (along < free[:, None]) & (rows >= 0) & (cols >= 0)
    inside &= (rows < blocked.shape[0]) & (cols < blocked.shape[1])
    seen = np.zeros(blocked.shape, np.bool_)
    seen[rows[inside], cols[inside]] = True
    return seen


def tour_length(costmap, floor, start):
    """Length of the shortest known tour [m], and the number of places that it visits."""
    edge = costmap.resolution
    step = round(SPACING_M / edge)
    blocked = (costmap.data == LETHAL).view(np.uint8)
    places = [(r, c) for r in range(0, floor.shape[0], step) for c in range(0, floor.shape[1], step) if floor[r, c]]
    # On every second cell, in both directions: enough to count areas.
    part = (slice(None, None, 2), slice(None, None, 2))
    views = np.array([visible(blocked, r, c, edge)[part].ravel() for r, c in places])
    wanted = floor[part].ravel()
    views &= wanted
    covered, chosen = np.zeros(wanted.sum(), np.bool_), []
    views = views[:, wanted]
    while covered.mean() < LEAST_SHARE:
        gains = (views & ~covered).sum(axis=1)
        best = int(gains.argmax())
        if gains[best] == 0:
            break
        chosen.append(places[best])
        covered |= views[best]
    row, col = costmap.world_to_cell(start.x, start.y)
    stops = [(int(row), int(col)), *chosen]
    costs = np.where(floor, 1, 255).astype(np.uint8)
    fields = [cost_field(costs, stop, threads=1) for stop in stops]
    apart = np.array([[float(field[stop]) for stop in stops] for field in fields]) * edge
    order, left = [0], set(range(1, len(stops)))
    while left:
        order.append(min(left, key=lambda one: apart[order[-1], one]))
        left.remove(order[-1])

    def length(tour):
        return sum(apart[a, b] for a, b in pairwise(tour))

    better = True
    while better:
        better = False
        for i in range(1, len(order) - 1):
            for k in range(i + 1, len(order)):
                other = order[:i] + order[i : k + 1][::-1] + order[k + 1 :]
                if length(other) < length(order) - 1e-6:
                    order, better = other, True
    return length(order), len(chosen)


def explore(name, seed, options):
    """Explore one world; return its row and the map."""
    scenario = exploring(
        trundle.Scenario.make(
            world={"name": name},
            robot=ROBOT,
            seed=seed,
            backend=options.backend,
            lidar=True,
            known_map=False,
            controller=options.controller,
            odometry=ODOMETRY,
            time_limit_s=options.time_limit,
        )
    )
    with scenario.build() as mission:
        began = time.process_time()
        episode = mission.run()
        cpu_s = time.process_time() - began
        costmap = trundle.Costmap.from_grid(mission.grid, mission.robot)
        floor = reachable(costmap, mission.start)
        own = episode.own_map
        metres, places = tour_length(costmap, floor, mission.start)
        tour_s = metres / mission.robot.limits.linear_speed
        row = {
            "world": f"{name} {seed}",
            "outcome": episode.outcome.value,
            "seen": 0.0 if own is None else share_seen(own.grid, costmap, floor),
            "floor_m2": float(floor.sum()) * costmap.resolution**2,
            "contacts": list(episode.metrics.contacts),
            "time_s": episode.metrics.time_s,
            "tour_s": tour_s,
            "tour_places": places,
            "ratio": episode.metrics.time_s / tour_s,
            "position_error_m": episode.metrics.localization_error_m,
            "given_up": len(mission.agent.given_up),
            "cpu_s": cpu_s,
        }
        return row, None if own is None else own.grid


def drive_missions(name, seed, grid, count, options):
    """Drive missions with amcl on the explored map, in the world itself; return how many truly arrived."""
    base = exploring(trundle.Scenario.make(world={"name": name}, robot=ROBOT, seed=seed, known_map=False, lidar=True))
    with base.model_copy(update={"backend": trundle.Choice(name=options.backend)}).build() as mission:
        world, robot, true_map = mission.world, mission.robot, mission.grid
    ends = trundle.Costmap.from_grid(true_map, robot)
    results = []
    for number in range(count):
        start, goal = trundle.sample_mission(ends, seed=1000 * seed + number)
        navigator = trundle.Navigator(grid, robot)
        sim = trundle.simulate(world, robot, backend=options.backend, lidar=True)
        with OdometryErrors(**BAD_ODOMETRY).simulate(sim) as simulator:
            try:
                episode = trundle.run(simulator, navigator, start, goal, localizer="amcl", seed=number)
            except PlanningError as error:  # it does not fit on the map that was made
                results.append({"world": f"{name} {seed}", "mission": number, "truly": False, "message": str(error)})
                print(f"    mission {number}: {error}", flush=True)
                continue
        x, y = episode.trajectory.poses[-1][:2]
        off = math.hypot(x - goal.x, y - goal.y)
        said = episode.outcome.value in ("arrived", "arrived_by_estimate")
        results.append(
            {
                "world": f"{name} {seed}",
                "mission": number,
                "outcome": episode.outcome.value,
                "truly": said and off <= 0.25,
                "off_m": off,
                "contacts": list(episode.metrics.contacts),
                "message": episode.message,
            }
        )
    return results


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--worlds", type=int, default=len(WORLDS))
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--missions", type=int, default=0, help="missions on each explored map")
    parser.add_argument("--backend", default="kinematic")
    parser.add_argument("--controller", default="regulated_pure_pursuit")
    parser.add_argument("--time-limit", type=float, default=1800.0)
    parser.add_argument("-o", "--out", type=Path)
    options = parser.parse_args()
    rows, missions = [], []
    for name, seed in WORLDS[options.first : options.first + options.worlds]:
        row, grid = explore(name, seed, options)
        rows.append(row)
        print(
            f"{row['world']:<14}{row['outcome']:<12}{100 * row['seen']:6.1f} % of {row['floor_m2']:5.0f} m²  "
            f"{row['time_s']:6.1f} s = {row['ratio']:.2f} x {row['tour_s']:.0f} s  contacts {len(row['contacts'])}  "
            f"given up {row['given_up']}  error {row['position_error_m']:.3f} m  CPU {row['cpu_s']:.0f} s",
            flush=True,
        )
        if options.missions and grid is not None:
            found = drive_missions(name, seed, grid, options.missions, options)
            missions += found
            print(f"    missions: {sum(one['truly'] for one in found)} of {len(found)} truly arrived", flush=True)
        if options.out is not None:
            options.out.write_text(json.dumps({"worlds": rows, "missions": missions}, indent=1))
    seen, ratios = [row["seen"] for row in rows], [row["ratio"] for row in rows]
    print(f"least seen {100 * min(seen):.1f} %, slowest {max(ratios):.2f} x the known tour")
    if missions:
        print(f"{sum(one['truly'] for one in missions)} of {len(missions)} missions within 0.25 m of the goal")


if __name__ == "__main__":
    main()
