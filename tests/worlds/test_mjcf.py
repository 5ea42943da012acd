from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
import trimesh

from trundle.errors import WorldError, WorldWarning
from trundle.geometry.solids import Box, Cylinder, Mesh, Sphere
from trundle.worlds import World

MJCF = """
<mujoco model="hall">
  <compiler angle="degree"/>
  <asset>
    <texture name="gone" type="2d" file="gone.png"/>
    <material name="brick" rgba="0.5 0.25 0 1" texture="gone"/>
    <mesh name="wedge" vertex="0 0 0  1 0 0  0 1 0  0 0 1"/>
    <hfield name="hills" nrow="2" ncol="3" size="2 1 0.5 0.1" elevation="0 0 0 1 1 1"/>
  </asset>
  <default><default class="see"><geom contype="0" conaffinity="0" group="2"/></default></default>
  <worldbody>
    <geom name="floor" type="plane" size="0 0 1"/>
    <geom name="wall" type="box" size="1 0.1 0.5" pos="0 3 0.5" euler="0 0 90" material="brick"/>
    <body name="post" pos="1 0 0"><geom type="cylinder" fromto="0 0 0 0 0 2" size="0.1"/>
      <body name="knob" pos="0 0 2"><geom type="sphere" size="0.2" rgba="1 0 0 1"/></body></body>
    <geom name="rail" type="capsule" size="0.1 0.5"/>
    <geom name="egg" type="ellipsoid" size="1 2 3"/>
    <geom type="mesh" mesh="wedge" pos="5 5 0"/>
    <geom name="ground" type="hfield" hfield="hills" pos="9 9 0"/>
    <geom name="sign" class="see" type="box" size="1 1 1"/>
    <body name="cart"><freejoint/><geom type="box" size="1 1 1"/>
      <body name="lid"><geom type="box" size="1 1 1"/></body></body>
    <body name="door"><joint type="hinge"/><geom type="box" size="1 1 1"/></body>
  </worldbody>
</mujoco>
"""


def test_fixed_geometry_of_mjcf_becomes_solids(tmp_path):
    (tmp_path / "hall.xml").write_text(MJCF)
    with pytest.warns(WorldWarning, match="left out: 3 geoms of cart, door"):
        world = World.load(tmp_path / "hall.xml")
    assert world.name == "hall"
    solids = {solid.name: solid for solid in world.solids}
    assert set(solids) == {"wall", "post", "knob", "rail", "rail:low", "rail:high", "egg", "wedge", "ground"}
    assert solids["wall"].shape == Box((2.0, 0.2, 1.0))
    assert solids["wall"].pose.position == (0.0, 3.0, 0.5)
    assert solids["wall"].pose.yaw() == pytest.approx(math.pi / 2)
    assert solids["wall"].color == pytest.approx((0.5, 0.25, 0.0, 1.0))
    assert solids["post"].shape == Cylinder(0.1, 2.0)
    np.testing.assert_allclose(solids["post"].pose.position, (1, 0, 1), atol=1e-12)
    assert solids["knob"].shape == Sphere(0.2)
    assert solids["knob"].pose.position == (1.0, 0.0, 2.0)
    assert solids["rail"].shape == Cylinder(0.1, 1.0)
    np.testing.assert_allclose(solids["egg"].bounds(), ((-1, -2, -3), (1, 2, 3)), rtol=5e-3)
    np.testing.assert_allclose(solids["wedge"].bounds(), ((5, 5, 0), (6, 6, 1)), atol=1e-6)
    np.testing.assert_allclose(solids["ground"].bounds(), ((7, 8, -0.1), (11, 10, 0.5)), atol=1e-6)


def test_a_file_named_mjcf_is_read_with_its_includes_and_meshes(tmp_path):
    folder = tmp_path / "a & b"
    (folder / "parts").mkdir(parents=True)
    trimesh.creation.box((1.0, 2.0, 3.0)).export(folder / "parts" / "crate.stl")
    (folder / "more.xml").write_text(
        "<mujoco><worldbody><geom name='post' type='sphere' size='1'/></worldbody></mujoco>"
    )
    (folder / "hall.mjcf").write_text(
        "<mujoco model='hall'><compiler meshdir='parts'/><include file='more.xml'/>"
        "<asset><mesh name='crate' file='crate.stl'/></asset>"
        "<worldbody><geom name='crate' type='mesh' mesh='crate' pos='5 0 0'/></worldbody></mujoco>"
    )
    world = World.load(folder / "hall.mjcf")
    assert world.name == "hall"
    solids = {solid.name: solid for solid in world.solids}
    assert set(solids) == {"post", "crate"}
    np.testing.assert_allclose(solids["crate"].bounds(), ((4.5, -1.0, -1.5), (5.5, 1.0, 1.5)), atol=1e-6)


def test_what_is_seen_can_be_asked_for(tmp_path):
    (tmp_path / "hall.xml").write_text(
        MJCF.replace('group="2"', 'group="1"').replace('name="wall"', 'name="wall" group="3"')
    )
    with pytest.warns(WorldWarning):
        names = {solid.name for solid in World.load(tmp_path / "hall.xml", geometry="visual").solids}
    assert "sign" in names
    assert "wall" not in names


URDF = """
<robot name="shop">
  <link name="world"/>
  <link name="shelf">
    <visual><geometry><mesh filename="package://shop/meshes/gone.dae"/></geometry></visual>
    <collision><origin xyz="0 0 1"/><geometry>
      <mesh filename="package://shop/meshes/box.{suffix}" scale="1 1 -2"/></geometry></collision>
  </link>
  <joint name="j" type="fixed">
    <parent link="world"/><child link="shelf"/><origin xyz="1 2 0" rpy="0 0 1.5707963"/></joint>
  <link name="post"><collision name="pole"><geometry><cylinder radius="0.1" length="2"/></geometry></collision></link>
  <joint name="k" type="fixed"><parent link="shelf"/><child link="post"/><origin xyz="1 0 0"/></joint>
  <link name="door"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="1 1 1"/></geometry></collision></link>
  <joint name="hinge" type="continuous"><parent link="shelf"/><child link="door"/></joint>
</robot>
"""


def shop(folder: Path, suffix: str) -> Path:
    meshes = folder / "ros" / "shop" / "meshes"
    meshes.mkdir(parents=True)
    box = trimesh.creation.box((1, 2, 3))
    box.visual = trimesh.visual.TextureVisuals(material=trimesh.visual.material.SimpleMaterial())
    box.apply_translation((0, 0, 1.5))
    content = box.export(file_type="stl_ascii" if suffix == "stl" else suffix)
    if suffix == "dae":
        content = content.replace(b"Y_UP", b"Z_UP")
    (meshes / f"box.{suffix}").write_bytes(content if isinstance(content, bytes) else content.encode())
    file = folder / "shop.urdf"
    file.write_text(URDF.replace("{suffix}", suffix))
    return file


@pytest.mark.parametrize("suffix", ["stl", "obj", "dae"])
def test_fixed_links_of_urdf_become_solids_with_meshes_of_packages(tmp_path, suffix):
    with pytest.warns(WorldWarning, match="1 geoms of shelf"):
        world = World.load(shop(tmp_path, suffix), paths=tmp_path / "ros")
    solids = {solid.name: solid for solid in world.solids}
    assert set(solids) == {"shelf", "pole"}
    shape = solids["shelf"].shape
    assert isinstance(shape, Mesh)
    # 1 x 2 x 3 m upside down and twice as tall, from 1 m down to -5 m, turned by 90°.
    np.testing.assert_allclose(solids["shelf"].bounds(), ((0, 1.5, -5), (2, 2.5, 1)), atol=1e-5)
    np.testing.assert_allclose(solids["pole"].pose.position, (1, 3, 0), atol=1e-6)


def test_a_plane_is_the_floor_or_a_rectangle(tmp_path):
    planes = {
        "floor": "size='9 9 1'",
        "below": "size='9 9 1' pos='0 0 -0.2'",
        "wall": "size='2 3 1' pos='4 0 0' zaxis='1 0 0'",
        "shelf": "size='2 3 1' pos='0 0 1'",
        "endless": "size='0 0 1' zaxis='1 0 0'",
    }
    geoms = "".join(f"<geom name='{name}' type='plane' {rest}/>" for name, rest in planes.items())
    (tmp_path / "w.xml").write_text(f"<mujoco><worldbody>{geoms}</worldbody></mujoco>")
    with pytest.warns(WorldWarning, match="infinite planes other than the floor were left out: endless"):
        solids = {solid.name: solid for solid in World.load(tmp_path / "w.xml").solids}
    assert set(solids) == {"wall", "shelf"}
    assert sorted(np.ptp(solids["wall"].bounds(), axis=0)) == pytest.approx([0.0, 4.0, 6.0], abs=1e-9)
    np.testing.assert_allclose(np.mean(solids["wall"].bounds(), axis=0), (4, 0, 0), atol=1e-9)
    np.testing.assert_allclose(solids["shelf"].bounds(), ((-2, -3, 1), (2, 3, 1)), atol=1e-9)


def test_includes_are_followed_and_what_can_move_is_left_out(tmp_path):
    box = "<geom name='{}' type='box' size='2 1 1' euler='0 0 {}'/>"
    (tmp_path / "inc.xml").write_text(
        f"<mujocoinclude><worldbody>{box.format('inside', '90')}</worldbody></mujocoinclude>"
    )
    mocap = f"<body name='hand' mocap='true'>{box.format('palm', 0)}</body>"
    (tmp_path / "w.xml").write_text(f"<mujoco><include file='inc.xml'/><worldbody>{mocap}</worldbody></mujoco>")
    with pytest.warns(WorldWarning, match="was left out: 1 geoms of hand"):
        (solid,) = World.load(tmp_path / "w.xml").solids
    assert solid.name == "inside"
    np.testing.assert_allclose(solid.bounds()[1], (1, 2, 1))
    (tmp_path / "w.xml").write_text(
        f"<mujoco><compiler angle='radian'/><worldbody>{box.format('b', math.pi / 2)}</worldbody></mujoco>"
    )
    np.testing.assert_allclose(World.load(tmp_path / "w.xml").bounds[1], (1, 2, 1))


def test_looks_alone_give_an_empty_world_that_says_so(tmp_path):
    (tmp_path / "w.xml").write_text(
        "<mujoco><worldbody><geom type='box' size='1 1 1' contype='0' conaffinity='0'/></worldbody></mujoco>"
    )
    with pytest.warns(WorldWarning, match='without collision, use geometry="visual"'):
        assert World.load(tmp_path / "w.xml").solids == ()
    assert len(World.load(tmp_path / "w.xml", geometry="visual").solids) == 1


SHELL = "<robot name='r'><link name='a'><collision><geometry>{}</geometry></collision></link></robot>"
ORIGIN = SHELL.format("<box size='1 1 1'/>").replace("<collision>", "<collision><origin xyz='nan 0 0'/>")


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("w.urdf", URDF.replace("{suffix}", "stl"), "w.urdf:7: the mesh 'package://shop/meshes/box.stl' was not found"),
        ("w.urdf", URDF.replace("1 1 -2", "1 0 1"), "w.urdf:7: scale of <mesh> must be 3 numbers, none of them 0"),
        ("w.urdf", "<robot name='x' xmlns:xacro='y'><xacro:include/></robot>", "Expand the file first"),
        ("w.urdf", "<robot name='x'><link name='a'/><link name='a'/></robot>", "MuJoCo cannot read it"),
        ("w.urdf", "<!DOCTYPE x [<!ENTITY a 'b'>]><robot>&a;</robot>", "a <!DOCTYPE …> is not accepted"),
        ("w.xml", "<!DOCTYPE x [<!ENTITY a 'b'>]><mujoco>&a;</mujoco>", "a <!DOCTYPE …> is not accepted"),
        ("w.xml", "<mujoco><worldbody>", "not XML: no element found"),
        ("w.xml", "<mujoco><worldbody><geom type='blob'/></worldbody></mujoco>", "MuJoCo cannot read it"),
        ("w.xml", "<mujoco><worldbody><geom type='box' size='0 1 1'/></worldbody></mujoco>", "MuJoCo cannot build it"),
        ("w.xml", "<mujoco><asset><mesh name='m' file='gone.stl'/></asset></mujoco>", "gone.stl"),
        ("w.urdf", SHELL.format("<box size='1 0 1'/>"), "w.urdf:1: size of <box> must be 3 numbers, above 0"),
        (
            "w.urdf",
            SHELL.format("<cylinder radius='-1' length='1'/>"),
            "radius of <cylinder> must be a number",
        ),
        ("w.urdf", SHELL.format("<sphere radius='nan'/>"), "radius of <sphere> must be a number, above 0, got 'nan'"),
        ("w.urdf", SHELL.format("<mesh filename='nan.obj'/>"), "vertex coordinate 0 is not finite"),
        ("w.urdf", SHELL.format("<mesh filename='nan.obj'/>"), "nan"),
        ("w.urdf", SHELL.format("<mesh filename='empty.obj'/>"), "0-empty"),
        ("w.urdf", ORIGIN, "xyz of <origin> must be 3 numbers, finite, got 'nan 0 0'"),
        (
            "w.xml",
            MJCF.replace('pos="1 0 0"', 'pos="nan 0 0"'),
            "geom 'post': its pose is not finite",
        ),
        ("w.xml", "<sdf version='1.6'/>", "the root element is <sdf>; MJCF has <mujoco> and URDF has <robot>"),
    ],
)
def test_bad_files_are_refused(tmp_path, monkeypatch, name, text, message):
    monkeypatch.chdir(tmp_path)
    (tmp_path / name).write_text(text)
    (tmp_path / "nan.obj").write_text("v nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n")
    (tmp_path / "empty.obj").write_text("v 0 0 0\n")
    with pytest.raises(WorldError) as caught:
        World.load(tmp_path / name)
    assert message in str(caught.value)
    assert name in str(caught.value)
    assert not (tmp_path / "MUJOCO_LOG.TXT").exists()
