"""Glass and people in maps: a pane that is seen from in front, what lies behind it, and people who walk by."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mapping.rooms import ANGLES, cast
from trundle import Pose2D, Robot, Scan, draw_map
from trundle.mapping.nodes import Nodes
from trundle.maps import OccupancyGrid

WALLS = np.array(
    [(0, 0, 12, 0), (12, 0, 12, 6), (12, 6, 0, 6), (0, 6, 0, 0), (0, 2.5, 3, 2.5), (8, 2.5, 12, 2.5)], dtype=np.float64
)
PANE = np.array([(3, 2.5, 8, 2.5)], dtype=np.float64)
DRIVE = [Pose2D(float(x), 1.0, 0.0) for x in np.arange(1.0, 11.0, 0.1)]


def through_pane(pose: Pose2D, cone: float, rng: np.random.Generator) -> np.ndarray:
    """Ranges in a room with a pane in its middle, which returns beams up to this angle from its normal [rad]."""
    walls, pane = cast(pose, rng, WALLS), cast(pose, rng, PANE)
    off = np.abs(np.remainder(ANGLES + pose.yaw - math.pi / 2 + math.pi, 2.0 * math.pi) - math.pi)
    return np.where((pane < walls) & (off < cone), pane, walls)


def beside_person(pose: Pose2D, at: tuple[float, float], rng: np.random.Generator) -> np.ndarray:
    """Ranges in the room with a person, who is a square of 0.4 m."""
    x, y = at
    corners = [(x - 0.2, y - 0.2), (x + 0.2, y - 0.2), (x + 0.2, y + 0.2), (x - 0.2, y + 0.2)]
    sides = [(*corners[k - 1], *corners[k]) for k in range(4)]
    return np.minimum(cast(pose, rng, WALLS), cast(pose, rng, np.array(sides)))


def map_of(ranges: list[np.ndarray]) -> OccupancyGrid:
    """The map of scans along the drive."""
    nodes = Nodes(Robot.load("nova_carter"))
    for i, (pose, measured) in enumerate(zip(DRIVE, ranges, strict=True)):
        node = nodes.add_node(float(i), 0, pose, pose, float(i))
        scan = Scan("laser", float(i), Pose2D(0.0, 0.0), 0.3, ANGLES, measured, 0.05, 30.0)
        nodes.add_scan(scan, Pose2D(0.0, 0.0), Pose2D(0.0, 0.0))
        if node:
            nodes.add_edge(node - 1, node, 0, DRIVE[i - 1].inverse() @ pose, np.eye(3))
    return draw_map(nodes.to_graph())


def cells(grid: OccupancyGrid, low: tuple[float, float], high: tuple[float, float]) -> np.ndarray:
    """The cells between two corners."""
    (left, right), (bottom, top) = (
        [round((end[axis] - at) / grid.resolution) for end in (low, high)]
        for axis, at in enumerate((grid.origin.x, grid.origin.y))
    )
    return grid.data[bottom:top, left:right]


def test_a_pane_that_returns_most_beams_is_a_wall_and_what_is_seen_through_it_is_left_out() -> None:
    rng = np.random.default_rng(0)
    grid = map_of([through_pane(pose, math.radians(45.0), rng) for pose in DRIVE])
    assert ((cells(grid, (3.2, 2.4), (7.8, 2.6)) >= 65).any(axis=0)).mean() > 0.98
    assert (cells(grid, (0.2, 2.8), (11.8, 5.8)) == -1).all()
    assert (cells(grid, (0.5, 0.3), (11.5, 2.0)) == 0).mean() > 0.99


def test_a_pane_that_returns_beams_from_in_front_alone_is_not_drawn() -> None:
    rng = np.random.default_rng(0)
    grid = map_of([through_pane(pose, math.radians(5.0), rng) for pose in DRIVE])
    assert not (cells(grid, (3.2, 2.4), (7.8, 2.6)) >= 65).any()
    behind = cells(grid, (4.0, 2.8), (7.0, 5.8))
    assert ((behind >= 0) & (behind <= 20)).mean() > 0.95


@pytest.mark.parametrize("speed", [0.0, 0.05, -0.1])
def test_people_who_walk_are_left_out(speed: float) -> None:
    rng = np.random.default_rng(0)
    grid = map_of([beside_person(pose, (6.0 + speed * i, 1.7), rng) for i, pose in enumerate(DRIVE)])
    around = cells(grid, (0.5, 1.3), (11.5, 2.2))
    if speed:
        assert (around >= 65).mean() < 0.005
    else:
        assert (around >= 65).any()  # one who stands there all the time is a thing
