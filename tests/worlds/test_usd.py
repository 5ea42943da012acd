import math

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade

from support.usd_scenes import TETRA, extent, named, only, volume
from trundle.errors import WorldError, WorldWarning
from trundle.geometry.solids import Box, Cylinder, Mesh, Sphere
from trundle.worlds import World
from trundle.worlds.usd import load_usd


def test_primitives_come_as_what_they_are(write_usd):
    world = load_usd(
        write_usd("""
def Cube "Cube" { double size = 2; double3 xformOp:translate = (1, 2, 3)
  uniform token[] xformOpOrder = ["xformOp:translate"]; }
def Sphere "Sphere" { double radius = 0.5; }
def Cylinder "Cylinder" { double radius = 0.5; double height = 3; uniform token axis = "X"; }
def Cylinder_1 "Newer" { double radiusTop = 0.5; double radiusBottom = 0.5; double height = 3
    uniform token axis = "Y"; }
""")
    )
    solids = named(world)
    assert solids["/Cube"].shape == Box((2.0, 2.0, 2.0))
    assert solids["/Cube"].pose.position == (1.0, 2.0, 3.0)
    assert solids["/Sphere"].shape == Sphere(0.5)
    assert solids["/Cylinder"].shape == Cylinder(0.5, 3.0)
    assert extent(solids["/Cylinder"]) == (-1.5, -0.5, -0.5, 1.5, 0.5, 0.5)
    assert solids["/Newer"].shape == Cylinder(0.5, 3.0)
    assert extent(solids["/Newer"]) == (-0.5, -1.5, -0.5, 0.5, 1.5, 0.5)
    assert world.name == "scene"


@pytest.mark.parametrize(("axis", "index"), [("X", 0), ("Y", 1), ("Z", 2)])
def test_cones_and_capsules_lie_along_their_axis(write_usd, axis, index):
    world = named(
        load_usd(
            write_usd(f"""
def Cone "Cone" {{ double radius = 0.5; double height = 2; uniform token axis = "{axis}"; }}
def Capsule "Capsule" {{ double radius = 0.5; double height = 2; uniform token axis = "{axis}"; }}
def Capsule_1 "Drop" {{ double radiusTop = 0.25; double radiusBottom = 0.5; double height = 2;
    uniform token axis = "{axis}"; }}
""")
        )
    )
    cone = world["/Cone"].pose.transform_points(world["/Cone"].shape.vertices)
    top = cone[cone[:, index].argmax()]
    assert np.delete(top, index) == pytest.approx((0.0, 0.0))
    assert volume(world["/Cone"].shape) == pytest.approx(math.pi / 6.0, rel=5e-3)
    low, high = world["/Capsule"].bounds()
    assert (low[index], high[index]) == pytest.approx((-1.5, 1.5), abs=5e-3)
    low, high = world["/Drop"].bounds()
    assert (low[index], high[index]) == pytest.approx((-1.5, 1.25), abs=5e-3)


def test_a_plane_at_the_floor_is_the_floor_and_others_are_meshes(write_usd):
    world = load_usd(
        write_usd("""
def Plane "Floor" { double width = 10; double length = 10; uniform token axis = "Z"; }
def Plane "Wall" { double width = 4; double length = 6; uniform token axis = "X"; }
def Plane "Gate" { double width = 4; double length = 6; uniform token axis = "Y"; }
def Plane "Shelf" { double width = 4; double length = 6; uniform token axis = "Z"; double3 xformOp:translate = (0, 0, 1)
  uniform token[] xformOpOrder = ["xformOp:translate"]; }
""")
    )
    solids = named(world)
    assert sorted(solids) == ["/Gate", "/Shelf", "/Wall"]
    assert extent(solids["/Wall"]) == (0, -3, -2, 0, 3, 2)
    assert extent(solids["/Gate"]) == (-2, 0, -3, 2, 0, 3)
    assert extent(solids["/Shelf"]) == (-2, -3, 1, 2, 3, 1)


def test_units_and_axes_become_metres_with_z_up(write_usd):
    head = '#usda 1.0\n(\n metersPerUnit = 0.01\n upAxis = "Y"\n)\n'
    solid = only(
        load_usd(
            write_usd(
                """
def Cube "Cube" { double size = 100; double3 xformOp:translate = (100, 200, 300); float3 xformOp:scale = (1, 2, 3)
  uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]; }
""",
                head=head,
            )
        )
    )
    assert extent(solid) == (0.5, -4.5, 1.0, 1.5, -1.5, 3.0)
    world = load_usd(write_usd('def Cube "Cube" { double size = 1; }', head=head), meters_per_unit=1.0, up_axis="Z")
    assert only(world).shape == Box((1.0, 1.0, 1.0))


def test_a_stage_without_a_unit_is_in_centimetres_and_says_so(write_usd):
    path = write_usd('def Cube "Cube" { double size = 100; }', head='#usda 1.0\n(upAxis = "Z")\n')
    with pytest.warns(WorldWarning, match="metersPerUnit"):
        assert only(load_usd(path)).shape == Box((1.0, 1.0, 1.0))


@pytest.mark.parametrize("unit", ["0", "-1", "nan"])
def test_an_impossible_unit_is_refused(write_usd, unit):
    head = f'#usda 1.0\n(\n metersPerUnit = {unit}\n upAxis = "Z"\n)\n'
    with pytest.raises(WorldError, match="metersPerUnit"):
        load_usd(write_usd('def Cube "Cube" {}', head=head))


def test_meshes_face_outwards_whatever_their_orientation_and_mirror(write_usd):
    world = load_usd(
        write_usd(f"""
def Mesh "Right" {{ {TETRA} }}
def Mesh "Left" {{ {TETRA.replace("0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3", "0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2")}
  uniform token orientation = "leftHanded"; }}
def Xform "Mirror" {{ float3 xformOp:scale = (-1, 1, 1); uniform token[] xformOpOrder = ["xformOp:scale"]
  def Mesh "Mirrored" {{ {TETRA} }} }}
""")
    )
    assert [volume(solid.shape) for solid in world.solids] == pytest.approx([1 / 6] * 3)
    assert extent(named(world)["/Mirror/Mirrored"]) == (-1, 0, 0, 0, 1, 1)


def test_polygons_are_cut_and_holes_left_open(write_usd):
    world = load_usd(
        write_usd("""
def Mesh "L" {
    point3f[] points = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0),
                        (5, 0, 0), (6, 0, 0), (6, 1, 0)]
    int[] faceVertexCounts = [6, 3]
    int[] faceVertexIndices = [0, 1, 2, 3, 4, 5, 6, 7, 8]
    int[] holeIndices = [1]
}
""")
    )
    mesh = only(world).shape
    assert len(mesh.faces) == 4
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    assert np.cross(b - a, c - a)[:, 2].sum() / 2.0 == pytest.approx(3.0)


def test_nested_scales_and_turns_shear_a_box_into_a_mesh(write_usd):
    solid = only(
        load_usd(
            write_usd("""
def Xform "Wide" { float3 xformOp:scale = (2, 1, 1); uniform token[] xformOpOrder = ["xformOp:scale"]
  def Cube "Turned" { double size = 1; double xformOp:rotateZ = 45
    uniform token[] xformOpOrder = ["xformOp:rotateZ"]; } }
""")
        )
    )
    half = math.sqrt(0.5)
    assert isinstance(solid.shape, Mesh)
    assert volume(solid.shape) == pytest.approx(2.0)
    np.testing.assert_allclose(solid.bounds()[1], (2.0 * half, half, 0.5))


def test_random_nests_put_every_corner_where_usd_puts_it(tmp_path):
    rng = np.random.default_rng(5)
    stage = Usd.Stage.CreateNew(str(tmp_path / "nest.usda"))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, "Z")
    for number in range(20):
        path = ""
        for depth in range(3):
            path += f"/N{number}_{depth}"
            xform = UsdGeom.Xform.Define(stage, path)
            xform.AddTranslateOp().Set(Gf.Vec3d(*rng.normal(size=3)))
            xform.AddRotateXYZOp().Set(Gf.Vec3f(*rng.uniform(-180, 180, size=3)))
            scale = rng.uniform(0.3, 2.0, size=3) * rng.choice([-1, 1], size=3)
            xform.AddScaleOp().Set(Gf.Vec3f(*(scale if number % 2 else np.full(3, scale[0]))))
        UsdGeom.Cube.Define(stage, path + "/Cube").CreateSizeAttr(1.0)
        UsdGeom.Sphere.Define(stage, path + "/Sphere").CreateRadiusAttr(0.5)
    stage.Save()
    solids = named(load_usd(tmp_path / "nest.usda"))
    assert len(solids) == 40
    cache = UsdGeom.XformCache()
    for name, solid in solids.items():
        matrix = np.array(cache.GetLocalToWorldTransform(stage.GetPrimAtPath(name))).T
        reach = np.abs(matrix[:3, :3]).sum(axis=1) / 2.0
        if name.endswith("Sphere"):
            reach = np.linalg.norm(matrix[:3, :3], axis=1) / 2.0
        low, high = solid.bounds()
        np.testing.assert_allclose((low + high) / 2.0, matrix[:3, 3], atol=1e-5)
        np.testing.assert_allclose((high - low) / 2.0, reach, rtol=5e-3 if isinstance(solid.shape, Mesh) else 1e-5)
        if isinstance(solid.shape, Mesh):
            assert volume(solid.shape) > 0.0
    assert any(isinstance(solid.shape, Box) for solid in solids.values())
    assert any(isinstance(solid.shape, Mesh) for solid in solids.values())


def test_a_reset_of_the_transform_stack_leaves_the_parents_out(write_usd):
    solid = only(
        load_usd(
            write_usd("""
def Xform "Away" { double3 xformOp:translate = (9, 9, 9); uniform token[] xformOpOrder = ["xformOp:translate"]
  def Cube "Cube" { double size = 1; double3 xformOp:translate = (1, 0, 0)
    uniform token[] xformOpOrder = ["!resetXformStack!", "xformOp:translate"]; } }
""")
        )
    )
    assert solid.pose.position == (1.0, 0.0, 0.0)


def test_colours_come_from_display_colour_else_from_the_material(tmp_path):
    stage = Usd.Stage.CreateNew(str(tmp_path / "colours.usda"))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    group = UsdGeom.Xform.Define(stage, "/Group")
    UsdGeom.PrimvarsAPI(group).CreatePrimvar("displayColor", Sdf.ValueTypeNames.Color3fArray).Set([(1, 0, 0)])
    UsdGeom.Cube.Define(stage, "/Group/Inherits")
    clear = UsdGeom.Cube.Define(stage, "/Clear")
    clear.CreateDisplayColorAttr([(0, 1, 0), (0, 0, 1)])
    clear.CreateDisplayOpacityAttr([0.25])
    material = UsdShade.Material.Define(stage, "/Blue")
    shader = UsdShade.Shader.Define(stage, "/Blue/Shader")
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set((0, 0, 1))
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    cube = UsdGeom.Cube.Define(stage, "/Painted")
    UsdShade.MaterialBindingAPI.Apply(cube.GetPrim()).Bind(material)
    UsdGeom.Cube.Define(stage, "/Plain")
    stage.Save()
    colors = {name: solid.color for name, solid in named(load_usd(tmp_path / "colours.usda")).items()}
    assert colors == {
        "/Group/Inherits": (1.0, 0.0, 0.0, 1.0),
        "/Clear": (0.0, 0.5, 0.5, 0.25),
        "/Painted": (0.0, 0.0, 1.0, 1.0),
        "/Plain": (0.6, 0.6, 0.62, 1.0),
    }


def test_world_load_takes_usd_by_suffix_and_lists_as_text(write_usd):
    path = write_usd(
        'def Cube "A" { double size = 1; } def Cube "B" { double size = 1; } def Cube "C" { double size = 1; }'
    )
    assert [solid.name for solid in World.load(path, exclude="/A, /C").solids] == ["/B"]
    with pytest.warns(WorldWarning, match="contains no solids"):
        World.load(write_usd(""))


def test_a_world_from_usd_has_a_map(write_usd):
    from trundle.maps import OccupancyGrid

    path = write_usd("""
def Cube "Pillar" { double size = 1; }
def Xform "Frame" { float3 xformOp:scale = (-1, 1, 1); uniform token[] xformOpOrder = ["xformOp:scale"]
    def Cube "Wall" { double size = 1; double3 xformOp:translate = (3, 0, 0.5); float3 xformOp:scale = (0.1, 4, 1)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]; } }
""")
    grid = OccupancyGrid.from_world(load_usd(path), resolution=0.1)
    assert (grid.data == 100).any()
