"""What is drawn of walls that few beams met."""

from __future__ import annotations

import numpy as np
import pytest

from trundle.mapping.drawing import Beams, Canvas, LiveMap, _close_gaps, widest_gap_m
from trundle.maps import OccupancyGrid
from trundle.robots import Robot

EDGE = 0.05


def draw(missing: tuple[float, float], *, seen_through: bool, robot: Robot | None = None) -> OccupancyGrid:
    """A wall at y = 1 that beams from below meet, but for a stretch that they only pass along."""
    canvas = Canvas(EDGE, widest_gap_m(robot))
    x = np.arange(0.5, 3.5, 0.01)
    ends = np.column_stack((x, np.full(len(x), 1.02)))
    is_missing = (x >= missing[0]) & (x < missing[1])
    rows = [(np.column_stack((x, np.zeros(len(x)))), ends, np.ones(len(x), np.uint8))]
    rows = [tuple(array[~is_missing] for array in rows[0])]
    y = np.arange(0.52, 1.03, 0.05)
    along = np.column_stack((np.full(len(y), 0.5), y)), np.column_stack((np.full(len(y), 3.5), y))
    rows += [(*along, np.zeros(len(y), np.uint8))] * 2
    if seen_through:
        gap = x[is_missing]
        starts, behind = np.column_stack((gap, np.zeros(len(gap)))), np.column_stack((gap, np.full(len(gap), 1.6)))
        rows.append((starts, behind, np.ones(len(gap), np.uint8)))
    for starts, points, hits in rows:
        canvas.count(Beams((starts, points, hits)), np.zeros(3), 1)
    return canvas.grid(np.array([[2.0, 0.5]]))


def wall_of(grid: OccupancyGrid) -> np.ndarray:
    row, left = (int(index) for index in grid.world_to_cell(0.6, 1.02))
    right = int(grid.world_to_cell(3.4, 1.02)[1])
    return grid.data[row, left:right] >= 65


@pytest.mark.parametrize("width", [0.05, 0.3])
def test_a_gap_that_no_robot_fits_through_and_no_beam_went_through_is_wall(width: float) -> None:
    assert wall_of(draw((2.0, 2.0 + width), seen_through=False)).all()


def test_a_gap_that_beams_went_through_stays_open() -> None:
    assert (~wall_of(draw((2.0, 2.3), seen_through=True))).sum() == pytest.approx(6, abs=1)


def test_a_wider_gap_stays_open() -> None:
    assert (~wall_of(draw((2.0, 2.6), seen_through=False))).sum() == pytest.approx(12, abs=1)


@pytest.mark.parametrize("width", [0.05, 0.1, 0.15])
def test_a_gap_that_the_robot_fits_through_stays_open(width: float) -> None:
    closed = wall_of(draw((2.0, 2.0 + width), seen_through=False, robot=Robot.load("turtlebot3_burger")))
    assert closed.all() == (width < 0.138)


def test_a_larger_robot_closes_no_wider_gaps() -> None:
    assert (~wall_of(draw((2.0, 2.4), seen_through=False, robot=Robot.load("jackal")))).sum() == pytest.approx(8, abs=1)


def test_the_map_that_grows_and_the_final_one_heed_the_robot() -> None:
    burger = Robot.load("turtlebot3_burger")
    for robot, widest in ((burger, burger.planar.least_width), (Robot.load("jackal"), 0.3)):
        assert widest_gap_m(robot) == pytest.approx(widest)
        assert LiveMap(EDGE, robot)._canvas.widest_gap_m == pytest.approx(widest)
    assert widest_gap_m(None) == 0.3


@pytest.mark.parametrize(("missing", "is_free"), [((1.00, 1.08), True), ((1.0, 1.3), False), ((0.5, 0.58), False)])
def test_what_lies_between_beams_amid_free_space_is_free(missing: tuple[float, float], *, is_free: bool) -> None:
    """Beams along x that leave out some 0.2 m of two or six rows; in the last case beside a wall."""
    canvas = Canvas(EDGE, widest_gap_m(None))
    y = np.arange(0.52, 2.0, 0.05)
    starts, ends = np.column_stack((np.full(len(y), 0.52), y)), np.column_stack((np.full(len(y), 3.5), y))
    is_cut = (y >= missing[0]) & (y < missing[1])
    for first, last, chosen in ((0.52, 1.52, is_cut), (1.73, 3.5, is_cut), (0.52, 3.5, ~is_cut)):
        starts[:, 0], ends[:, 0] = first, last
        canvas.count(Beams((starts[chosen], ends[chosen], np.zeros(chosen.sum(), np.uint8))), np.zeros(3), 1)
    wall = np.column_stack((np.arange(1.0, 2.5, 0.02), np.full(75, 0.47)))
    for _ in range(3):
        canvas.count(Beams((wall - (0.0, 0.01), wall, np.ones(75, np.uint8))), np.zeros(3), 1)
    grid = canvas.grid(np.array([[1.0, 1.5]]))
    row, col = (int(index) for index in grid.world_to_cell(1.62, missing[0] + 0.02))
    assert (grid.data[row, col] == 0) == is_free


def test_both_axes_are_treated_alike() -> None:
    cells = np.full((12, 12), -1, np.int8)
    cells[:6] = 0
    cells[5] = 100
    cells[5, 3:6] = 0
    for turned in (cells, np.rot90(cells), np.rot90(cells, 2), np.rot90(cells, 3)):
        drawn = turned.copy()
        for view in (drawn, drawn.T):
            _close_gaps(view, 3)
        assert (drawn >= 65).sum() == 12
