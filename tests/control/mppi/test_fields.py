import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from support.mppi_values import arguments_of
from trundle import _core
from trundle.control.mppi.fields import FieldStyle, Window, cover_with_discs
from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps import KeepoutMask, OccupancyGrid
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
NOTHING = np.zeros((0, 5))


def costmap_of(cells, yaw=0.0, resolution=0.05, **options):
    return Costmap.from_grid(OccupancyGrid(cells, resolution, Pose2D(-1.0, 2.0, yaw)), CARTER, **options)


def window_of(costmap, half=40, style=None, left_out=NOTHING):
    middle = costmap.shape[0] // 2, costmap.shape[1] // 2
    return Window(costmap, middle, half, style or FieldStyle(0.28, 2.0, 0.3), left_out)


def kernel_touches(window, x, y, discs, yaw=0.0):
    """How many discs the kernel finds to touch something at a pose in the window."""
    kernel = _core.Mppi(128, 2, 1)
    model = np.array([0.05, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0])
    arguments = arguments_of(
        np.array([x, y, yaw, 0.0, 0.0, 0.0, 0.0]),
        np.zeros((2, 2), np.float32),
        model,
        np.array([0.1, 0.1, 0.1, 0.0, 0.0]),
        discs,
        window.nearness,
        np.zeros(window.nearness.shape, np.float32),
        window.resolution,
        window.unit,
        np.array([0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0]),
        np.zeros((0, 7)),
        np.ones(15),
        np.array([0.3, 0.3, 1.0, 0.3, 1.0]),
    )
    return kernel.step(*arguments)[8]


@settings(max_examples=40)
@given(st.integers(0, 10_000), st.floats(0.1, 1.2), st.sampled_from([0.02, 0.05, 0.1]), st.floats(0.0, 0.05))
def test_the_cost_to_go_is_never_more_permissive_than_the_discs(seed, size, resolution, share):
    rng = np.random.default_rng(seed)
    cells = np.where(rng.random((90, 90)) < share**2, np.int8(100), np.int8(0))
    robot = CARTER.model_copy(update={"footprint": (size * CARTER.outline).tolist()})
    discs = cover_with_discs(robot.planar)
    style = FieldStyle(float(discs[:, 1].max()), 2.0, 0.3)
    window = window_of(costmap_of(cells, resolution=resolution), half=30, style=style)
    field = window.cost_to_go(np.array([[30.5, 30.5]]) * resolution, np.zeros(1), (0.0, 0.0), math.inf)
    reached = np.argwhere(np.isfinite(field))
    for row, col in reached[rng.permutation(len(reached))[:20]]:
        x, y = (col + rng.uniform(0.01, 0.99)) * resolution, (row + rng.uniform(0.01, 0.99)) * resolution
        widest = np.array([[0.0, style.radius]])
        assert kernel_touches(window, x, y, widest) == 0
        # Driven straight through reached cells, all discs are free.
        yaw = rng.uniform(-math.pi, math.pi)
        centres = np.column_stack([x + discs[:, 0] * math.cos(yaw), y + discs[:, 0] * math.sin(yaw)])
        rows, cols = window.cells_of(centres)
        inside = window.inside(rows, cols)
        if inside.all() and np.isfinite(field[rows, cols]).all():
            assert kernel_touches(window, x, y, discs, yaw) == 0
            assert window.discs_fit(np.array([[x, y, yaw]]), discs)[0]


def test_nearness_is_the_distance_to_the_nearest_obstacle():
    cells = np.zeros((101, 101), np.int8)
    cells[50, 50] = 100
    window = window_of(costmap_of(cells), half=40)
    x, y = 40.5 * 0.05, 40.5 * 0.05
    for cells_away in (1, 3, 10, 20):
        assert window.clearance_at(np.array([[x + cells_away * 0.05, y]]))[0] == pytest.approx(
            (cells_away - 0.5) * 0.05, abs=window.unit
        )
    assert window.nearness[40, 40] == 254


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.5])
def test_a_map_with_a_yaw_is_the_same_in_its_window(yaw):
    rng = np.random.default_rng(1)
    cells = np.where(rng.random((120, 120)) < 0.01, np.int8(100), np.int8(0))
    plain, turned = window_of(costmap_of(cells)), window_of(costmap_of(cells, yaw))
    assert np.array_equal(plain.nearness, turned.nearness)
    here = turned.costmap.origin @ Pose2D(3.0, 2.5, 0.4)
    assert turned.pose_in(here) == pytest.approx(plain.pose_in(plain.costmap.origin @ Pose2D(3.0, 2.5, 0.4)))
    back = turned.poses_out(np.array([turned.pose_in(here)]))[0]
    assert (back[0], back[1]) == pytest.approx((here.x, here.y))
    assert math.cos(back[2] - here.yaw) == pytest.approx(1.0)


def test_beyond_the_map_everything_is_occupied():
    window = window_of(costmap_of(np.zeros((21, 21), np.int8)), half=30)
    assert (window.nearness[:10] == 254).all()
    assert window.nearness[30, 30] < 254


def test_what_is_just_outside_of_the_window_counts_in_it():
    cells = np.zeros((121, 121), np.int8)
    cells[:, 60 + 22] = 100
    window = window_of(costmap_of(cells), half=20)
    assert window.nearness[20, 40] > 0


def test_obstacles_that_move_are_left_out():
    cells = np.zeros((301, 301), np.int8)
    cells[148:153, 148:153] = 100
    costmap = costmap_of(cells)
    (x,), (y,) = (np.atleast_1d(value) for value in costmap.cell_to_world(150, 150))
    assert window_of(costmap).nearness.max() == 254
    assert window_of(costmap, left_out=np.array([[x, y, x, y, 0.3]])).nearness.max() == 0
    far = window_of(costmap, left_out=np.array([[x + 50.0, y, x + 50.0, y, 0.3]]))
    assert far.nearness.max() == 254


@pytest.mark.parametrize("yaw", [0.0, 0.7, -2.5])
def test_obstacles_are_left_out_all_along_a_capsule_and_not_beyond(yaw):
    costmap = costmap_of(np.full((301, 301), 100, np.int8), yaw)
    window = window_of(costmap)
    ends = window.poses_out(np.array([[1.0, 1.2, 0.0], [2.6, 2.4, 0.0]]))[:, :2]
    window = window_of(costmap, left_out=np.array([[*ends[0], *ends[1], 0.4]]))
    rows, cols = np.indices(window.nearness.shape)
    x, y = (cols + 0.5) * 0.05, (rows + 0.5) * 0.05
    along = np.clip(((x - 1.0) * 1.6 + (y - 1.2) * 1.2) / 4.0, 0.0, 1.0)
    distance = np.hypot(x - 1.0 - 1.6 * along, y - 1.2 - 1.2 * along)
    occupied = window.nearness == 254
    assert not occupied[distance < 0.4 - 1e-6].any()
    assert occupied[distance > 0.4 + 1e-6].all()


def test_costs_of_a_mask_and_of_unseen_space_lengthen_the_path():
    cells = np.zeros((81, 81), np.int8)
    half_unseen = cells.copy()
    half_unseen[:, :40] = -1
    mask = np.zeros((81, 81), np.int8)
    mask[:, :40] = 60
    free = window_of(costmap_of(cells), half=30)
    unseen = window_of(costmap_of(half_unseen, unknown="costly"), half=30)
    masked = window_of(costmap_of(cells, keepout=KeepoutMask(OccupancyGrid(mask, 0.05, Pose2D(-1.0, 2.0)))), half=30)
    seed = np.array([[55.5, 30.5]]) * 0.05
    plain, *others = (window.cost_to_go(seed, np.zeros(1), (0.0, 0.0), math.inf) for window in (free, unseen, masked))
    for other in others:
        assert other[30, 40] == pytest.approx(plain[30, 40])
        assert other[30, 5] > plain[30, 5] + 0.3


def test_the_cost_to_go_leads_round_a_wall():
    cells = np.zeros((101, 101), np.int8)
    cells[30:101, 50] = 100
    window = window_of(costmap_of(cells), half=50)
    field = window.cost_to_go(np.array([[80.5, 50.5]]) * 0.05, np.zeros(1), (0.0, 0.0), math.inf)
    assert field[50, 20] > math.hypot(30, 30) * 0.05 * 1.7
    assert np.isinf(field[50, 50])
