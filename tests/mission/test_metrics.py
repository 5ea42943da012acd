import math

import numpy as np
import pytest

from trundle.costmap import Costmap
from trundle.mission import Trajectory
from trundle.mission.metrics import CLEARANCE_CAP, compute_metrics, cross_track_errors, distances_to_polyline
from trundle.path import Path


def drive(x, y, yaw=None, *, path=0):
    """A trajectory through points, a second apart."""
    n = len(x)
    columns = {name: np.zeros(n) for name in Trajectory.columns()}
    columns.update(time=np.arange(n), x=x, y=y, yaw=np.zeros(n) if yaw is None else yaw, path=np.full(n, path))
    return Trajectory(**columns)


def measure(trajectory, costmap, paths=(), **changes):
    options = {
        "arrived": True,
        "path_length_m": 4.0,
        "planning_s": 0.002,
        "replans": 1,
        "wall_s": 0.5,
        "contacts": (),
    }
    return compute_metrics(trajectory, paths, costmap, **(options | changes))


@pytest.fixture(scope="module")
def costmap(room, carter):
    return Costmap.from_grid(room, carter.outline)


def test_distances_to_a_polyline_are_exact():
    corners = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]])
    points = np.array([[2.0, 1.0], [-3.0, 4.0], [5.0, 1.0], [4.0, 3.0], [7.0, 7.0]])
    np.testing.assert_allclose(distances_to_polyline(points, corners), [1.0, 5.0, 1.0, 0.0, 5.0])


def test_distances_to_a_single_point_and_over_a_repeated_one():
    points = np.array([[3.0, 4.0]])
    np.testing.assert_allclose(distances_to_polyline(points, np.zeros((1, 2))), [5.0])
    np.testing.assert_allclose(distances_to_polyline(points, np.zeros((3, 2))), [5.0])


def test_long_polylines_are_measured_in_parts_with_the_same_result():
    rng = np.random.default_rng(1)
    corners, points = rng.normal(size=(3001, 2)), rng.normal(size=(700, 2))
    together = distances_to_polyline(points, corners)
    alone = np.array([distances_to_polyline(point[None], corners)[0] for point in points[::50]])
    np.testing.assert_array_equal(together[::50], alone)


def test_rows_without_a_path_have_no_cross_track_error():
    path = Path(np.array([[0.0, 0.0, 0.0], [4.0, 0.0, 0.0]]))
    assert cross_track_errors(drive([1.0, 2.0], [0.5, 1.0]), [path]).tolist() == [0.5, 1.0]
    assert len(cross_track_errors(drive([1.0, 2.0], [0.5, 1.0], path=-1), [path])) == 0


def test_spl_is_the_share_of_the_planned_length_and_0_without_success(costmap):
    straight = drive([1.0, 3.0, 6.0], [4.5, 4.5, 4.5])
    assert measure(straight, costmap).spl == pytest.approx(4.0 / 5.0)
    assert measure(straight, costmap, path_length_m=6.0).spl == 1.0
    assert measure(straight, costmap, arrived=False).spl == 0.0


def test_smoothness_is_turning_over_distance_and_turns_in_place_count(costmap):
    yaw = [3.0, -3.0, -3.0 + 0.5]
    turned = (2.0 * math.pi - 6.0) + 0.5
    assert measure(drive([1.0, 2.0, 2.0], [4.5] * 3, yaw), costmap).smoothness_rad_per_m == pytest.approx(turned)
    assert measure(drive([1.0, 1.0, 1.0], [4.5] * 3, yaw), costmap).smoothness_rad_per_m is None


def test_clearance_is_from_the_oriented_footprint(costmap, carter):
    # The room's west wall ends at x = 0.05 m; the tail reaches 0.607 m back.
    assert measure(drive([1.0], [4.5]), costmap).min_clearance_m == pytest.approx(1.0 - 0.607 - 0.05, abs=1e-6)
    assert measure(drive([1.0], [4.5], [math.pi]), costmap).min_clearance_m == pytest.approx(0.95 - 0.14, abs=1e-6)
    assert measure(drive([0.1], [4.5]), costmap).min_clearance_m == 0.0
    assert CLEARANCE_CAP == 2.0


def test_figures_that_are_passed_through(costmap):
    metrics = measure(drive([1.0, 2.0], [4.5, 4.5]), costmap, contacts=("rack_1", "wall"))
    assert metrics.planning_ms == pytest.approx(2.0)
    assert metrics.replans == 1
    assert metrics.real_time_factor == pytest.approx(2.0)
    assert metrics.contacts == ("rack_1", "wall")
