import contextlib
from types import SimpleNamespace

import mujoco
import mujoco.viewer
import numpy as np
import pytest

from trundle.errors import InputError, SimulationError
from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.mission import run
from trundle.navigation import Navigator
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.viewer.native import NativeWindow, Watcher, has_screen
from trundle.viewer.route import mark_route
from trundle.worlds import World


@pytest.fixture
def carter():
    return Robot.load("nova_carter")


def test_without_a_display_there_is_no_screen_and_no_window(monkeypatch, carter):
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setattr("sys.platform", "linux")
    assert not has_screen()
    with pytest.raises(SimulationError, match="no screen"):
        NativeWindow(World("empty", ()), carter)


def test_a_display_that_does_not_answer_is_no_screen(monkeypatch):
    monkeypatch.setenv("DISPLAY", ":4095")
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    assert not has_screen()


class FakeHandle:
    """What MuJoCo's passive viewer gives, without a window."""

    def __init__(self, model, data, **_):
        self.cam, self.opt = mujoco.MjvCamera(), mujoco.MjvOption()
        self.user_scn = mujoco.MjvScene(model, maxgeom=1000)
        self.model, self.syncs, self.running = model, 0, True
        self.at = data.joint("base_link").qpos

    def lock(self):
        return contextlib.nullcontext()

    def sync(self):
        self.syncs += 1

    def is_running(self):
        return self.running

    def close(self):
        self.running = False


@pytest.fixture
def screen(monkeypatch):
    opened = SimpleNamespace(handle=None)

    def launch(model, data, **options):
        opened.handle = FakeHandle(model, data, **options)
        return opened.handle

    monkeypatch.setattr("trundle.viewer.native.has_screen", lambda: True)
    monkeypatch.setattr(mujoco.viewer, "launch_passive", launch)
    return opened


def test_a_window_opens_on_the_robot(screen, carter):
    """Near enough that the robot fills a good part of the picture, wherever it stands."""
    for pose in (Pose2D(0.0, 0.0), Pose2D(40.0, -25.0, 2.0)):
        with NativeWindow(World("floor", ()), carter, pose):
            camera = screen.handle.cam
            assert np.hypot(camera.lookat[0] - pose.x, camera.lookat[1] - pose.y) < carter.circumscribed_radius
            assert camera.distance < 4.0
            shadows = screen.handle.model.vis.map.shadowclip * screen.handle.model.stat.extent
            assert shadows == pytest.approx(40.0)


def marks(handle):
    scene = handle.user_scn
    return [scene.geoms[index] for index in range(scene.ngeom)]


def test_a_run_shows_its_path_and_its_goal_in_the_window(screen, carter):
    grid = OccupancyGrid(np.zeros((80, 80), dtype=np.int8), 0.1)
    world, seen = World.from_map(grid), []

    class Note:
        def on_start(self, _run):
            pass

        def on_step(self, step):
            *pieces, disc = marks(screen.handle)
            place = tuple(round(float(number), 3) for number in disc.pos[:2])
            seen.append((step.goal, len(pieces), int(disc.type), place))

        def on_end(self, _episode):
            pass

    window = NativeWindow(world, carter, (2.0, 2.0), chase=True)
    with window, simulate(world, carter, backend="kinematic") as sim:
        watcher = Watcher(window)
        goals = [(2.6, 2.0), (2.6, 2.8)]
        episode = run(sim, Navigator(grid, carter), (2.0, 2.0, 0.0), goals, observers=[_NoWait(watcher), Note()])
    assert episode.observer_errors == ()
    cylinder = int(mujoco.mjtGeom.mjGEOM_CYLINDER)
    assert {(goal, kind, place) for goal, _, kind, place in seen} == {
        (0, cylinder, (2.6, 2.0)),
        (1, cylinder, (2.6, 2.8)),
    }
    assert all(pieces >= 1 for _, pieces, _, _ in seen)


class _NoWait:
    """A watcher that is always late, so that the test does not wait for real time."""

    def __init__(self, watcher):
        self._watcher = watcher

    def on_start(self, info):
        self._watcher.on_start(info)
        self._watcher._began = -1e9

    def on_step(self, step):
        self._watcher.on_step(step)

    def on_end(self, episode):
        self._watcher.on_end(episode)


def test_marks_of_a_route_are_replaced_and_end_where_the_scene_is_full(carter):
    model = mujoco.MjModel.from_xml_string("<mujoco/>")
    scene = mujoco.MjvScene(model, maxgeom=3)
    mark_route(scene, [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (2.0, 2.0)], Pose2D(2.0, 2.0), 0.3)
    assert scene.ngeom == 3  # two straight pieces and the disc
    assert scene.geoms[2].size[0] == pytest.approx(0.3)
    mark_route(scene, [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (2.0, 1.0), (2.0, 2.0)], Pose2D(2.0, 2.0), 0.3)
    assert scene.ngeom == 3
    mark_route(scene, None, Pose2D(1.0, 1.0), 0.3)
    assert scene.ngeom == 1
    mark_route(scene, None, None, 0.3)
    assert scene.ngeom == 0
    with pytest.raises(InputError, match="finite waypoints"):
        mark_route(scene, [(0.0, np.nan)], None, 0.3)
