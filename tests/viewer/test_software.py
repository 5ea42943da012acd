import math

import mujoco
import numpy as np
import pytest

from trundle.geometry import Pose2D, Pose3D
from trundle.geometry.solids import OccupancyCells, Solid
from trundle.robots import Robot
from trundle.sim.mujoco.model import build_spec
from trundle.viewer.software import model_triangles
from trundle.worlds import World

XML = """
<mujoco><asset><mesh name="wedge" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/></asset><worldbody>
  <geom name="box" type="box" size="0.5 1 1.5" pos="1 2 3" euler="0 0 90"/>
  <geom name="ball" type="sphere" size="0.5" pos="0 0 4"/>
  <geom name="egg" type="ellipsoid" size="0.5 1 2"/>
  <geom name="drum" type="cylinder" size="0.5 1"/>
  <geom name="pill" type="capsule" size="0.5 1"/>
  <geom name="wedge" type="mesh" mesh="wedge" pos="5 0 0"/>
  <geom name="unseen" type="box" size="1 1 1" group="3"/>
  <geom name="floor" type="plane" size="0 0 1"/>
</worldbody></mujoco>
"""
VOLUMES = {
    "box": 6.0,
    "ball": 4.0 / 3.0 * math.pi * 0.125,
    "egg": 4.0 / 3.0 * math.pi,
    "drum": math.pi * 0.25 * 2.0,
    "pill": math.pi * 0.25 * 2.0 + 4.0 / 3.0 * math.pi * 0.125,
    "wedge": 1.0 / 6.0,
}
SHOWN = np.array([True, True, True, False, True, False])


def volume(corners):
    """Of closed triangles that go counter-clockwise seen from outside, by the divergence theorem."""
    return float((corners[:, 0] * np.cross(corners[:, 1], corners[:, 2])).sum() / 6.0)


def placed(model, name):
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    triangles = model_triangles(model, SHOWN)
    return triangles.placed(data)[triangles.geoms == model.geom(name).id]


@pytest.mark.parametrize("name", VOLUMES)
def test_triangles_enclose_the_shapes_volume_from_outside(name):
    corners = placed(mujoco.MjModel.from_xml_string(XML), name)
    assert volume(corners - corners.mean(axis=(0, 1))) == pytest.approx(VOLUMES[name], rel=0.03)


def test_triangles_are_where_the_geom_is():
    corners = placed(mujoco.MjModel.from_xml_string(XML), "box").reshape(-1, 3)
    assert np.allclose(corners.min(axis=0), (0.0, 1.5, 1.5))
    assert np.allclose(corners.max(axis=0), (2.0, 2.5, 4.5))


@pytest.mark.parametrize("name", ["unseen", "floor"])
def test_hidden_groups_and_planes_have_none(name):
    assert len(placed(mujoco.MjModel.from_xml_string(XML), name)) == 0


def test_blocked_cells_become_walls_with_flat_tops_on_the_floor():
    blocked = np.array([[1, 1, 0, 0], [0, 1, 0, 1], [0, 0, 0, 1]], dtype=bool)
    world = World("map", (Solid("map", OccupancyCells(blocked, 0.5, 1.2), Pose3D.planar(10.0, 20.0)),))
    corners = placed(build_spec(world, Robot.load("nova_carter")).compile(), "map")
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2.0
    areas = np.linalg.norm(normals, axis=1)
    is_top = np.abs(normals[:, 2]) > 0.5 * areas
    assert areas[is_top].sum() == pytest.approx(blocked.sum() * 0.25)
    edges = np.abs(np.diff(np.pad(blocked, 1).astype(int), axis=0)).sum()
    edges += np.abs(np.diff(np.pad(blocked, 1).astype(int), axis=1)).sum()
    assert areas[~is_top].sum() == pytest.approx(edges * 0.5 * 1.2)
    assert np.allclose(corners.reshape(-1, 3).min(axis=0), (10.0, 20.0, 0.0), atol=1e-6)
    assert np.allclose(corners.reshape(-1, 3).max(axis=0), (12.0, 21.5, 1.2), atol=1e-6)


def test_a_moved_robot_moves_its_triangles():
    from trundle.viewer.scene_model import SHOWN_GROUPS, SceneModel

    scene = SceneModel(World("empty", ()), Robot.load("nova_carter"), size=(16, 16))
    triangles = model_triangles(scene.model, np.array(SHOWN_GROUPS, dtype=bool))
    here = triangles.placed(scene.data)
    scene.place(Pose2D(3.0, 4.0))
    assert np.allclose(triangles.placed(scene.data) - here, (3.0, 4.0, 0.0), atol=1e-9)
