import dataclasses

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission import Outcome, Trajectory
from trundle.path import Path
from trundle.record import colors
from trundle.record.map_view import MapView
from trundle.record.overlay import describe, draw_plan, draw_run
from trundle.record.page import plain
from trundle.robots import Robot


def has(image, color, at_least=20):
    pixels = np.asarray(image).reshape(-1, 3)
    return int((pixels == color).all(axis=1).sum()) >= at_least


@pytest.fixture(scope="module")
def robot():
    return Robot.load("nova_carter")


@pytest.fixture(scope="module")
def costmap(hall, robot):
    return Costmap.from_grid(hall, robot)


def test_a_run_shows_map_path_speeds_and_both_ends(told, costmap, robot):
    image = draw_run(costmap, robot, told.episode)
    assert image.mode == "RGB"
    assert max(image.size) >= 1000
    for color in (colors.FREE, colors.OCCUPIED, colors.UNKNOWN, colors.PLANNED, colors.START, colors.GOAL, colors.GOOD):
        assert has(image, color)
    assert has(image, colors.speed_color(1.0))


@pytest.mark.parametrize(("outcome", "color"), [(Outcome.COLLIDED, colors.BAD), (Outcome.TIMED_OUT, colors.WARNING)])
def test_a_run_that_failed_is_marked_and_says_why(told, costmap, robot, outcome, color):
    episode = dataclasses.replace(told.episode, outcome=outcome, message="touched a rack")
    assert has(draw_run(costmap, robot, episode), color, 200)
    assert describe(episode)[0] == "touched a rack"
    assert not has(draw_run(costmap, robot, told.episode), color, 200)


def test_a_run_that_never_moved_can_be_drawn(told, costmap, robot):
    trajectory = told.episode.trajectory
    first = Trajectory(**{name: getattr(trajectory, name)[:1] for name in Trajectory.columns()})
    episode = dataclasses.replace(told.episode, trajectory=first, paths=(), outcome=Outcome.NO_PATH)
    assert draw_run(costmap, robot, episode).size[0] > 0


def test_a_plan_shows_the_path_and_the_footprint_at_both_ends(costmap, robot):
    path = Path(np.array([[1.5, 1.5, 0.0], [1.5, 3.0, 1.0], [5.0, 3.0, 0.0]]), cost=12.5, planner="least_cost")
    image = draw_plan(costmap, path, robot)
    for color in (colors.PLANNED, colors.START, colors.GOAL):
        assert has(image, color, 100)
    single = Path(np.array([[1.5, 1.5, 0.0]]))
    assert draw_plan(costmap, single, robot, title="here", lines=["nothing to do"]).size[0] > 0


def test_points_are_drawn_where_the_map_has_them(hall, robot):
    costmap = Costmap.from_grid(hall, robot)
    view = MapView(costmap)
    # A corner of the block is at (3.0, 2.0): occupied right of it and below, free left of it.
    (x, y), *_ = view.to_pixels([(3.0, 2.0)]).round().astype(int)
    pixels = np.asarray(view.finish())
    assert tuple(pixels[y + 3, x + 3]) == colors.OCCUPIED
    assert tuple(pixels[y - 3, x + 3]) != colors.OCCUPIED
    assert tuple(pixels[y + 3, x - 3]) != colors.OCCUPIED


def test_a_turned_map_is_shown_in_its_own_frame(hall, robot):
    turned = OccupancyGrid(hall.data, hall.resolution, Pose2D(10.0, -3.0, 0.7))
    plainly = MapView(Costmap.from_grid(hall, robot)).to_pixels([(3.0, 2.0)])
    point = turned.origin.transform_points([(3.0, 2.0)])
    np.testing.assert_allclose(MapView(Costmap.from_grid(turned, robot)).to_pixels(point), plainly, atol=1e-6)


def test_a_large_map_is_cropped_to_what_matters_and_a_huge_view_merged(robot):
    data = np.zeros((3000, 2500), dtype=np.int8)
    data[1500, 1200:1300] = 100
    costmap = Costmap.from_grid(OccupancyGrid(data, 0.05), robot)
    near = MapView(costmap, np.array([[60.0, 70.0], [66.0, 76.0]]))
    assert 1000 <= max(near.size) <= 2000
    assert near.pixels_per_metre > 60
    whole = MapView(costmap)
    assert 1000 <= max(whole.size) <= 2000
    # One row of occupied cells is still there.
    assert has(whole.finish(), colors.OCCUPIED, 40)


def test_a_tiny_map_is_enlarged_by_whole_pixels(robot):
    view = MapView(Costmap.from_grid(OccupancyGrid(np.zeros((7, 3), dtype=np.int8), 0.05), robot))
    assert view.size[0] % 3 == 0
    assert view.size[1] % 7 == 0
    assert max(view.size) >= 1000


def test_focus_outside_the_map_still_gives_a_picture(costmap):
    assert min(MapView(costmap, np.array([[-50.0, 80.0]])).size) > 0


def test_letters_that_the_font_lacks_are_replaced():
    assert plain("night·shift 창고\n") == "night·shift ???"
