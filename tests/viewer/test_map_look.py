import mujoco
import numpy as np
import pytest

from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.viewer.scene_model import SceneModel
from trundle.worlds import World
from trundle.worlds.map_look import RISE
from trundle.worlds.walls import extrude

CARTER = Robot.load("nova_carter")


def grid():
    data = np.zeros((60, 80), dtype=np.int8)
    data[0], data[-1], data[:, 0], data[:, -1] = 100, 100, 100, 100
    data[1:40, 30] = 100
    data[20:26, 50:56] = 100
    return OccupancyGrid(data, 0.1)


def top_of(scene, x, y):
    """Height of what is drawn at a place [m], and the name of its geom."""
    found = np.zeros(1, dtype=np.int32)
    start, down = np.array([x, y, 10.0]), np.array([0.0, 0.0, -1.0])
    shown = np.array([1, 0, 1, 0, 1, 0], dtype=np.uint8)
    met = mujoco.mj_ray(scene.model, scene.data, start, down, shown, True, -1, found)
    return 10.0 - met, scene.model.geom(int(found[0])).name


@pytest.mark.parametrize("most_boxes", [5000, 1])
def test_walls_have_dark_tops_above_islands(most_boxes):
    name, solids, seeds = extrude(grid(), most_boxes=most_boxes)
    scene = SceneModel(World(name, solids, seeds), CARTER, size=(160, 120))
    height, geom = top_of(scene, 3.05, 2.05)
    assert height == pytest.approx(1.0 + RISE, abs=0.01)
    assert geom == "viewer:None:tops"
    assert top_of(scene, 5.35, 2.35)[0] == pytest.approx(1.0)
    assert top_of(scene, 5.0, 5.0)[0] == pytest.approx(0.0, abs=0.01)


def test_the_tops_of_a_wall_that_is_looked_through_go_with_it():
    scene = SceneModel(World.from_map(grid()), CARTER, size=(160, 120))
    scene.aim("overview", Pose2D(1.0, 1.0))
    alpha = {scene.model.geom(index).name: scene.model.geom_rgba[index, 3] for index in range(scene.model.ngeom)}
    assert alpha["map[0:1,0:80]"] == alpha["viewer:south:tops"] == alpha["viewer:south:feet"] == 0.0
    assert alpha["viewer:north:tops"] == alpha["viewer:None:tops"] == 1.0
