"""A map that changes: the update of a rectangle against a rebuild, and whether a path is still free.

    python -m benchmarks.planning.changing_maps [--size 2000] [--rounds 30]

That the update equals the rebuild, and that the check finds what the footprint at every pose finds, is checked first.
"""

from __future__ import annotations

import argparse

import numpy as np
from benchmarks.planning.inflation import RESOLUTION, make_map
from benchmarks.timing import describe_machine, interleaved_medians, print_table

from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission import sample_mission
from trundle.planning import PathCheck, create_planner
from trundle.robots import Robot

CHANGED_CELLS = 20
"""Edge of the rectangle that changes: 1 m."""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=2000, help="edge of the map [cells]")
    parser.add_argument("--rounds", type=int, default=30)
    arguments = parser.parse_args()
    robot = Robot.load("nova_carter")
    data = make_map(arguments.size)
    grid = OccupancyGrid(data, RESOLUTION)
    costmap = Costmap.from_grid(grid, robot)
    middle = arguments.size // 2
    part = slice(middle, middle + CHANGED_CELLS)
    data[part, part] = 100
    changed = OccupancyGrid(data, RESOLUTION)
    if not np.array_equal(costmap.update(part, part, 100).data, Costmap.from_grid(changed, robot).data):
        raise SystemExit("the update differs from the rebuild")
    start, goal = sample_mission(costmap, 1)
    path = create_planner("least_cost").plan(costmap, start, Pose2D.of(goal))
    check = PathCheck(path)
    if check.first_hit(costmap) is not None or costmap.footprint_collides(check.poses).any():
        raise SystemExit("the path is not free")
    near = check.poses[len(check.poses) // 2]
    row, col = (int(index) for index in costmap.world_to_cell(near[0], near[1]))
    blocked = costmap.update(slice(row, row + 1), slice(col, col + 1), 100)
    hit = check.first_hit(blocked)
    if hit is None or hit.index != int(np.flatnonzero(blocked.footprint_collides(check.poses))[0]):
        raise SystemExit("the check and the footprint differ")
    medians = interleaved_medians(
        {
            "Costmap.from_grid": lambda: Costmap.from_grid(changed, robot),
            f"Costmap.update, {CHANGED_CELLS} x {CHANGED_CELLS}": lambda: costmap.update(part, part, 100),
            "  of this the copy": costmap.data.copy,
            "PathCheck(path), once a path": lambda: PathCheck(path),
            "first_hit, free": lambda: check.first_hit(costmap),
            "first_hit, blocked halfway": lambda: check.first_hit(blocked),
            "footprint at every pose": lambda: costmap.footprint_collides(check.poses),
            "cost_from": lambda: check.cost_from(costmap),
        },
        arguments.rounds,
    )
    print(describe_machine())
    print(f"{arguments.size} x {arguments.size} cells; a path of {path.length:.1f} m, {len(check.poses)} poses checked")
    print_table(("what", "µs"), [(name, f"{1e6 * seconds:.1f}") for name, seconds in medians.items()])


if __name__ == "__main__":
    main()
