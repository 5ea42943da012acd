"""Marks where something was seen to move: which are forgotten, and which no lidar looks at."""

import math
import tracemalloc

import numpy as np
import pytest

from support.walls import ANGLES, CARTER, Surroundings, estimate
from trundle.costmap import LayeredCostmap
from trundle.costmap.layers.evidence_grid import MARKED, EvidenceGrid
from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.observation import Scan

HERE = Pose2D(0.0, 0.0)
WIDE = np.abs(ANGLES) < math.radians(135.0)  # a lidar of 270°


def look(layered, around, time, pose, *, moved, seen=WIDE, reach=12.0):
    part = Scan("front", time, HERE, 0.4, ANGLES[seen], around.ranges(pose)[seen], 0.05, reach)
    layered.update([part], estimate(time, pose), moved=moved)


def near(layered, x, y, within):
    found = layered.obstacles()
    return bool((np.hypot(found[:, 0] - x, found[:, 1] - y) < within).any())


@pytest.mark.parametrize("turns", [False, True])
def test_a_box_behind_the_robot_that_someone_has_passed_stays(turns):
    box = Surroundings([(2.0, -0.3, 2.0, 0.3)])
    layered, moved = LayeredCostmap(None, CARTER), [(2.0, 0.2, 0.3)]
    for tick in range(120):
        yaw = turns * min(math.pi, max(0.0, 0.1 * (tick - 20)))
        look(layered, box, 0.05 * tick, Pose2D(0.0, 0.0, yaw), moved=moved)
    assert near(layered, 2.0, 0.0, 0.1)


def test_a_box_out_of_a_lidars_range_stays_and_so_it_does_where_no_lidar_sends_scans():
    box, moved = Surroundings([(2.0, -0.3, 2.0, 0.3)]), [(2.0, 0.2, 0.3)]
    layered, silent = LayeredCostmap(None, CARTER), LayeredCostmap(None, CARTER)
    for tick in range(120):
        time = 0.05 * tick
        away = Pose2D(-min(11.0, 0.1 * tick), 0.0)
        look(layered, box, time, away, moved=moved)
        if tick <= 20:
            look(silent, box, time, HERE, moved=moved)
        else:
            silent.update([], estimate(time, HERE), moved=moved)
    assert near(layered, 2.0, 0.0, 0.1)
    assert near(silent, 2.0, 0.0, 0.1)


def test_what_is_hidden_in_view_is_forgotten_whatever_the_order_of_the_beams():
    someone, hidden = Surroundings([], [(4.0, 1.0, 0.3)]), Surroundings([(2.0, -0.4, 2.0, 1.0)])
    for seen in (np.flatnonzero(WIDE), np.flatnonzero(WIDE)[::-1], np.arange(len(ANGLES))):
        layered = LayeredCostmap(None, CARTER)
        for tick in range(100):
            around = someone if tick <= 20 else hidden
            look(layered, around, 0.05 * tick, HERE, moved=[(4.0, 1.0, 0.3)], seen=seen)
            assert tick != 20 or near(layered, 4.0, 1.0, 0.4)
        assert not near(layered, 4.0, 1.0, 0.4)


@pytest.mark.parametrize("moved", [[1.0, 2.0, 0.3], [[1.0, 2.0]], np.zeros((2, 6)), [[1.0, math.nan, 0.3]]])
def test_places_of_another_shape_are_refused(moved):
    with pytest.raises(InputError, match=r"moved .*\(N, 3\)"):
        LayeredCostmap(None, CARTER).update([], estimate(0.0, HERE), moved=moved)


def test_many_places_on_many_marks_take_little_memory():
    grid = EvidenceGrid(0.05, timed=True, rolling=False)
    grid.hold(0.0, 0.0, 10.0)
    grid.cells[:] = MARKED
    angles = np.linspace(0.0, 6.0, 165)
    places = np.column_stack([8.0 * np.cos(angles), 8.0 * np.sin(angles), np.full(165, 0.6)])
    tracemalloc.start()
    row, col = grid.unseen(places, 1.0)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 10e6
    x, y = (col + grid.col + 0.5) * 0.05, (row + grid.row + 0.5) * 0.05
    assert np.abs(np.hypot(x, y) - 8.0).max() < 0.6
    assert len(np.unique(row * grid.cells.shape[1] + col)) == len(row) > 20_000
    assert [len(part) for part in grid.unseen(np.array([(500.0, 0.0, 1.0)]), 1.0)] == [0, 0]
