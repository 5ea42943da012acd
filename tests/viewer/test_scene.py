import importlib

import numpy as np
import pytest
from PIL import Image

from trundle.errors import InputError, OutputError, SimulationError, UnknownNameError
from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.robots import Robot
from trundle.viewer import gl
from trundle.viewer.cameras import CAMERAS, Camera
from trundle.viewer.scene import SceneRenderer, render
from trundle.viewer.scene_model import SceneModel
from trundle.worlds import World

SIZE = (160, 120)
WORLD = World(
    "room",
    (
        Solid("box", Box((0.6, 0.6, 0.6)), Pose3D((3.0, 1.5, 0.3)), (0.8, 0.3, 0.2, 1.0), "box"),
        Solid("wall", Box((0.2, 8.0, 3.0)), Pose3D((-4.0, 0.0, 1.5)), (0.8, 0.8, 0.8, 1.0), "wall"),
        Solid("wall_far", Box((0.2, 8.0, 3.0)), Pose3D((4.0, 0.0, 1.5)), (0.8, 0.8, 0.8, 1.0), "wall"),
    ),
)


@pytest.fixture
def carter():
    return Robot.load("nova_carter")


@pytest.fixture(params=["software", pytest.param("gl", marks=pytest.mark.gl)])
def renderer_kind(request, monkeypatch):
    """Run a test without OpenGL, and with it where it is there."""
    gl.find_gl.cache_clear()
    if request.param == "software":
        monkeypatch.setenv("MUJOCO_GL", "disable")
    else:
        monkeypatch.delenv("MUJOCO_GL", raising=False)
        if gl.find_gl() is None:
            pytest.skip("no OpenGL driver that renders without a screen")
    yield request.param
    gl.find_gl.cache_clear()


@pytest.mark.parametrize("camera", CAMERAS)
def test_every_camera_gives_a_picture_of_something(renderer_kind, carter, camera):
    picture = render(WORLD, carter, (0.0, 0.0, 0.5), size=SIZE, camera=camera)
    assert picture.pixels.shape == (120, 160, 3)
    assert picture.pixels.dtype == np.uint8
    assert picture.pixels.std() > 5.0
    assert (picture.kind == "software") == (renderer_kind == "software")
    assert bool(picture.advice) == (renderer_kind == "software")


def test_the_robot_is_in_the_picture_where_its_pose_is(renderer_kind, carter):
    camera = Camera((0.0, -6.0, 4.0), (0.0, 0.0, 0.0))
    with SceneRenderer(World("empty", ()), carter, size=SIZE, camera=camera) as scene:
        away = scene.render((100.0, 100.0)).astype(int)
        left = scene.render((-1.5, 0.0)).astype(int)
        right = scene.render(Pose2D(1.5, 0.0)).astype(int)
    changed_left = np.abs(left - away).max(axis=2) > 30
    changed_right = np.abs(right - away).max(axis=2) > 30
    assert changed_left.sum() > 100
    assert changed_right.sum() > 100
    assert np.flatnonzero(changed_left.any(axis=0)).mean() < 80 < np.flatnonzero(changed_right.any(axis=0)).mean()


def test_the_same_scene_gives_the_same_picture(renderer_kind, carter):
    pictures = [render(WORLD, carter, (0.0, 0.0), size=SIZE).pixels for _ in range(2)]
    assert np.array_equal(*pictures)


def test_path_and_goal_are_drawn_on_the_floor(renderer_kind, carter):
    plain = render(WORLD, carter, (-2.0, 0.0), size=SIZE, camera="top").pixels.astype(int)
    path = [(-2.0, 0.0), (0.0, 1.0), (2.0, 1.0)]
    marked = render(WORLD, carter, (-2.0, 0.0), size=SIZE, camera="top", path=path, goal=Pose2D(2.0, 1.0))
    assert 20 < (np.abs(marked.pixels.astype(int) - plain).max(axis=2) > 30).sum() < 3000


def test_a_camera_outside_looks_through_the_wall_on_its_side(renderer_kind, carter):
    camera = Camera((-12.0, 0.0, 1.5), (0.0, 0.0, 0.5))
    with SceneRenderer(WORLD, carter, size=SIZE, camera=camera) as scene:
        here, away = scene.render((0.0, 0.0)).astype(int), scene.render((100.0, 100.0)).astype(int)
    assert (np.abs(here - away).max(axis=2) > 30).sum() > 30


def test_shadows_can_be_turned_off(renderer_kind, carter):
    world = World("box", (Solid("box", Box((1.0, 1.0, 1.0)), Pose3D((0.0, 0.0, 0.5)), (0.9, 0.9, 0.9, 1.0)),))
    camera = Camera((2.0, 3.0, 5.0), (0.3, 0.2, 0.0))
    dark = []
    for shadow_size in (512, 0):
        with SceneRenderer(world, carter, size=SIZE, camera=camera, shadow_size=shadow_size) as scene:
            brightness = scene.render((50.0, 50.0)).mean(axis=2)
        dark.append((brightness < np.median(brightness) - 30.0).sum())
    assert dark[0] > dark[1] + 50


def test_a_picture_is_saved_whole_or_not_at_all(renderer_kind, carter, tmp_path):
    picture = render(WORLD, carter, size=SIZE)
    picture.save(tmp_path / "a.png")
    assert np.array_equal(np.asarray(Image.open(tmp_path / "a.png")), picture.pixels)
    with pytest.raises(OutputError):
        picture.save(tmp_path / "missing" / "a.png")


def test_bad_input_is_refused(carter, monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "disable")
    gl.find_gl.cache_clear()
    with pytest.raises(UnknownNameError, match="chase"):
        render(WORLD, carter, camera="chas", size=SIZE)
    with pytest.raises(InputError, match="pixels"):
        render(WORLD, carter, size=(0, 100))
    with pytest.raises(InputError, match="pixels"):
        render(WORLD, carter, size=(100, 10**6))
    with pytest.raises(InputError, match="path"):
        render(WORLD, carter, path=[(0.0, float("nan"))], size=SIZE)
    with pytest.raises(InputError, match="two different points"):
        Camera((0.0, 0.0, 1.0), (0.0, 0.0, 1.0))
    gl.find_gl.cache_clear()


def test_a_closed_renderer_says_so(renderer_kind, carter):
    scene = SceneRenderer(WORLD, carter, size=SIZE)
    scene.close()
    scene.close()
    with pytest.raises(SimulationError, match="closed"):
        scene.render((0.0, 0.0))


def test_a_driver_that_fails_leaves_the_software(carter, monkeypatch, caplog):
    painters = importlib.import_module("trundle.viewer.painters")

    def fail(*_: object) -> None:
        raise RuntimeError("no display")

    monkeypatch.setattr(painters, "find_gl", lambda: "egl")
    monkeypatch.setattr(painters, "open_context", fail)
    assert render(WORLD, carter, size=SIZE).kind == "software"
    assert "no display" in caplog.text


@pytest.mark.parametrize("value", ["disable", "off", "0"])
def test_the_environment_can_turn_opengl_off(monkeypatch, value):
    monkeypatch.setenv("MUJOCO_GL", value)
    gl.find_gl.cache_clear()
    assert gl.find_gl() is None
    assert "libegl1" in gl.describe_missing_gl()
    gl.find_gl.cache_clear()


def test_a_straight_part_of_a_path_is_one_piece(carter):
    plain = SceneModel(WORLD, carter, size=SIZE).model.ngeom
    straight = [(0.1 * step, 0.0) for step in range(50)]
    bent = [(0.0, 0.0), *straight, *((4.9, 0.1 * step) for step in range(30)), (4.9, 0.0)]
    for path, pieces in ((straight, 1), (bent, 3), (straight[:1], 0), ([(1.0, 1.0)] * 3, 0)):
        assert SceneModel(WORLD, carter, size=SIZE, path=path).model.ngeom == plain + pieces


def specks(pixels):
    """Dark pixels between two light ones in a row: what a floor without them has few of."""
    light = pixels.astype(int).max(axis=2)
    return int(((light[:, 1:-1] < light[:, :-2] - 25) & (light[:, 1:-1] < light[:, 2:] - 25)).sum())


@pytest.mark.slow
@pytest.mark.parametrize("camera", ["robot", "chase"])
def test_the_floor_has_no_specks_up_to_the_horizon(renderer_kind, carter, camera):
    """Before, 300 to 1300 of 230,400 pixels were dark towards the sun."""
    with SceneRenderer(World("floor", ()), carter, size=(640, 360), camera=camera, samples=4) as scene:
        assert max(specks(scene.render((0.0, 0.0, yaw))) for yaw in (0.0, 0.8, 3.2, 4.0, 4.8)) < 60


def test_an_overview_without_a_world_shows_the_robot_large(renderer_kind, carter):
    camera = SceneModel(World("floor", ()), carter, size=(640, 360)).aim("overview", Pose2D(5.0, 5.0))
    seen = 2.0 * camera.distance * np.tan(np.radians(camera.fovy_deg) / 2.0)
    assert seen < 4.0 * np.ptp(carter.outline[:, 0])
