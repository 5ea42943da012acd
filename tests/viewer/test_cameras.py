import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from trundle.errors import InputError, UnknownNameError
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot
from trundle.viewer.cameras import Camera, aim
from trundle.viewer.scene_model import SceneModel
from trundle.worlds import World
from trundle.worlds.generators.warehouse import generate_warehouse

CARTER = Robot.load("nova_carter")
EMPTY = World("empty", ())


def all_clear(*_):
    return True


def project(camera, points, aspect):
    """Places of points in the picture, each from −1 to 1 where they are inside."""
    right, up, forward = camera.axes() @ (np.asarray(points) - camera.eye).T
    half = math.tan(math.radians(camera.fovy_deg) / 2.0)
    return np.stack([right / forward / half / aspect, up / forward / half], axis=1)


@given(st.floats(-math.pi, math.pi), st.floats(-1.5, 1.5), st.floats(0.1, 100.0))
def test_axes_are_a_right_handed_frame_that_looks_at_the_target(azimuth, elevation, distance):
    eye = -distance * np.array(
        [math.cos(azimuth) * math.cos(elevation), math.sin(azimuth) * math.cos(elevation), math.sin(elevation)]
    )
    camera = Camera(tuple(eye), (0.0, 0.0, 0.0))
    axes = camera.axes()
    assert np.allclose(axes @ axes.T, np.eye(3), atol=1e-9)
    assert np.allclose(np.cross(axes[0], axes[1]), -axes[2], atol=1e-9)
    assert np.allclose(axes[2], -eye / distance, atol=1e-6)


@pytest.mark.parametrize("aspect", [0.6, 1.0, 16.0 / 9.0, 3.0])
def test_the_top_view_holds_the_whole_world_with_north_up(aspect):
    world = generate_warehouse()
    camera = aim("top", world, CARTER, Pose2D(0.0, 0.0), aspect, all_clear)
    low, high = world.bounds
    corners = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    places = project(camera, corners, aspect)
    assert np.abs(places).max() == pytest.approx(0.95, abs=0.02)
    (west, north) = project(camera, [(-5.0, 0.0, 0.0), (0.0, 5.0, 0.0)], aspect)
    assert west[0] < 0.0 < north[1]


@pytest.mark.parametrize("aspect", [0.6, 1.0, 16.0 / 9.0])
def test_the_overview_holds_the_whole_floor(aspect):
    world = generate_warehouse()
    camera = aim("overview", world, CARTER, Pose2D(0.0, 0.0), aspect, all_clear)
    low, high = world.bounds
    places = project(camera, [(x, y, 0.0) for x in (low[0], high[0]) for y in (low[1], high[1])], aspect)
    assert np.abs(places).max() < 0.97


def test_an_empty_world_is_seen_around_the_robot():
    camera = aim("top", EMPTY, CARTER, Pose2D(40.0, -3.0), 1.0, all_clear)
    assert camera.eye[:2] == pytest.approx((40.0, -3.0), abs=0.1)


def test_the_chase_camera_is_behind_the_robot_and_sees_ahead():
    camera = aim("chase", EMPTY, CARTER, Pose2D(1.0, 2.0, math.pi / 2.0), 1.5, all_clear)
    assert camera.eye[1] < 2.0 < camera.target[1]
    assert camera.eye[0] == pytest.approx(1.0)


def test_the_chase_camera_moves_to_where_the_robot_is_seen():
    crate = Solid("crate", Box((0.5, 3.0, 1.2)), Pose3D((-1.6, 0.0, 0.6)))
    free, hidden = (
        SceneModel(World("room", solids), CARTER, size=(160, 120)).aim("chase", Pose2D(0.0, 0.0))
        for solids in ((), (crate,))
    )
    assert hidden.angles()[1] < free.angles()[1]
    top_of_robot, eye = np.array([-0.23, 0.0, 0.62]), np.array(hidden.eye)
    at_crate = top_of_robot + (eye - top_of_robot) * (-1.35 - top_of_robot[0]) / (eye[0] - top_of_robot[0])
    assert eye[0] > -1.35 or at_crate[2] > 1.2


def test_a_view_that_nothing_clears_is_from_above():
    camera = aim("chase", EMPTY, CARTER, Pose2D(0.0, 0.0), 1.5, lambda *_: False)
    assert camera.angles()[1] < -math.radians(70.0)


def test_bad_cameras_are_refused():
    with pytest.raises(UnknownNameError, match="overview"):
        aim("overvew", EMPTY, CARTER, Pose2D(0.0, 0.0), 1.5, all_clear)
    for eye, fovy in (((0.0, 0.0, 0.0), 45.0), ((math.nan, 0.0, 1.0), 45.0), ((1.0, 0.0, 0.0), 0.0)):
        with pytest.raises(InputError):
            Camera(eye, (0.0, 0.0, 0.0), fovy)
