"""A world of every format goes into MuJoCo, is drawn, mapped and exported, with its concave mesh as it is."""

from __future__ import annotations

import logging
from pathlib import Path

import numpy as np
import pytest
import trimesh
from pxr import Gf, Usd, UsdGeom

from trundle.export import FORMATS, export_world
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.viewer.scene import render
from trundle.worlds import World

# A bay of 3 x 3 m with walls of 0.2 m, open towards -x, and a pillar behind it. Its hull is a block.
OUTLINE = [(0, 0), (3, 0), (3, 3), (0, 3), (0, 2.8), (2.8, 2.8), (2.8, 0.2), (0, 0.2)]
CAPS = [(0, 1, 6), (0, 6, 7), (1, 2, 5), (1, 5, 6), (2, 3, 4), (2, 4, 5)]
PILLAR = (5.0, 1.5, 0.5)
SUFFIXES = (".usda", ".usdc", ".sdf", ".xml", ".urdf", ".glb", ".obj", ".stl", ".ply", ".yaml")


def bay() -> trimesh.Trimesh:
    corners = np.array(OUTLINE)
    count = len(corners)
    vertices = np.vstack([np.c_[corners, np.zeros(count)], np.c_[corners, np.ones(count)]])
    faces = [(a, c, b) for a, b, c in CAPS] + [(a + count, b + count, c + count) for a, b, c in CAPS]
    for i in range(count):
        j = (i + 1) % count
        faces += [(i, j, j + count), (i, j + count, i + count)]
    return trimesh.Trimesh(vertices, faces, process=False)


def write(folder: Path, suffix: str) -> Path:
    file = folder / f"hall{suffix}"
    if suffix.startswith(".usd"):
        write_usd(file)
    elif suffix == ".yaml":
        data = np.zeros((30, 60), dtype=np.int8)
        data[:2, :30] = data[-2:, :30] = data[:, 28:30] = data[10:20, 45:55] = 100
        OccupancyGrid(data, 0.1).save(file)
    elif suffix in (".sdf", ".xml", ".urdf"):
        bay().export(folder / "bay.stl")
        x, y, z = PILLAR
        file.write_text(TEXTS[suffix].format(x=x, y=y, z=z))
    else:
        scene = trimesh.Scene()
        pillar = trimesh.creation.box()
        pillar.apply_translation(PILLAR)
        for name, mesh in (("bay", bay()), ("pillar", pillar)):
            mesh.visual = trimesh.visual.TextureVisuals(material=trimesh.visual.material.SimpleMaterial())
            scene.add_geometry(mesh, node_name=name, geom_name=name)
        scene.export(file)
    return file


TEXTS = {
    ".sdf": "<sdf version='1.9'><world name='hall'><model name='bay'><static>1</static><link name='l'>"
    "<collision name='c'><geometry><mesh><uri>bay.stl</uri></mesh></geometry></collision></link></model>"
    "<model name='pillar'><static>1</static><pose>{x} {y} {z} 0 0 0</pose><link name='l'><collision name='c'><geometry>"
    "<box><size>1 1 1</size></box></geometry></collision></link></model></world></sdf>",
    ".xml": "<mujoco><asset><mesh name='bay' file='bay.stl'/></asset><worldbody><geom type='mesh' mesh='bay'/>"
    "<geom name='pillar' type='box' size='.5 .5 .5' pos='{x} {y} {z}'/></worldbody></mujoco>",
    ".urdf": "<robot name='hall'><link name='bay'><collision>"
    "<geometry><mesh filename='bay.stl'/></geometry></collision>"
    "<collision name='pillar'><origin xyz='{x} {y} {z}'/><geometry><box size='1 1 1'/></geometry></collision></link>"
    "</robot>",
}


def write_usd(file: Path) -> None:
    """In centimetres, y up, mirrored: x, y, z of the world are x, -z and y of the stage."""
    stage = Usd.Stage.CreateNew(str(file))
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    UsdGeom.SetStageUpAxis(stage, "Y")
    mirror = UsdGeom.Xform.Define(stage, "/World")
    mirror.AddScaleOp().Set(Gf.Vec3f(1, 1, -1))
    mesh = UsdGeom.Mesh.Define(stage, "/World/bay")
    mesh.CreatePointsAttr([(100 * x, 100 * z, 100 * y) for x, y, z in bay().vertices.tolist()])
    mesh.CreateFaceVertexCountsAttr([3] * len(bay().faces))
    mesh.CreateFaceVertexIndicesAttr(bay().faces[:, ::-1].ravel().tolist())
    cube = UsdGeom.Cube.Define(stage, "/World/pillar")
    cube.CreateSizeAttr(100.0)
    x, y, z = PILLAR
    cube.AddTranslateOp().Set(Gf.Vec3d(100 * x, 100 * z, 100 * y))
    stage.Save()


@pytest.fixture(params=SUFFIXES)
def world(request, tmp_path) -> World:
    options = {"up": "z"} if request.param == ".glb" else {}
    return World.load(write(tmp_path, request.param), **options)


@pytest.fixture(scope="module")
def robot() -> Robot:
    return Robot.load("turtlebot3_waffle")


@pytest.mark.slow
def test_it_is_where_it_should_be(world):
    np.testing.assert_allclose(world.bounds, ((0, 0, 0), (5.5, 3, 1)), atol=1e-6)


@pytest.mark.slow
def test_it_goes_into_mujoco(world, robot):
    with simulate(world, robot) as sim:
        # The robot stands where the hull of the bay would be, and drives on to the bay's back wall.
        state = sim.reset(Pose2D(2.0, 1.5, 0.0))
        touched: set[str] = set()
        for _ in range(60):
            state = sim.step(Twist2D(0.26, 0.0), 0.05)
            touched |= {contact.other.partition("[")[0] for contact in state.contacts}
            if touched:
                break
    reach = float(robot.outline[:, 0].max())
    assert len(touched) == 1
    assert state.pose.x + reach == pytest.approx(2.8, abs=0.02)


@pytest.fixture(scope="module")
def bare_floor(robot):
    return draw(World("empty", ()), robot)


def draw(world: World, robot: Robot):
    return render(world, robot, Pose2D(1.5, 1.5, 0.0), size=(96, 54), camera="top").pixels.astype(int)


@pytest.mark.slow
def test_it_is_drawn(world, robot, bare_floor):
    assert (np.abs(draw(world, robot) - bare_floor).max(axis=-1) > 20).mean() > 0.02


@pytest.mark.slow
def test_it_is_mapped(world):
    grid = OccupancyGrid.from_world(
        world, resolution=0.1, z_range=(0.1, 0.5), bounds=((-1, -1), (6, 4)), seeds=[(-0.5, 1.5)]
    )

    def at(x: float, y: float) -> int:
        row, col = grid.world_to_cell(x, y)
        return int(grid.data[row, col])

    assert (at(1.5, 1.5), at(0.05, 1.5), at(4.0, 1.5)) == (0, 0, 0)
    assert (at(2.95, 1.55), at(1.5, 0.1), at(1.5, 2.95), at(4.55, 1.55)) == (100, 100, 100, 100)
    # 0.2 m walls of 3, 3 and 2.6 m, and the pillar: cells of 0.01 m², as all edges lie on cells' edges.
    assert (grid.data != 0).sum() == pytest.approx(172 + 100, abs=4)


@pytest.mark.parametrize("form", sorted(name for name, form in FORMATS.items() if form.world is not None))
def test_it_is_exported(world, tmp_path, form):
    target = tmp_path / f"copy{FORMATS[form].suffixes[0]}"
    options = {"z_range": (0.1, 0.5), "resolution": 0.1} if form == "map" else {}
    export_world(world, target, to=form, **options)
    again = World.load(target, **({"height": 1.0} if form == "map" else {}))
    np.testing.assert_allclose(again.bounds, world.bounds, atol=0.15 if form == "map" else 1e-5)


def test_how_a_concave_mesh_collides_is_logged(tmp_path, robot, caplog):
    world = World.load(write(tmp_path, ".stl"))
    with caplog.at_level(logging.INFO, logger="trundle"), simulate(world, robot):
        pass
    assert f"each triangle a plate of 1 mm: '{world.solids[0].name}'" in caplog.text
