import base64
import io
import math

import numpy as np
import pytest
from PIL import Image

from trundle.evaluation.report.html.world_map import RADIUS, Frame, draw_map, find_clusters
from trundle.geometry import Pose2D
from trundle.maps.grid import OccupancyGrid


def room(rows=40, cols=60, yaw=0.0, edge=0.1):
    data = np.zeros((rows, cols), np.int8)
    data[0], data[-1], data[:, 0], data[:, -1] = 100, 100, 100, 100
    data[5, 7] = -1
    return OccupancyGrid(data, edge, Pose2D(-1.0, 2.0, yaw))


@pytest.mark.parametrize("yaw", [0.0, 0.5, -2.0])
def test_a_cell_lies_in_the_drawing_where_its_point_does(yaw):
    grid = room(yaw=yaw)
    drawn = draw_map(grid)
    x, y = grid.cell_to_world(5, 7)
    column, row = 7.5, drawn.size[1] - 5.5
    a, b, c, d, e, f = drawn.matrix
    assert (a * column + c * row + e, b * column + d * row + f) == pytest.approx((drawn.frame.x(x), drawn.frame.y(y)))


def test_the_picture_has_the_cells_with_north_up():
    picture = Image.open(io.BytesIO(draw_map(room()).png)).convert("L")
    pixels = np.asarray(picture)
    assert pixels[0, 0] < 100
    assert pixels[20, 20] > 240
    assert 100 < pixels[-6, 7] < 240


def test_a_large_map_keeps_its_walls_and_stays_small():
    data = (np.random.default_rng(0).random((3000, 2000)) < 0.02).astype(np.int8) * 100
    data[1000] = 100
    drawn = draw_map(OccupancyGrid(data, 0.05))
    assert len(drawn.png) <= 40_000
    pixels = np.asarray(Image.open(io.BytesIO(drawn.png)).convert("L"))
    assert (pixels < 100).all(axis=1).any()


def test_the_image_is_in_the_page_itself():
    drawn = draw_map(room())
    text = drawn.image("map-0")
    assert base64.b64encode(drawn.png).decode() in text
    assert 'id="map-0"' in text


def test_a_frame_holds_points_even_a_single_one():
    frame = Frame.around([[3.0, 4.0]], margin=2.0)
    assert (frame.x(3.0), frame.y(4.0)) == pytest.approx((500.0, 500.0))
    assert math.isclose(frame.scale, 250.0)


def test_failures_within_2_metres_are_one_cluster_wherever_they_lie():
    for shift in np.linspace(0.0, 2.0, 21):
        clusters = find_clusters(np.array([[0.9, 0.0], [1.1, 0.0], [0.9, 0.3], [9.0, 9.0]]) + shift)
        assert [len(cluster.members) for cluster in clusters] == [3, 1], shift


def test_every_failure_is_in_one_cluster_and_no_two_clusters_are_within_2_metres():
    points = np.random.default_rng(0).uniform(-20.0, 20.0, (500, 2))
    clusters = find_clusters(points)
    assert sorted(member for cluster in clusters for member in cluster.members) == list(range(500))
    centers = np.array([cluster.center for cluster in clusters])
    apart = np.hypot(*(centers[:, None] - centers[None]).T)
    # Squares of 0.5 m are merged by their own means, which a cluster's mean of points equals.
    assert apart[~np.eye(len(centers), dtype=bool)].min() > RADIUS - 1e-9


def test_the_largest_comes_first_and_its_first_member_is_nearest_to_its_centre():
    points = np.array([[0.0, 0.0], [10.0, 0.0], [10.6, 0.0], [10.2, 0.0]])
    first, second = find_clusters(points)
    assert first.members == (3, 1, 2)
    assert second.members == (0,)
    assert find_clusters(np.empty((0, 2))) == []


def test_ten_thousand_failures_all_over_a_map_are_clustered():
    points = np.random.default_rng(1).uniform(0.0, 60.0, (10_000, 2))
    clusters = find_clusters(points)
    assert sum(len(cluster.members) for cluster in clusters) == 10_000
