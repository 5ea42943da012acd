"""Whether the robot can stand at a start and its goals, and whether they are connected."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from trundle._core import inflate
from trundle.geometry import Pose2D
from trundle.maps.cells import OCCUPIED, UNKNOWN
from trundle.maps.check.areas import Areas, Chart, Mask
from trundle.maps.check.finding import Finding
from trundle.robots import Robot


def check_reach(chart: Chart, robot: Robot | None, start: Pose2D | None, goals: Sequence[Pose2D]) -> list[Finding]:
    """Check whether a robot can stand at the start and the goals, and whether one free area connects them.

    With a robot, a cell is free where its inscribed circle touches nothing, as on a costmap; without one, a free cell.
    Start or goals alone are compared with the largest area.
    """
    places = [("the start", start)] if start is not None else []
    places += [("the goal" if len(goals) == 1 else f"goal {n}", goal) for n, goal in enumerate(goals, start=1)]
    if not places:
        return []
    passable = chart.free if robot is None else _passable(chart, robot)
    areas = Areas(passable, diagonal=robot is not None)
    home = int(np.argmax(areas.sizes)) + 1 if len(areas) else 0
    home_name = "the largest free area"
    findings: list[Finding] = []
    for name, pose in places:
        blocked = _describe_blocked(chart, passable, name, pose)
        if blocked is not None:
            findings.append(blocked)
            continue
        row, col = (int(index) for index in chart.grid.world_to_cell(pose.x, pose.y))
        label = int(areas.labels[row, col])
        if name == "the start" and goals:
            home, home_name = label, "the start"
        elif label != home:
            findings.append(
                _finding(
                    f"{name} ({pose.x:g}, {pose.y:g}) is in a free area of "
                    f"{chart.square_metres(areas.area(label - 1).cells)} that is not joined to {home_name}"
                    + (f" for {robot.name}" if robot else ""),
                    pose,
                    "choose a place in the same area, or look for a wall or a narrow door in between",
                )
            )
    return findings


def _passable(chart: Chart, robot: Robot) -> Mask:
    reach = (robot.inscribed_radius + 1e-9) / chart.grid.resolution
    table = np.full(int(reach * reach) + 1, 253, dtype=np.uint8)
    table[0] = 254
    return inflate(chart.grid.data, table) == 0


def _describe_blocked(chart: Chart, passable: Mask, name: str, pose: Pose2D) -> Finding | None:
    grid = chart.grid
    row, col = (int(index) for index in grid.world_to_cell(pose.x, pose.y))
    where = f"{name} ({pose.x:g}, {pose.y:g})"
    if not grid.contains(row, col):
        return _finding(f"{where} lies outside the map", pose, "choose a place on the map")
    if passable[row, col]:
        return None
    value = grid.data[row, col]
    what = {OCCUPIED: "lies in an obstacle", UNKNOWN: "lies in unknown space"}.get(int(value), "is too near to a wall")
    rows, cols = np.nonzero(passable)
    if len(rows) == 0:
        return _finding(f"{where} {what}", pose, "there is no free place on this map")
    nearest = int(np.argmin((rows - row) ** 2 + (cols - col) ** 2))
    x, y = chart.place(rows[nearest], cols[nearest])
    return _finding(f"{where} {what}", pose, f"the nearest free place is ({x:.2f}, {y:.2f})")


def _finding(message: str, pose: Pose2D, fix: str) -> Finding:
    return Finding("disconnected", "error", message, (pose.x, pose.y), fix)
