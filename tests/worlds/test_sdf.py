from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from support.sdf_texts import CUBE, TETRAHEDRON, link, load, mesh, model, only, write
from trundle.errors import WorldWarning
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, Sphere
from trundle.maps import OccupancyGrid
from trundle.worlds import World
from trundle.worlds.gazebo.elements import VERSIONS


def assert_at(pose: Pose3D, position, yaw=0.0):
    np.testing.assert_allclose(pose.position, position, atol=1e-9)
    np.testing.assert_allclose(pose.rotation(), Pose3D.planar(0, 0, 0, yaw).rotation(), atol=1e-9)


@pytest.mark.parametrize("version", VERSIONS)
def test_every_version_is_read(tmp_path, version):
    solid = only(load(tmp_path, model("<pose>1 2 3 0 0 0.5</pose>" + link()), version))
    assert solid.name == "m"
    assert solid.shape == Box((1.0, 2.0, 3.0))
    assert_at(solid.pose, (1, 2, 3), 0.5)


def test_shapes_become_solids_and_planes_do_not(tmp_path):
    geometries = {
        "cylinder": "<cylinder><radius>0.5</radius><length>2</length></cylinder>",
        "sphere": "<sphere><radius>0.25</radius></sphere>",
        "ellipsoid": "<ellipsoid><radii>1 2 3</radii></ellipsoid>",
        "cone": "<cone><radius>1</radius><length>2</length></cone>",
        "plane": "<plane><normal>0 0 1</normal><size>9 9</size></plane>",
        "bare": "<plane/>",
        "empty": "<empty/>",
    }
    body = "".join(model(link(f"<geometry>{text}</geometry>"), name) for name, text in geometries.items())
    shapes = {solid.name: solid.shape for solid in load(tmp_path, body, "1.11").solids}
    assert set(shapes) == {"cylinder", "sphere", "ellipsoid", "cone"}
    assert shapes["cylinder"] == Cylinder(0.5, 2.0)
    assert shapes["sphere"] == Sphere(0.25)
    for name, extent in (("ellipsoid", (2, 4, 6)), ("cone", (2, 2, 2))):
        assert isinstance(shapes[name], Mesh)
        np.testing.assert_allclose(np.ptp(shapes[name].vertices, axis=0), extent, rtol=5e-3)
        assert signed_volume(shapes[name]) > 0.0


def signed_volume(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def test_planes_that_are_not_the_floor_are_rectangles(tmp_path):
    def plane(normal: str, pose: str, name: str) -> str:
        shape = f"<geometry><plane><normal>{normal}</normal><size>4 6</size></plane></geometry>"
        return model(f"<pose>{pose}</pose>" + link(shape), name)

    body = plane("0 0 1", "0 0 -0.3 0 0 1", "pit") + plane("0 2 0", "5 0 3 0 0 0", "wall")
    body += plane("0 0 1", "0 0 1 0 0 0", "deck") + plane("1 0 0", f"0 0 0 0 {-math.pi / 2} 0", "turned floor")
    solids = {solid.name: solid for solid in load(tmp_path, body).solids}
    assert set(solids) == {"wall", "deck"}
    low, high = solids["wall"].bounds()
    assert (low[1], high[1]) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert sorted(high - low) == pytest.approx([0.0, 4.0, 6.0], abs=1e-9)
    shape = solids["wall"].shape
    a, b, c = solids["wall"].pose.transform_points(shape.vertices)[shape.faces[0]]
    assert np.cross(b - a, c - a)[1] > 0.0
    np.testing.assert_allclose(solids["deck"].bounds(), ((-2, -3, 1), (2, 3, 1)), atol=1e-9)


def test_a_merged_include_puts_its_links_and_frames_into_the_model(tmp_path):
    inner = (
        "<pose>0 0 9 0 0 0</pose><frame name='top'><pose>0 0 5 0 0 0</pose></frame>"
        + link(name="base")
        + model("<pose>0 0 1 0 0 0</pose>" + link(), "deep", static="")
    )
    (tmp_path / "inner.sdf").write_text(f"<sdf version='1.9'>{model(inner, 'inner', static='')}</sdf>")
    body = model(
        f"<include merge='true'><uri>inner.sdf</uri><pose>1 0 0 0 0 {math.pi / 2}</pose></include>"
        + link(name="a", pose="<pose relative_to='base'>2 0 0 0 0 0</pose>")
        + link(name="b", pose="<pose relative_to='top'>0 0 0 0 0 0</pose>")
        + link(name="c", pose="<pose relative_to='deep::l'>0 0 0 0 0 0</pose>")
    )
    at = {solid.name: solid.pose.position for solid in load(tmp_path, body).solids}
    expected = {"m/base/c": (1, 0, 0), "m/a/c": (1, 2, 0), "m/b/c": (1, 0, 5), "m/c/c": (1, 0, 1), "m::deep": (1, 0, 1)}
    assert at.keys() == expected.keys()
    for name, position in expected.items():
        np.testing.assert_allclose(at[name], position, atol=1e-9)


def test_a_capsule_is_exactly_a_cylinder_and_two_balls(tmp_path):
    geometry = "<geometry><capsule><radius>0.5</radius><length>2</length></capsule></geometry>"
    world = load(tmp_path, model(link(geometry)))
    assert {(solid.name, type(solid.shape), solid.pose.position[2]) for solid in world.solids} == {
        ("m", Cylinder, 0.0),
        ("m:low", Sphere, -1.0),
        ("m:high", Sphere, 1.0),
    }


def test_poses_of_world_model_link_and_collision_multiply(tmp_path):
    turn = math.pi / 2
    body = model(
        f"<pose>10 0 0 0 0 {turn}</pose>"
        + link(pose=f"<pose>1 0 0 0 0 {turn}</pose>", extra="<pose>1 0 0 0 0 0</pose>")
    )
    # Model at x = 10 facing +y; the link 1 m ahead of it, facing -x; the box 1 m ahead of that.
    assert_at(only(load(tmp_path, body)).pose, (9, 1, 0), math.pi)


def test_nested_models_are_placed_in_their_model_and_named_by_both(tmp_path):
    inner = model("<pose>0 1 0 0 0 0</pose>" + link(), "inner", static="")
    world = load(tmp_path, model(f"<pose>5 0 0 0 0 {math.pi / 2}</pose>" + inner, "outer"))
    assert only(world).name == "outer::inner"
    assert_at(only(world).pose, (4, 0, 0), math.pi / 2)


def test_poses_are_relative_to_links_frames_models_and_joints(tmp_path):
    body = (
        "<frame name='corner'><pose>100 0 0 0 0 0</pose></frame>"
        + model(
            "<pose relative_to='corner'>1 0 0 0 0 0</pose>"
            "<frame name='f' attached_to='a'><pose>0 0 7 0 0 0</pose></frame>"
            "<joint name='j' type='fixed'><parent>a</parent><child>b</child><pose>0 0 0.5 0 0 0</pose></joint>"
            + link(name="a", pose="<pose>0 1 0 0 0 0</pose>")
            + link(name="b", pose="<pose relative_to='f'>0 0 1 0 0 0</pose>")
            + link(name="c", pose="<pose relative_to='j'>2 0 0 0 0 0</pose>")
            + link(name="d", extra="<pose relative_to='deep::l'>0 0 1 0 0 0</pose>")
            + model(link(pose="<pose>0 30 0 0 0 0</pose>") + "<pose relative_to='a'>0 0 0 0 0 0</pose>", "deep")
        )
        + model("<pose relative_to='m'>0 0 0.25 0 0 0</pose>" + link(), "late")
    )
    at = {solid.name: solid.pose.position for solid in load(tmp_path, body).solids}
    expected = {
        "m/a/c": (101, 1, 0),
        "m/b/c": (101, 1, 8),
        "m/c/c": (103, 1, 8.5),
        "m/d/c": (101, 31, 1),
        "m::deep": (101, 31, 0),
        "late": (101, 0, 0.25),
    }
    assert at.keys() == expected.keys()
    for name, position in expected.items():
        np.testing.assert_allclose(at[name], position, atol=1e-9)


def test_a_placement_frame_is_what_the_pose_places(tmp_path):
    inner = f"<pose>5 5 0 0 0 {math.pi}</pose>" + link(name="l") + link(name="grip", pose="<pose>1 0 0 0 0 0</pose>")
    world = load(tmp_path, f"<model name='m' placement_frame='grip'><static>true</static>{inner}</model>")
    at = {solid.name: solid.pose.position for solid in world.solids}
    np.testing.assert_allclose(at["m/grip/c"], (5, 5, 0), atol=1e-9)
    np.testing.assert_allclose(at["m/l/c"], (6, 5, 0), atol=1e-9)


def test_degrees_and_quaternions(tmp_path):
    assert_at(
        only(load(tmp_path, model("<pose degrees='true'>0 0 0 0 0 90</pose>" + link()))).pose, (0, 0, 0), math.pi / 2
    )
    half = math.sqrt(0.5)
    text = f"<pose rotation_format='quat_xyzw'>1 0 0 0 0 {half} {half}</pose>"
    assert_at(only(load(tmp_path, model(text + link()))).pose, (1, 0, 0), math.pi / 2)


def test_the_state_block_is_not_looked_at(tmp_path):
    state = "<state world_name='hall'><model name='m'><pose>9 9 9 0 0 0</pose></model></state>"
    assert only(load(tmp_path, model(link()) + state)).pose.position == (0.0, 0.0, 0.0)


def test_models_that_can_move_are_left_out_with_a_word_or_taken(tmp_path):
    body = model(link(), "wall") + model(link(), "trolley", static="")
    with pytest.warns(WorldWarning, match=r"1 non-static models were left out \(trolley\)"):
        assert only(load(tmp_path, body)).name == "wall"
    assert len(load(tmp_path, body, movable=True).solids) == 2


def test_colours_come_from_the_visual_of_the_same_link(tmp_path):
    red = "<material><diffuse>1 0 0 0.5</diffuse></material>"
    script = "<material><script><name>Gazebo/Blue</name></script></material>"
    body = model(
        "<link name='l'>"
        f"<collision name='a'>{CUBE}</collision><collision name='b'>{CUBE}</collision>"
        f"<visual name='b'>{CUBE}{script}</visual><visual name='v'>{CUBE}{red}</visual></link>"
    )
    colors = {solid.name: solid.color for solid in load(tmp_path, body).solids}
    assert colors == {"m/l/a": (0.0, 0.0, 1.0, 1.0), "m/l/b": (0.0, 0.0, 1.0, 1.0)}
    seen = {solid.name: solid.color for solid in load(tmp_path, body, geometry="visual").solids}
    assert seen == {"m/l/b": (0.0, 0.0, 1.0, 1.0), "m/l/v": (1.0, 0.0, 0.0, 0.5)}


@pytest.fixture
def shop(tmp_path: Path) -> Path:
    """A folder of models with one, a shelf whose mesh names the model."""
    folder = tmp_path / "models" / "shelf"
    (folder / "meshes").mkdir(parents=True)
    (folder / "meshes" / "t.obj").write_text(TETRAHEDRON)
    (folder / "model.config").write_text("<model><name>shelf</name><sdf version='1.6'>shelf.sdf</sdf></model>")
    body = "<pose>0 0 2 0 0 0</pose>" + link(mesh("model://shelf/meshes/t.obj", "<scale>2 2 -2</scale>"))
    (folder / "shelf.sdf").write_text(f"<sdf version='1.6'>{model(body, 'shelf')}</sdf>")
    return tmp_path / "models"


def test_includes_and_meshes_are_found_by_path(tmp_path, shop):
    body = (
        "<include><uri>model://shelf</uri></include>"
        "<include><uri>model://shelf</uri><name>b</name><pose>5 0 0 0 0 0</pose></include>"
        f"<include><uri>file://{shop}/shelf/shelf.sdf</uri><name>c</name><pose>7 0 0 0 0 0</pose></include>"
    )
    world = load(tmp_path, body, paths=str(shop))
    assert {solid.name: solid.pose.position for solid in world.solids} == {
        "shelf": (0.0, 0.0, 2.0),
        "b": (5.0, 0.0, 0.0),
        "c": (7.0, 0.0, 0.0),
    }
    shape = world.solids[0].shape
    assert isinstance(shape, Mesh)
    np.testing.assert_allclose(shape.vertices.min(axis=0), (0, 0, -2))
    assert signed_volume(shape) == pytest.approx(8.0 / 6.0)


def test_a_model_file_alone_is_a_world(shop):
    world = World.load(shop / "shelf" / "shelf.sdf")
    assert world.name == "shelf"
    assert only(world).name == "shelf"


def test_a_field_of_posts_as_barn_has_them_becomes_a_map(tmp_path):
    post = "<geometry><cylinder><radius>0.075</radius><length>1</length></cylinder></geometry>"
    body = "".join(model(f"<pose frame=''>{x} 1 0 0 0 0</pose>" + link(post), f"p{x}") for x in range(4))
    file = write(tmp_path, body, "1.6", name="posts.world")
    grid = OccupancyGrid.from_world(World.load(file), z_range=(0.05, 0.4), bounds=((-1, 0), (4, 2)))
    for x in range(4):
        row, col = grid.world_to_cell(x + 0.001, 1.001)
        assert grid.data[row, col] == 100
    assert (grid.data == 100).sum() == 4 * 16
