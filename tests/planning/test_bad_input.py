"""What cannot be used is refused by trundle's own errors: never by the kernels', and never by a crash."""

import math
import tracemalloc

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.errors import BlockedPoseError, InputError, PlanningError, TrundleError
from trundle.geometry import Pose2D
from trundle.maps.grid import OccupancyGrid
from trundle.path import Path
from trundle.planning import (
    GridSearch,
    PathCheck,
    any_angle_path,
    cost_field,
    create_planner,
    create_smoother,
    plan_many,
    planner_names,
)

SMALL = ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1))
FREE = np.zeros((6, 8), np.uint8)
CELLS = [
    None,
    "ab",
    3,
    (1,),
    (1, 2, 3),
    (1.0, 2),
    (math.nan, 1),
    (None, 1),
    ("1", "2"),
    {},
    [[1, 2], [3, 4]],
    [[1, 2], [3]],
    (-1, 0),
    (6, 0),
    (2**70, 0),
    (-(2**70), 0),
    b"ab",
]
MAPS = [
    None,
    "map",
    3,
    [],
    [[]],
    np.zeros((0, 5), bool),
    np.zeros((5, 0), bool),
    np.zeros(5, bool),
    np.zeros((2, 2, 2), bool),
    np.zeros((3, 3), object),
    np.zeros((3, 3), complex),
    np.zeros((3, 3), "U3"),
    [[1, 2], [3]],
    np.zeros((3, 3), [("a", "u1")]),
]
POSES = [
    None,
    "ab",
    3,
    (1,),
    (1, 2, 3, 4),
    (math.nan, 1),
    (math.inf, 1, 0),
    (None, 1),
    ("x", "y"),
    {},
    Pose2D(1e300, 1e300),
    Pose2D(-50.0, 0.0),
    2j,
]


def costmap_of(data, footprint=SMALL):
    return Costmap.from_grid(OccupancyGrid(np.asarray(data, np.int8), 0.05), footprint)


def refused(call):
    """The error of a call that must be refused by one of trundle's."""
    with pytest.raises(TrundleError) as caught:
        call()
    assert "nanobind" not in str(caught.value)
    assert "incompatible function arguments" not in str(caught.value)
    return caught.value


@pytest.mark.parametrize("cell", CELLS, ids=repr)
def test_cells(cell):
    search = GridSearch(FREE)
    for start, goal in ((cell, (0, 0)), ((0, 0), cell)):
        for options in ({}, {"partial": True, "start_tolerance": 2, "goal_tolerance": 2}):
            refused(lambda start=start, goal=goal, options=options: search.shortest_path(start, goal, **options))
            refused(lambda start=start, goal=goal, options=options: search.any_angle_path(start, goal, **options))
        refused(lambda start=start, goal=goal: any_angle_path(FREE, start, goal))
        refused(lambda start=start, goal=goal: search.nearest_reachable(start, goal))
        for many in (search.plan_many, search.any_angle_paths):
            refused(lambda start=start, goal=goal, many=many: many([start, start], [goal, goal]))
    if cell != [[1, 2], [3, 4]]:
        refused(lambda: cost_field(FREE, cell))


@pytest.mark.parametrize("blocked", MAPS, ids=lambda value: repr(value)[:40])
def test_maps(blocked):
    refused(lambda: GridSearch(blocked))
    refused(lambda: any_angle_path(blocked, (0, 0), (1, 1)))
    refused(lambda: cost_field(blocked, (0, 0)))
    search = GridSearch(FREE)
    refused(lambda: search.update(slice(0, 3), slice(0, 4), blocked))


def test_a_mask_that_no_search_looks_at_is_refused():
    masked = np.ma.masked_array(FREE, FREE.copy())  # pyright: ignore[reportUnknownMemberType]
    for call in (
        lambda: GridSearch(masked),
        lambda: any_angle_path(masked, (0, 0), (1, 1)),
        lambda: cost_field(masked, (0, 0)),
    ):
        assert ".filled(value)" in str(refused(call))


@pytest.mark.parametrize("option", [None, "8", 3, 8.5, math.nan, [8], -1])
def test_search_options(option):
    for make in (
        lambda: GridSearch(FREE, option),
        lambda: GridSearch(FREE, method=option),
        lambda: cost_field(FREE, (0, 0), connectivity=option),
    ):
        refused(make)
    search = GridSearch(FREE)
    refused(lambda: search.update(option, option, True)) if option not in (3, None) else None
    for value in (0, -1, 1.5, "2", 10**9):
        for call in (search.plan_many, search.any_angle_paths):
            refused(lambda call=call, value=value: call([(0, 0)], [(1, 1)], threads=value))
        refused(lambda value=value: cost_field(FREE, (0, 0), threads=value))


@pytest.mark.parametrize("deadline", [0, 0.0, -1, math.nan, "1", [], True])
def test_deadlines(deadline):
    search = GridSearch(FREE)
    for call in (search.shortest_path, search.any_angle_path):
        assert isinstance(refused(lambda call=call: call((0, 0), (1, 1), deadline_s=deadline)), InputError)
    for call in (search.plan_many, search.any_angle_paths):
        assert isinstance(refused(lambda call=call: call([(0, 0)], [(1, 1)], deadline_s=deadline)), InputError)
    assert isinstance(refused(lambda: cost_field(FREE, (0, 0), deadline_s=deadline)), InputError)


@pytest.mark.parametrize("name", planner_names())
@pytest.mark.parametrize("pose", POSES, ids=repr)
def test_poses(name, pose):
    costmap, planner, fine = costmap_of(np.zeros((40, 40))), create_planner(name), Pose2D(1.0, 1.0)
    for start, goal in ((pose, fine), (fine, pose)):
        error = refused(lambda start=start, goal=goal: planner.plan(costmap, start, goal))
        if isinstance(error, PlanningError):
            assert error.pose == pose.as_tuple()
            assert error.cell is not None
    for other in (None, np.zeros((4, 4), np.uint8), "map"):
        refused(lambda other=other: planner.plan(other, fine, fine))


@pytest.mark.parametrize("name", [name for name in planner_names() if name != "manhattan_astar"])
@pytest.mark.parametrize("shape", [(1, 1), (1, 40), (40, 1), (12, 12)])
def test_a_footprint_larger_than_the_map(name, shape):
    costmap = costmap_of(np.zeros(shape), ((0.5, 0.4), (-0.5, 0.4), (-0.5, -0.4), (0.5, -0.4)))
    for options in ({}, {"allow_partial": True}):
        with pytest.raises(BlockedPoseError, match="larger than the map of") as caught:
            create_planner(name, **options).plan(costmap, Pose2D(0.02, 0.02), Pose2D(0.03, 0.03))
        assert caught.value.cell == (0, 0)


@pytest.mark.parametrize("name", [name for name in planner_names() if name not in ("manhattan_astar", "hybrid_astar")])
@pytest.mark.parametrize("replans", [1.5, -1, True, "2", None])
def test_counts_of_replans(name, replans):
    assert "max_replans" in str(refused(lambda: create_planner(name, max_replans=replans)))


@pytest.mark.parametrize("path", [None, "path", np.zeros((3, 3)), 3])
def test_what_is_no_path_can_be_neither_checked_nor_smoothed(path):
    refused(lambda: PathCheck(path))
    refused(lambda: create_smoother("constrained").smooth(path, costmap_of(np.zeros((40, 40)))))


@pytest.mark.parametrize("costmap", [None, np.zeros((3, 3), np.uint8)])
def test_what_is_no_costmap_cannot_be_checked_on(costmap):
    path = Path(np.array([[0.5, 0.5, 0.0], [1.0, 0.5, 0.0]]))
    check = PathCheck(path)
    refused(lambda: check.first_hit(costmap))
    refused(lambda: check.cost_from(costmap))
    refused(lambda: create_smoother("constrained").smooth(path, costmap))


@pytest.mark.parametrize("begin", [-1, 22, 1.5, "1", None])
def test_what_is_no_pose_to_check_from(begin):
    check, costmap = PathCheck(Path(np.array([[0.5, 0.5, 0.0], [1.0, 0.5, 0.0]]))), costmap_of(np.zeros((40, 40)))
    assert len(check.poses) == 21
    refused(lambda: check.first_hit(costmap, begin))
    refused(lambda: check.cost_from(costmap, begin))


@pytest.mark.parametrize(
    "costs",
    [
        np.array([[1.0, math.nan]]),
        np.array([[1.0, -1.0]]),
        np.array([[1, -1]]),
        np.array([[1, 70000]]),
        np.array([[1e300, 1.0]]),
        np.array([[1 + 1j, 1]]),
        np.array([["a", "b"]]),
    ],
    ids=str,
)
def test_costs_that_are_none(costs):
    refused(lambda: cost_field(costs, (0, 1)))


@pytest.mark.parametrize("cost", [-1, 70000, -1.5, math.nan])
def test_the_cell_of_an_invalid_cost_is_named(cost):
    costs = np.ones((3, 4), type(cost))
    costs[1, 2] = cost
    assert "(1, 2)" in str(refused(lambda: cost_field(costs, (0, 1))))


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, np.float32])
def test_costs_of_the_kernel_s_own_types_are_not_copied(dtype):
    costs = np.ones((1200, 1000), dtype)
    cost_field(costs[:50], (3, 3))
    tracemalloc.start()
    cost_field(costs, (3, 3))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    # A copy alone takes as much as the costs; the check of float32 two masks of a byte a cell, half as much. Masks that
    # NumPy may elide are not made, as it does not under a sanitizer.
    assert peak < 0.6 * costs.nbytes


def test_other_types_are_converted_and_zero_costs_and_walls_are_right():
    want = cost_field(np.array([[1, 0, 2], [65535, 65535, 3]], np.uint16), (0, 0))
    for costs in ([[1, 0, 2], [65535, 65535, 3]], np.array([[1, 0, 2], [65535, 65535, 3]], np.int64)):
        assert np.array_equal(cost_field(costs, (0, 0)), want)
    swapped = np.array([[1, 0, 2], [65535, 65535, 3]], np.dtype(np.uint16).newbyteorder())
    assert np.array_equal(cost_field(swapped, (0, 0)), want)
    for dtype in (np.float16, np.float32, np.float64, np.dtype(np.float32).newbyteorder()):
        floats = np.array([[1, 0, 2], [math.inf, math.inf, 3]], dtype)
        assert cost_field(floats, (0, 0)) == pytest.approx(want, rel=1e-6)
    assert want[0].tolist() == [0.0, 0.5, 1.5]
    assert np.isinf(want[1, :2]).all()


@pytest.mark.parametrize(
    "view",
    [
        lambda a: a,
        lambda a: a[::-1],
        lambda a: a[:, ::-2],
        lambda a: a.T,
        lambda a: np.asfortranarray(a),
        lambda a: np.broadcast_to(a[0], a.shape),
    ],
)
@pytest.mark.parametrize("dtype", [bool, np.uint8])
def test_blocked_is_read_where_it_lies_whatever_its_strides(view, dtype):
    blocked = view((np.random.default_rng(1).random((1500, 1400)) < 0.2).astype(dtype))
    tracemalloc.start()
    search = GridSearch(blocked)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 100_000
    free = np.argwhere(np.asarray(blocked) == 0)
    copy = GridSearch(np.ascontiguousarray(blocked))
    assert search.shortest_path(free[0], free[-1]) == copy.shortest_path(free[0], free[-1])


@pytest.mark.parametrize("other", [None, 3, object()])
def test_what_is_no_planner_and_no_smoother(other):
    for make in (create_planner, create_smoother, lambda planner: plan_many(planner, costmap_of(FREE), [], [])):
        assert " is a name, an object with " in str(refused(lambda make=make: make(other)))
    with pytest.raises(InputError, match="takes no option 'goal_tolerance': give its class or its name"):
        create_planner(create_planner("astar"), goal_tolerance=1.0)
