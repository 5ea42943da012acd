"""What notebooks show for values: one line of text, and a picture with north up."""

import io
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image

import trundle
from trundle.costmap import LETHAL, Costmap
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.maps import HeightField, KeepoutMask, OccupancyGrid
from trundle.mission import Scenario, run
from trundle.observation import Scan
from trundle.path import Path
from trundle.pictures.cells import lay_cells
from trundle.pictures.colors import (
    BACKED,
    COST_ORDER,
    FREE,
    GOAL,
    KEPT_OUT,
    LINE,
    OCCUPIED,
    PAGE,
    START,
    UNKNOWN,
    WARNING,
    cost_palette,
)
from trundle.pictures.plan import Plan
from trundle.planning import GridSearch
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World
from trundle.worlds.movers import Crowd, Mover, Waypoints

SQUARE = [(0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2)]


def picture(value):
    image = Image.open(io.BytesIO(value._repr_png_()))
    assert image.format == "PNG"
    assert image.mode == "RGB"
    assert min(image.size) >= 32
    assert max(image.size) <= 1000
    return np.asarray(image)


def places(pixels, color):
    """Middle (x, y) of the pixels of a colour, and how many there are."""
    rows, cols = np.nonzero((pixels == color).all(axis=-1))
    assert len(rows) > 0, color
    return cols.mean(), rows.mean(), len(rows)


def marked(shape, **cells):
    data = np.zeros(shape, dtype=np.int8)
    for value, (row, col) in cells.items():
        data[row, col] = {"occupied": 100, "unknown": -1}[value]
    return data


def test_a_grid_is_shown_with_north_up_and_east_to_the_right():
    grid = OccupancyGrid(marked((20, 30), occupied=(0, 0), unknown=(19, 29)), 0.1)
    pixels = picture(grid)
    x, y, count = places(pixels, OCCUPIED)
    right, top, others = places(pixels, UNKNOWN)
    assert x < right
    assert top < y
    assert count == others == round(count**0.5) ** 2  # squares of whole pixels


def test_a_turned_grid_is_shown_turned():
    """By a quarter turn to the left, the row along x goes up."""
    data = marked((4, 9), occupied=(0, 0), unknown=(0, 8))
    upright = picture(OccupancyGrid(data, 0.1, Pose2D(5.0, -3.0, np.pi / 2.0)))
    x, y, _ = places(upright, OCCUPIED)
    other_x, other_y, _ = places(upright, UNKNOWN)
    assert other_y < y
    assert x == pytest.approx(other_x, abs=2.0)


@pytest.mark.parametrize("shape", [(1, 1), (1, 5000), (5000, 1), (3, 2)])
def test_grids_of_any_shape_have_a_picture(shape):
    picture(OccupancyGrid(np.zeros(shape, dtype=np.int8), 0.05))
    picture(OccupancyGrid(np.full(shape, -1, dtype=np.int8), 1e-3, Pose2D(1e6, -1e6, 1.0)))


@pytest.mark.slow
@pytest.mark.parametrize("yaw", [0.0, 0.7])
def test_no_wall_is_lost_in_a_large_map(yaw):
    data = np.zeros((8192, 8192), dtype=np.int8)
    data[:, 5000] = 100
    data[:, 5001:] = -1
    pixels = picture(OccupancyGrid(data, 0.05, Pose2D(0.0, 0.0, yaw)))
    count = (pixels == OCCUPIED).all(axis=-1).sum()
    assert 600 < count < 2400


def test_a_costmap_shows_inflation_unknown_cells_and_what_is_kept_out():
    data = marked((60, 60), occupied=(30, 30))
    data[:, :10] = -1
    zone = np.zeros((60, 60), dtype=np.int8)
    zone[50:, 50:] = 100
    grid = OccupancyGrid(data, 0.05)
    mask = KeepoutMask(OccupancyGrid(zone, 0.05))
    pixels = picture(Costmap.from_grid(grid, SQUARE, keepout=mask, unknown="costly"))
    x, y, _ = places(pixels, KEPT_OUT)
    middle_x, middle_y, _ = places(pixels, OCCUPIED)
    assert (x > middle_x, y < middle_y) == (True, True)
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 50  # shades of inflation


def test_a_path_is_shown_from_its_start_to_its_goal():
    path = Path([(0, 0, 0), (2, 0, 0), (1, 1, 0)], backward=[False, True], planner="hybrid_astar")
    pixels = picture(path)
    x, y, _ = places(pixels, START)
    goal_x, goal_y, _ = places(pixels, GOAL)
    assert (x < goal_x, goal_y < y) == (True, True)
    places(pixels, LINE)
    places(pixels, BACKED)


@pytest.mark.parametrize(
    "poses", [[(3, 4, 1)], [(0, 0, 0), (0, 0, 2)], [(0, 0, 0), (1e4, 0, 0)], [(0, 0, 0), (0, 9, 0)]]
)
def test_paths_of_any_extent_have_a_picture(poses):
    picture(Path(poses))


def test_a_world_is_shown_from_above():
    solids = (
        Solid("red", Box((1.0, 1.0, 0.5)), Pose3D((0.0, 0.0, 0.25)), (1.0, 0.0, 0.0, 1.0)),
        Solid("under", Box((0.4, 0.4, 0.2)), Pose3D((0.0, 0.0, 0.1)), (0.0, 0.0, 1.0, 1.0)),
        Solid("green", Cylinder(0.5, 0.5), Pose3D((3.0, 2.0, 0.25)), (0.0, 1.0, 0.0, 1.0)),
        Solid("roof", Box((9.0, 9.0, 0.1)), Pose3D((0.0, 0.0, 2.5)), (1.0, 0.0, 1.0, 1.0)),
    )
    pixels = picture(World("hall", solids, seeds=((1.5, 0.0),))).astype(int)
    red = (pixels[..., 0] > 150) & (pixels[..., 1:].max(axis=-1) < 30)
    green = (pixels[..., 1] > 150) & (pixels[..., (0, 2)].max(axis=-1) < 30)
    blue = (pixels[..., 2] > 150) & (pixels[..., :2].max(axis=-1) < 30)
    assert red.sum() > 500
    assert green.sum() == pytest.approx(red.sum() * np.pi / 4.0, rel=0.1)
    assert blue.sum() == 0  # under the red one
    rows, cols = np.nonzero(red)
    other_rows, other_cols = np.nonzero(green)
    assert cols.mean() < other_cols.mean()
    assert other_rows.mean() < rows.mean()
    assert not ((pixels[..., 0] > 150) & (pixels[..., 2] > 150) & (pixels[..., 1] < 50)).any()


@pytest.mark.slow
def test_worlds_of_every_shape_have_a_picture():
    picture(World("empty", ()))
    picture(World("seed", (), seeds=((1.0, 2.0),)))
    vertices = np.array([[0, 0, 0], [2, 0, 0], [0, 2, 1.0]])
    mesh = Mesh(vertices, np.array([[0, 2, 1]], dtype=np.int32))
    picture(World("mesh", (Solid("m", mesh), Solid("s", Sphere(0.3)))))
    blocked = np.zeros((300, 400), dtype=np.bool_)
    blocked[0, :] = blocked[:, -1] = True
    cells = Solid("c", OccupancyCells(blocked, 0.05, 1.0), Pose3D((1.0, 2.0, 0.0)), (1.0, 0.0, 0.0, 1.0))
    pixels = picture(World("cells", (cells,))).astype(int)
    x, y = np.nonzero((pixels[..., 0] > 120) & (pixels[..., 1] < 30))[::-1]
    assert y.max() - y.min() > 400  # the wall in the east, all of it
    assert x.mean() > pixels.shape[1] / 2
    assert y.mean() > pixels.shape[0] / 2


def test_one_wall_of_a_large_map_is_seen_in_its_world():
    blocked = np.zeros((6000, 6000), dtype=np.bool_)
    blocked[:, 2000] = True
    world = World("large", (Solid("c", OccupancyCells(blocked, 0.05, 1.0), color=(1.0, 0.0, 0.0, 1.0)),))
    pixels = picture(world).astype(int)
    seen = (pixels[..., 0] - pixels[..., 1] > 40).any(axis=1)
    assert seen.sum() > 500


@pytest.mark.parametrize("name", ["nova_carter", "turtlebot3_burger", "jackal"])
def test_a_robot_is_shown_from_above(name):
    robot = Robot.load(name)
    pixels = picture(robot)
    ink = (pixels.astype(int).max(axis=-1) < 80).sum()
    assert ink > 500  # wheels


@pytest.fixture(scope="module")
def episode():
    grid = OccupancyGrid(np.zeros((80, 80), dtype=np.int8), 0.1)
    robot = Robot.load("nova_carter")
    with simulate(World.from_map(grid), robot, backend="kinematic") as sim:
        return run(sim, trundle.Navigator(grid, robot), (2.0, 2.0, 0.0), [(4.0, 2.0), (6.0, 6.0, 1.0)], name="hall")


def test_a_run_is_shown_on_its_costmap(episode):
    pixels = picture(episode)
    x, y, _ = places(pixels, START)
    goal_x, goal_y, _ = places(pixels, GOAL)
    assert (x < goal_x, goal_y < y) == (True, True)
    assert places(pixels, FREE)[2] > 10_000
    assert (picture(replace(episode, costmap=None)) == FREE).all(axis=-1).sum() < 1_000


@pytest.mark.parametrize("turned", [0.0, 0.5])
def test_cells_lie_where_they_are_in_a_plan(turned):
    costs = np.zeros((20, 40), dtype=np.uint8)
    costs[12, 30] = LETHAL
    origin = Pose2D(-1.0, 0.5, turned)
    plan = Plan([(-2.0, -1.0), (5.0, 5.0)])
    lay_cells(plan, costs, cost_palette(), COST_ORDER, 0.1, origin)
    (x, y), expected = places(np.asarray(plan.finish()), OCCUPIED)[:2], origin.transform_points([[3.05, 1.25]])
    np.testing.assert_allclose((x, y), plan.to_pixels(expected)[0], atol=1.0)


def test_a_single_obstacle_shows_where_a_pixel_is_larger_than_a_cell():
    pictures = []
    for value in (0, LETHAL):
        costs = np.zeros((2000, 2000), dtype=np.uint8)
        costs[701, 903] = value
        plan = Plan([(0.0, 0.0), (20.0, 20.0)], long_side=100)
        lay_cells(plan, costs, cost_palette(), COST_ORDER, 0.01, Pose2D(0.0, 0.0))
        pictures.append(np.asarray(plan.finish()))
    rows, cols = np.nonzero((pictures[0] != pictures[1]).any(axis=-1))
    assert len(rows) > 0
    np.testing.assert_allclose((cols.mean(), rows.mean()), plan.to_pixels([(9.035, 7.015)])[0], atol=1.0)


def test_a_run_that_was_loaded_is_shown_by_its_overlay(tmp_path):
    from trundle.record.run_folder import RunFolder

    scenario = Scenario.make(world={"name": "warehouse", "options": {"size": [14, 11]}}, backend="kinematic", seed=5)
    with scenario.build() as mission, RunFolder(tmp_path, video=False) as record:
        mission.run(observers=[record])
    loaded = trundle.Episode.load(tmp_path)
    with Image.open(tmp_path / "overlay.png") as overlay:
        ratio = overlay.width / overlay.height
    pixels = picture(loaded)
    assert pixels.shape[1] / pixels.shape[0] == pytest.approx(ratio, rel=0.01)
    (tmp_path / "overlay.png").write_bytes(b"no picture")
    assert picture(loaded).shape != pixels.shape


def test_values_have_a_repr_of_one_line(episode):
    grid = OccupancyGrid(np.zeros((384, 512), dtype=np.int8), 0.05, Pose2D(-1.5, 2.0, 0.0))
    path = Path([(0, 0, 0), (3, 4, 1.5)], planner="astar", status="partial", remaining_m=1.25)
    texts = (
        (grid, "OccupancyGrid(512 x 384 cells of 0.05 m, 25.6 x 19.2 m, origin (-1.5, 2, 0))"),
        (
            Costmap.from_grid(grid, SQUARE, 0.55),
            "Costmap(512 x 384 cells of 0.05 m, 25.6 x 19.2 m, inflation 0.55 m, unknown blocked)",
        ),
        (path, "Path(5 m, 2 poses, (0, 0, 0) to (3, 4, 1.5), by astar, partial: 1.25 m remain)"),
        (World("hall", (Solid("a", Box((2.0, 1.0, 0.5))),)), "World('hall', 1 solid, 2 x 1 x 0.5 m)"),
        (Robot.load("nova_carter"), "Robot('nova_carter', 0.747 x 0.5 x 0.62 m, 57.49 kg, up to 0.8 m/s)"),
        (HeightField(np.zeros((3, 4)), 0.1), "HeightField(4 x 3 samples 0.1 m apart, origin (0.0, 0.0))"),
    )
    for value, text in texts:
        assert repr(value) == text
    assert str(Robot.load("jackal")) == repr(Robot.load("jackal"))
    scenario = Scenario.make(world="office", seed=3)
    assert repr(scenario) == "Scenario('nova_carter-office', nova_carter in office, mujoco, seed 3)"
    assert repr(episode).startswith("Episode('hall', arrived, ")
    assert repr(episode.trajectory) == f"Trajectory({len(episode.trajectory)} rows, 0 to {episode.metrics.time_s:g} s)"
    assert len(repr(episode)) < 120
    search = GridSearch(np.zeros((30, 30), dtype=np.uint8))
    assert repr(search.shortest_path((0, 0), (0, 9))) == "GridPath(found, 9 cells, 2 corners)"
    assert repr(search.plan_many([(0, 0)] * 3, [(0, 9)] * 3)) == "GridPaths(3 paths, 3 found)"
    assert repr(search.any_angle_paths([(0, 0)], [(3, 4)])) == "PointPaths(1 paths, 1 found)"
    scan = Scan("front", 0.5, Pose2D(0.0, 0.0), 0.4, np.zeros(3), np.array([1.0, np.inf, 2.0]), 0.1, 10.0)
    assert repr(scan) == "Scan('front', 0.5 s, 3 beams, 2 hits)"
    navigator = trundle.Navigator(OccupancyGrid(np.zeros((40, 40), dtype=np.int8), 0.1), "jackal")
    assert repr(navigator) == "Navigator(jackal, auto, regulated_pure_pursuit, no goal, idle)"
    navigator.set_goal(1.0, 2.0)
    assert repr(navigator) == "Navigator(jackal, auto, regulated_pure_pursuit, Goal(x=1.0, y=2.0), driving)"


def test_free_cells_are_light():
    pixels = picture(OccupancyGrid(np.zeros((10, 10), dtype=np.int8), 0.05))
    assert places(pixels, FREE)[2] > 10_000
    assert places(pixels, PAGE)[2] > 10_000


def test_a_world_shows_its_movers_where_they_start_and_where_they_go():
    walls = tuple(Solid(f"wall_{side}", Box((0.2, 10.0, 1.0)), Pose3D((side, 0.0, 0.5))) for side in (-6.0, 6.0))
    cart = (Solid("body", Box((1.0, 0.6, 1.0)), Pose3D((0.0, 0.0, 0.5))),)
    mover = Mover("cart", cart, Waypoints(((0.0, -3.0, 2.0), (8.0, 3.0, 2.0))))
    plain = picture(World("hall", walls)).astype(int)
    moving = picture(World("hall", walls, movers=(mover, Crowd("people", 2)))).astype(int)
    shown = abs(moving - WARNING).sum(axis=2) < 30
    assert (abs(plain - WARNING).sum(axis=2) < 30).sum() == 0
    assert np.ptp(np.flatnonzero(shown.any(axis=0))) > 0.3 * moving.shape[1]
