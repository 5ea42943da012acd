import dataclasses

import numpy as np
import pytest
from PIL import Image

from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.maps import KeepoutMask, OccupancyGrid, SpeedMask
from trundle.mission import Outcome, Trajectory
from trundle.path import Path
from trundle.pictures import colors
from trundle.pictures.figure import plain
from trundle.record.map_view import MapView, SpeedZones, zone_marks
from trundle.record.overlay import describe, draw_paths, draw_plan, draw_run
from trundle.record.page import Mark, compose_page
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


def test_a_run_shows_map_path_speeds_and_both_ends(recorded, costmap, robot):
    image = draw_run(costmap, robot, recorded.episode)
    assert image.mode == "RGB"
    assert max(image.size) >= 1000
    for color in (colors.FREE, colors.OCCUPIED, colors.UNKNOWN, colors.PLANNED, colors.START, colors.GOAL, colors.GOOD):
        assert has(image, color)
    assert has(image, colors.speed_color(1.0))


@pytest.mark.parametrize(("outcome", "color"), [(Outcome.COLLIDED, colors.BAD), (Outcome.TIMED_OUT, colors.WARNING)])
def test_a_run_that_failed_is_marked_and_says_why(recorded, costmap, robot, outcome, color):
    episode = dataclasses.replace(recorded.episode, outcome=outcome, message="touched a rack")
    assert has(draw_run(costmap, robot, episode), color, 200)
    assert describe(episode)[0] == "touched a rack"
    assert not has(draw_run(costmap, robot, recorded.episode), color, 200)


def believed(trajectory, shift, states=None):
    """The trajectory with an estimate that is off by a shift [m], and with states of the localizer."""
    localization = np.zeros(len(trajectory), dtype=np.int64) if states is None else states
    return dataclasses.replace(trajectory, estimate_y=trajectory.y + shift, localization=localization)


def test_the_estimated_trajectory_is_drawn_where_it_is_not_the_true_one(recorded, costmap, robot):
    trajectory = recorded.episode.trajectory
    assert not has(draw_run(costmap, robot, recorded.episode), colors.ESTIMATED, 1)
    episode = dataclasses.replace(recorded.episode, trajectory=believed(trajectory, 0.3))
    assert has(draw_run(costmap, robot, episode), colors.ESTIMATED, 1000)


def test_a_correction_of_the_estimate_is_not_drawn_as_a_path(recorded, costmap, robot):
    trajectory = recorded.episode.trajectory
    y = trajectory.y + 0.3
    y[::2] -= 5.0  # every step is a jump
    jumping = dataclasses.replace(trajectory, estimate_y=y)
    legend_alone = draw_run(costmap, robot, dataclasses.replace(recorded.episode, trajectory=jumping))
    smooth = draw_run(costmap, robot, dataclasses.replace(recorded.episode, trajectory=believed(trajectory, 0.3)))
    count = [int((np.asarray(one) == colors.ESTIMATED).all(axis=2).sum()) for one in (legend_alone, smooth)]
    assert 0 < count[0] < 0.2 * count[1]


def test_where_the_robot_was_lost_is_marked(recorded, costmap, robot):
    trajectory = recorded.episode.trajectory
    states = np.zeros(len(trajectory), dtype=np.int64)
    third = len(states) // 3
    states[third : 2 * third], states[2 * third :] = 1, 2
    episode = dataclasses.replace(recorded.episode, trajectory=believed(trajectory, 0.02, states))
    image = draw_run(costmap, robot, episode)
    assert has(image, colors.BAD, 200)
    assert has(image, colors.WARNING, 200)
    sure = dataclasses.replace(recorded.episode, trajectory=believed(trajectory, 0.02))
    assert not has(draw_run(costmap, robot, sure), colors.BAD, 1)


def test_a_run_that_never_moved_can_be_drawn(recorded, costmap, robot):
    trajectory = recorded.episode.trajectory
    first = Trajectory(**{name: getattr(trajectory, name)[:1] for name in Trajectory.columns()})
    episode = dataclasses.replace(recorded.episode, trajectory=first, paths=(), outcome=Outcome.NO_PATH)
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


def test_zones_of_masks_are_drawn_and_listed_in_the_legend(hall, robot):
    rows, cols = hall.shape
    painted = np.zeros((rows, cols), dtype=np.int8)
    painted[:, : cols // 4] = 100
    keepout = KeepoutMask(OccupancyGrid(painted, hall.resolution, hall.origin))
    painted[:, : cols // 4] = 40
    limits = SpeedMask(OccupancyGrid(painted[:, ::-1], hall.resolution, hall.origin))
    costmap = Costmap.from_grid(hall, robot, keepout=keepout)
    single = Path(np.array([[1.5, 1.5, 0.0]]))
    plainly = np.asarray(MapView(Costmap.from_grid(hall, robot)).finish())
    zones = SpeedZones(limits, robot.limits.linear_speed)
    seen = np.asarray(MapView(costmap, zones=zones).finish())
    pixels = plainly.shape[1]
    assert (seen[:, : pixels // 5] == colors.KEPT_OUT).all()
    free = (plainly[:, -pixels // 5 :] == colors.FREE).all(axis=2)
    assert free.any()
    assert (seen[:, -pixels // 5 :][free] == zones.marks()[0].color).all()
    assert (seen[:, pixels // 2] == plainly[:, pixels // 2]).all()
    assert [mark.text for mark in zone_marks(costmap, zones)] == ["kept out", "up to 0.32 m/s"]
    assert zone_marks(Costmap.from_grid(hall, robot), None) == []
    several = draw_paths(costmap, robot, {"one": single}, speed_mask=limits)
    for picture in (draw_plan(costmap, single, robot, speed_mask=limits), several):
        assert has(picture, zones.marks()[0].color, 100)
        assert has(picture, colors.KEPT_OUT, 100)


def test_many_limits_are_shown_as_a_range(robot):
    mask = SpeedMask(OccupancyGrid(np.array([[0, 10, 50, 100]], dtype=np.int8), 0.1))
    assert [mark.text for mark in SpeedZones(mask, 1.0).marks()] == ["up to 0.1 to 1 m/s"]
    nothing = SpeedMask(OccupancyGrid(np.zeros((1, 1), dtype=np.int8), 0.1))
    assert SpeedZones(nothing, 1.0).marks() == []


def test_zones_show_on_a_map_that_is_drawn_with_several_cells_a_pixel(robot):
    grid = OccupancyGrid(np.zeros((300, 300), dtype=np.int8), 0.05)
    painted = OccupancyGrid(np.full((2, 2), 50, dtype=np.int8), 2.0, Pose2D(8.0, 0.0))
    view = MapView(Costmap.from_grid(grid, robot), long_side=50, max_side=60, zones=SpeedZones(SpeedMask(painted), 1.0))
    pixels = np.asarray(view.finish())
    (x, y), (x1, y1) = view.to_pixels([(9.0, 1.0), (5.0, 1.0)]).astype(int)
    assert tuple(pixels[y, x]) == SpeedZones(SpeedMask(painted), 1.0).marks()[0].color
    assert tuple(pixels[y1, x1]) == colors.FREE


def test_a_legend_of_many_entries_goes_on_below_and_loses_none(costmap, robot):
    single = Path(np.array([[1.5, 1.5, 0.0]]))
    few = draw_paths(costmap, robot, {"one": single})
    marks = [Mark("line", (index, 200, 100), f"planner number {index}") for index in range(20)]
    page = compose_page(
        Image.new("RGB", (400, 300)), title="", status=None, lines=[], legend=marks, pixels_per_metre=50
    )
    assert all(has(page, mark.color, 26 * 6) for mark in marks)
    several = draw_paths(costmap, robot, {mark.text: single for mark in marks})
    assert several.width == few.width
    assert several.height > few.height


def test_paths_on_each_other_are_all_seen(costmap, robot):
    """Striped: of five equal paths and one that leaves them, every colour is seen over a fair part of the length."""
    common = Path(np.array([[1.0, 1.0, 0.0], [2.5, 1.2, 0.0], [2.5, 3.5, 0.0]]))
    away = Path(np.array([[1.0, 1.0, 0.0], [2.5, 1.2, 0.0], [2.7, 3.5, 0.0], [4.0, 3.5, 0.0]]))
    paths = {str(number): common for number in range(5)} | {"away": away}
    pixels = np.asarray(draw_paths(costmap, robot, paths))[120:900]
    counts = [int((pixels == color).all(axis=-1).sum()) for color in colors.SEVERAL[:6]]
    assert min(counts[:5]) > 0.5 * max(counts[:5]) > 100
    assert counts[5] > counts[4]
    alone = np.asarray(draw_paths(costmap, robot, {"one": common}))[120:900]
    assert (alone == colors.SEVERAL[0]).all(axis=-1).sum() > sum(counts[:5])


def test_paths_that_end_outside_the_map_or_have_one_pose_are_drawn(costmap, robot):
    one, far = Path(np.array([[1.5, 1.5, 0.0]])), Path(np.array([[1.5, 1.5, 0.0], [-3.0, 1.5, 0.0], [-3.0, 9.0, 0.0]]))
    assert has(draw_paths(costmap, robot, {"one": one, "far": far}), colors.SEVERAL[1], 100)
