"""Replanning after a collision: what is rerouted, what is closed, and that no path is lost."""

import numpy as np
import pytest

from trundle.costmap import LETHAL, Costmap
from trundle.errors import PlanningError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.path import Path
from trundle.planning import PathCheck, create_planner
from trundle.planning.cancellation import Patience
from trundle.planning.grid_planners.detours import Detours, TightPlaces
from trundle.planning.motions import fit_motions, motions_along
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
PATIENCE = Patience(None, None, "", pose=(0.0, 0.0, 0.0), cell=(0, 0))
ENDS = ((20, 20), (180, 180))


def with_door(cells):
    """A wall at y 5.0 to 5.1 m with a door of so many cells in its middle, and a line through it, close to the left."""
    data = np.zeros((200, 200), np.int8)
    data[100:102] = 100
    left = 100 - cells // 2
    data[100:102, left : left + cells] = 0
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.05), CARTER)
    x = 0.05 * left + 0.16
    return costmap, np.array([[x, 3.0], [x, 7.0]])


def collisions_of(costmap, vertices):
    return fit_motions(costmap, motions_along(vertices, np.pi / 2, None))


def closed(detours, costmap):
    return (detours.costs >= LETHAL) & (costmap.data < LETHAL)


def test_the_first_round_closes_the_cells_around_the_collisions():
    costmap, line = with_door(20)
    detours = Detours(costmap, ENDS, 20, wide=True)
    fit = collisions_of(costmap, line)
    assert detours.close(*fit)
    rows, cols = np.nonzero(closed(detours, costmap))
    assert len(rows) > 0
    assert set(cols.tolist()) <= {91, 92, 93, 94}
    assert costmap.data.max() == LETHAL
    assert detours.costs is not costmap.data


def test_repeated_collisions_close_what_is_too_narrow_for_half_and_then_for_any_turn():
    costmap, line = with_door(20)
    detours = Detours(costmap, ENDS, 20, wide=True)
    fit = collisions_of(costmap, line)
    middle = (101, slice(90, 110))
    assert detours.close(*fit)
    assert detours.close(*fit)
    assert 0 < (detours.costs[middle] < LETHAL).sum() < 8  # a strip in the middle of the door is left
    assert detours.close(*fit)
    assert (detours.costs[middle] == LETHAL).all()  # the robot cannot turn all round in a door of 1 m
    assert not closed(detours, costmap)[:60].any()  # far from the hits nothing is closed
    assert detours.reopen()
    assert np.array_equal(detours.costs, costmap.data)
    assert detours.close(*fit)
    assert detours.close(*collisions_of(costmap, np.add(line, (0.05, 0.0))))
    assert (detours.costs[middle] < LETHAL).sum() > 8
    assert not detours.reopen()


def test_the_ends_stay_open_and_what_is_near_them_is_not_widened():
    costmap, line = with_door(20)
    keep = ((104, 94), (180, 180))
    detours = Detours(costmap, keep, 20, wide=True)
    for _ in range(3):
        assert detours.close(*collisions_of(costmap, line))
    assert detours.costs[104, 94] == costmap.data[104, 94]
    assert (detours.costs[106, 94:106] < LETHAL).any()


def test_rounds_are_bounded():
    costmap, line = with_door(20)
    motions, hits, owners = collisions_of(costmap, line)
    for wide, most, expected in ((False, 3, 3), (False, 0, 0), (True, 0, 0)):
        detours = Detours(costmap, ENDS, most, wide=wide)
        rounds = 0
        for k in range(20):
            if not detours.close(motions, np.add(hits, (0.0, 0.3 * k, 0.0)), owners):
                break
            rounds += 1
        assert rounds == expected
    detours = Detours(costmap, ENDS, 8, wide=True)
    rounds = 0
    while detours.close(motions, np.add(hits, (0.0, 0.05 * rounds, 0.0)), owners):
        rounds += 1
    assert 8 < rounds <= 1 + 6 + 8


@pytest.mark.parametrize("number", range(4))
def test_a_path_is_led_through_the_middle_of_a_door(number):
    costmap, line = with_door(20)
    bent = np.concatenate([line[:1] - [1.5, 0.0], line, np.add(line[1:], (1.0, 0.5))])
    hits = collisions_of(costmap, bent)[1]
    assert len(hits) > 0
    led = TightPlaces().reroute(costmap, costmap.data, bent, hits, number, PATIENCE)
    assert led[0] == pytest.approx(bent[0])
    assert led[-1] == pytest.approx(bent[-1])
    in_door = np.interp(5.05, led[:, 1], led[:, 0])
    before = abs(line[0, 0] - 5.0)
    assert abs(in_door - 5.0) < before - 0.02
    assert len(collisions_of(costmap, led)[1]) < len(hits) or number == 0


def test_a_path_of_one_place_stays():
    costmap, line = with_door(20)
    assert np.array_equal(
        TightPlaces().reroute(costmap, costmap.data, line[:1], np.zeros((1, 3)), 0, PATIENCE), line[:1]
    )


def test_a_path_stays_where_there_is_no_other():
    costmap, line = with_door(20)
    nothing = np.full_like(costmap.data, LETHAL)
    hits = collisions_of(costmap, line)[1]
    led = TightPlaces().reroute(costmap, nothing, line, hits, 0, PATIENCE)
    assert np.hypot(*np.diff(led, axis=0).T).sum() == pytest.approx(4.0)
    assert led[[0, -1]] == pytest.approx(line)


def maze(seed):
    """Nine rooms with doors of 0.55 to 1 m on every other seed, and things standing about."""
    rng, cells = np.random.default_rng(seed), 160
    data = np.zeros((cells, cells), np.int8)
    if seed % 2:
        for wall in (50, 105):
            data[wall : wall + 2], data[:, wall : wall + 2] = 100, 100
        for wall in (50, 105):
            for room in (0, 52, 107):
                for turned in (data, data.T):
                    door = room + int(rng.integers(3, 30))
                    turned[wall : wall + 2, door : door + int(rng.integers(11, 20))] = 0
    for _ in range(int(rng.integers(0, 40))):
        height, width = rng.integers(1, 9, 2)
        row, col = rng.integers(0, cells, 2)
        data[row : row + height, col : col + width] = 100
    return Costmap.from_grid(OccupancyGrid(data, 0.05), CARTER), rng


@pytest.mark.parametrize("name", ["astar", "any_angle"])
def test_no_path_is_lost_that_closing_cell_by_cell_finds(name):
    found, fewer = 0, 0
    for seed in range(60):
        costmap, rng = maze(seed)
        ends = np.column_stack([rng.uniform(0.7, 7.3, (2, 2)), rng.uniform(-3, 3, 2)])
        if costmap.footprint_collides(ends).any():
            continue
        plain = create_planner(name)
        plain._tight_places = None
        outcomes = []
        for planner in (plain, create_planner(name)):
            try:
                outcomes.append(planner.plan(costmap, Pose2D(*ends[0]), Pose2D(*ends[1])))
            except PlanningError:
                outcomes.append(None)
        if isinstance(outcomes[1], Path):
            assert PathCheck(outcomes[1]).first_hit(costmap) is None
            assert outcomes[1].cost == pytest.approx(outcomes[1].length, rel=1e-6)
        if outcomes[0] is not None:
            assert outcomes[1] is not None
            found += 1
            fewer += outcomes[1].replans < outcomes[0].replans
    assert found > 8
    assert fewer > 0


@pytest.mark.parametrize("name", ["astar", "any_angle"])
def test_many_doors_take_few_replans(name):
    # 40 rooms one behind the other, the doors of 1 m to the left and to the right in turn.
    data = np.zeros((120, 40 * 60), np.int8)
    for number in range(1, 40):
        data[:, 60 * number : 60 * number + 2] = 100
        door = 10 if number % 2 else 90
        data[door : door + 20, 60 * number : 60 * number + 2] = 0
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.05), CARTER)
    path = create_planner(name).plan(costmap, Pose2D(1.5, 3.0), Pose2D(118.5, 3.0))
    assert path.replans <= 4
    assert PathCheck(path).first_hit(costmap) is None
