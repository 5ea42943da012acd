import numpy as np
import pytest

from support.visibility import is_free_line
from trundle.costmap import Costmap
from trundle.errors import NoPathError
from trundle.geometry import Pose2D
from trundle.planning import GridSearch, create_planner

SMALL = ((0.02, 0.02), (-0.02, 0.02), (-0.02, -0.02), (0.02, -0.02))
LONG = ((0.4, 0.1), (-0.4, 0.1), (-0.4, -0.1), (0.4, -0.1))


def costmap_of(costs, footprint=SMALL, origin=Pose2D(0.0, 0.0)):
    return Costmap(np.asarray(costs, np.uint8), 0.05, origin, footprint, 0.5)


def make_costs(seed):
    """A room with boxes of 253, and lower costs everywhere."""
    rng = np.random.default_rng(seed)
    costs = rng.integers(0, 253, (90, 120)).astype(np.uint8)
    costs[[0, -1]] = costs[:, [0, -1]] = 254
    for _ in range(14):
        row, col = rng.integers(5, 80), rng.integers(5, 110)
        costs[row : row + 9, col : col + 7] = 253
    costs[1:5, 1:5] = costs[-5:-1, -5:-1] = 0
    return costs


@pytest.mark.parametrize("seed", range(5))
def test_the_path_between_centres_of_cells_is_that_of_the_search(seed):
    costs = make_costs(seed)
    costmap, cells = costmap_of(costs, origin=Pose2D(-1.0, 2.0, 0.3)), ((2, 2), (87, 117))
    centres = [costmap.cell_to_world(*cell) for cell in cells]
    start, goal = (Pose2D(float(x), float(y), 0.3) for x, y in centres)
    path = create_planner("any_angle").plan(costmap, start, goal)
    expected = GridSearch(costs >= 253).any_angle_path(*cells)
    assert (path.planner, path.replans) == ("any_angle", 0)
    assert path.cost == pytest.approx(path.length)
    assert path.length == pytest.approx(0.05 * expected.length)


@pytest.mark.parametrize("seed", range(5))
def test_from_and_to_anywhere_in_a_cell_the_path_never_enters_cells_of_253(seed):
    costs = make_costs(seed)
    rng = np.random.default_rng(seed)
    costmap = costmap_of(costs)
    free = np.argwhere(costs < 253)
    for _ in range(4):
        ends = [0.05 * (free[rng.integers(len(free))] + rng.uniform(0.05, 0.95, 2))[::-1] for _ in range(2)]
        start, goal = (Pose2D(float(x), float(y), 0.0) for x, y in ends)
        planner = create_planner("any_angle", max_replans=0)
        try:
            path = planner.plan(costmap, start, goal)
        except NoPathError:
            continue
        back = planner.plan(costmap, goal, start)
        assert back.length == pytest.approx(path.length)
        corners = path.poses[:, :2]
        # The corners of cells are integers here but for rounding.
        near = np.round(corners / 0.05)
        exact = np.where(np.abs(corners / 0.05 - near) < 1e-9, near, corners / 0.05)
        inside = exact[(exact != np.round(exact)).all(axis=1)]
        assert (costs[tuple(np.floor(inside[:, ::-1]).astype(int).T)] < 253).all()


def test_the_exact_path_is_never_longer_than_those_over_cells():
    for seed in range(6):
        costmap = costmap_of(make_costs(seed))
        start, goal = Pose2D(0.125, 0.125), Pose2D(5.875, 4.375)
        exact = create_planner("any_angle").plan(costmap, start, goal).length
        for method in ("astar", "jps"):
            assert exact <= create_planner("astar", method=method).plan(costmap, start, goal).length + 1e-9


def test_where_the_footprint_collides_another_path_is_found():
    # Two gaps: the near one lets the inscribed circle through, but not a long robot that has to turn in it.
    costs = np.zeros((80, 120), np.uint8)
    costs[[0, 1, -2, -1]] = costs[:, [0, 1, -2, -1]] = 254
    costs[2:60, 58:62] = 254
    costmap = costmap_of(costs, LONG)
    path = create_planner("any_angle").plan(costmap, Pose2D(1.5, 1.0, 0.0), Pose2D(4.5, 1.0, 0.0))
    assert path.replans > 0
    assert not costmap.footprint_collides(path.poses).any()


def test_cells_of_253_block_and_those_of_252_do_not():
    costs = np.zeros((40, 60), np.uint8)
    costs[:, 30] = 253
    start, goal = Pose2D(0.5, 1.0), Pose2D(2.5, 1.0)
    with pytest.raises(NoPathError):
        create_planner("any_angle").plan(costmap_of(costs), start, goal)
    costs[:, 30] = 252
    assert create_planner("any_angle").plan(costmap_of(costs), start, goal).length == pytest.approx(2.0)


def test_the_line_oracle_knows_corners_and_diagonal_blocks():
    blocked = np.array([[0, 1], [1, 0]], bool)
    assert not is_free_line(blocked, (0.5, 0.5), (1.5, 1.5))
    assert is_free_line(blocked & [[1, 1], [0, 1]], (0.5, 0.5), (1.5, 1.5))
    assert is_free_line(blocked, (0, 0), (0, 1))
    assert not is_free_line(blocked, (0, 0), (0, 2))
    assert not is_free_line(blocked, (1, 0), (1, 2))
