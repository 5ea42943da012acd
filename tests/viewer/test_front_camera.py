import math

import numpy as np
import pytest

from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.mission import Scenario
from trundle.robots import Robot
from trundle.sim.mover_history import ShownMovers
from trundle.viewer import gl
from trundle.viewer.cameras import front_views
from trundle.viewer.route import DRIVEN_COLOR, FloorLine, bends, draw_line
from trundle.viewer.scene import SceneFrames, SceneRenderer
from trundle.viewer.scene_model import SceneModel
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
STRAIGHT = np.column_stack([np.linspace(0.0, 12.0, 121), np.zeros(121), np.zeros(121)])


def bearings(views, poses):
    """Directions of the cameras as the robot sees them [deg], 0 ahead."""
    eyes = np.array([view.eye for view in views])
    away = np.arctan2(eyes[:, 1] - poses[:, 1], eyes[:, 0] - poses[:, 0]) - poses[:, 2]
    return np.degrees(np.arctan2(np.sin(away), np.cos(away)))


def test_the_camera_is_at_the_front_quarter():
    for yaw in (0.0, 2.5):
        turn = np.array([[math.cos(yaw), math.sin(yaw)], [-math.sin(yaw), math.cos(yaw)]])
        poses = np.column_stack([STRAIGHT[:, :2] @ turn, np.full(121, yaw)])
        views = front_views(CARTER, poses, lambda *_: True)
        assert len(views) == 121
        assert np.abs(bearings(views, poses)) == pytest.approx(36.0, abs=4.0)
        assert len({round(view.distance, 6) for view in views}) == 1


def test_the_camera_has_moved_before_a_wall_comes_between():
    wall = Solid("wall", Box((4.0, 0.2, 3.0)), Pose3D((7.0, 1.0, 1.5)), kind="wall")
    scene = SceneModel(World("hall", (wall,)), CARTER, size=(160, 120))
    views = front_views(CARTER, STRAIGHT, scene.is_clear)
    seen = [scene.is_clear((x, 0.0, 0.6), view.eye) for (x, _, _), view in zip(STRAIGHT.tolist(), views, strict=True)]
    assert np.mean(seen) > 0.97
    # Neither does it jump, nor turn back and forth.
    moved = np.abs(np.diff(bearings(views, STRAIGHT)))
    assert moved.max() < 12.0
    assert moved.sum() < 250.0


def test_a_turn_on_the_spot_turns_the_camera_softly():
    poses = np.zeros((120, 3))
    poses[60:, 2] = math.pi / 2.0
    eyes = np.array([view.eye for view in front_views(CARTER, poses, lambda *_: True)])
    assert np.linalg.norm(np.diff(eyes, axis=0), axis=1).max() < 0.5


def test_one_picture_is_a_run_of_its_own():
    assert len(front_views(CARTER, np.zeros((1, 3)), lambda *_: False)) == 1


def test_a_driven_path_keeps_its_bends_and_ends():
    kept = bends(STRAIGHT)
    assert len(kept) < 10
    np.testing.assert_array_equal(kept[[0, -1]], STRAIGHT[[0, -1]])
    turns = np.linspace(0.0, math.pi, 200)
    circle = np.column_stack([3.0 * np.cos(turns), 3.0 * np.sin(turns), turns + math.pi / 2.0])
    assert 40 < len(bends(circle)) < 60


def test_lines_end_where_the_scene_is_full():
    import mujoco

    scene = mujoco.MjvScene(mujoco.MjModel.from_xml_string("<mujoco/>"), maxgeom=2)
    pieces = np.array([[(0.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (1.0, 2.0)], [(1, 2), (3, 2)]])
    draw_line(scene, FloorLine(pieces))
    assert scene.ngeom == 2
    np.testing.assert_allclose(scene.geoms[1].pos[:2], [1.0, 1.0])


@pytest.mark.gl
def test_a_line_is_in_the_picture():
    if gl.find_gl() is None:
        pytest.skip("no OpenGL driver that renders without a screen")
    line = FloorLine(np.array([[(-1.0, 0.8), (1.0, 0.8)]]), DRIVEN_COLOR)
    with SceneRenderer(World("empty", ()), CARTER, size=(160, 120), camera="top", shadow_size=0) as scene:
        plain, marked = (scene.render((0.0, 0.0), lines=lines).astype(int) for lines in ((), (line,)))
    changed = np.abs(marked - plain).max(axis=2) > 30
    assert changed.sum() > 5
    red, _, blue = marked[changed].mean(axis=0)
    assert red > blue + 60


@pytest.mark.gl
def test_a_video_shows_the_robots_front(tmp_path):
    if gl.find_gl() is None:
        pytest.skip("no OpenGL driver that renders without a screen")
    with Scenario(world="corridors", backend="kinematic").build() as mission:
        episode = mission.run()
        rows = np.linspace(0, len(episode.trajectory) - 1, 5).astype(np.intp)
        with SceneFrames(mission, episode, rows) as frames:
            assert len(frames._views) == 5
            poses = episode.trajectory.poses[rows]
            pictures = [frames.render(Pose2D(*pose), ShownMovers()) for pose in poses.tolist()]
    assert {picture.shape for picture in pictures} <= {(540, 960, 3), (720, 1280, 3)}
    assert pictures[0].std() > 5.0
