import math
import sys
import warnings

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdShade, UsdUtils, Vt

from trundle.errors import InputError, MissingExtraError, WorldError, WorldWarning
from trundle.solids import Box, Cylinder, Mesh, Sphere
from trundle.worlds import World
from trundle.worlds.usd import load_usd

HEAD = '#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = "Z"\n)\n'
UNIT = "double size = 1"


@pytest.fixture
def write(tmp_path):
    def write(text: str, name: str = "scene.usda", head: str = HEAD):
        # USD wants what follows a prim on a line of its own; the scenes here are shorter without.
        (tmp_path / name).write_text(head + text.replace("}", "}\n"))
        return tmp_path / name

    return write


def only(world):
    (solid,) = world.solids
    return solid


def extent(solid):
    low, high = solid.bounds()
    return tuple(np.round(np.concatenate([low, high]), 6))


def volume(mesh: Mesh) -> float:
    a, b, c = np.moveaxis(mesh.vertices[mesh.faces], 1, 0)
    return float((np.cross(a, b) * c).sum() / 6.0)


def named(world):
    return {solid.name: solid for solid in world.solids}


def test_primitives_come_as_what_they_are(write):
    world = load_usd(
        write("""
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
def test_cones_and_capsules_lie_along_their_axis(write, axis, index):
    world = named(
        load_usd(
            write(f"""
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


def test_a_plane_at_the_floor_is_the_floor_and_others_are_meshes(write):
    world = load_usd(
        write("""
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


def test_units_and_axes_become_metres_with_z_up(write):
    head = '#usda 1.0\n(\n metersPerUnit = 0.01\n upAxis = "Y"\n)\n'
    solid = only(
        load_usd(
            write(
                """
def Cube "Cube" { double size = 100; double3 xformOp:translate = (100, 200, 300); float3 xformOp:scale = (1, 2, 3)
  uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]; }
""",
                head=head,
            )
        )
    )
    assert extent(solid) == (0.5, -4.5, 1.0, 1.5, -1.5, 3.0)
    world = load_usd(write('def Cube "Cube" { double size = 1; }', head=head), meters_per_unit=1.0, up_axis="Z")
    assert only(world).shape == Box((1.0, 1.0, 1.0))


def test_a_stage_without_a_unit_is_in_centimetres_and_says_so(write):
    path = write('def Cube "Cube" { double size = 100; }', head='#usda 1.0\n(upAxis = "Z")\n')
    with pytest.warns(WorldWarning, match="metersPerUnit"):
        assert only(load_usd(path)).shape == Box((1.0, 1.0, 1.0))


@pytest.mark.parametrize("unit", ["0", "-1", "nan"])
def test_an_impossible_unit_is_refused(write, unit):
    head = f'#usda 1.0\n(\n metersPerUnit = {unit}\n upAxis = "Z"\n)\n'
    with pytest.raises(WorldError, match="metersPerUnit"):
        load_usd(write('def Cube "Cube" {}', head=head))


TETRA = """
    point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    int[] faceVertexCounts = [3, 3, 3, 3]
    int[] faceVertexIndices = [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]
"""


def test_meshes_face_outwards_whatever_their_orientation_and_mirror(write):
    world = load_usd(
        write(f"""
def Mesh "Right" {{ {TETRA} }}
def Mesh "Left" {{ {TETRA.replace("0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3", "0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2")}
  uniform token orientation = "leftHanded"; }}
def Xform "Mirror" {{ float3 xformOp:scale = (-1, 1, 1); uniform token[] xformOpOrder = ["xformOp:scale"]
  def Mesh "Mirrored" {{ {TETRA} }} }}
""")
    )
    assert [volume(solid.shape) for solid in world.solids] == pytest.approx([1 / 6] * 3)
    assert extent(named(world)["/Mirror/Mirrored"]) == (-1, 0, 0, 0, 1, 1)


def test_polygons_are_cut_and_holes_left_open(write):
    world = load_usd(
        write("""
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


def test_nested_scales_and_turns_shear_a_box_into_a_mesh(write):
    solid = only(
        load_usd(
            write("""
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


def test_a_reset_of_the_transform_stack_leaves_the_parents_out(write):
    solid = only(
        load_usd(
            write("""
def Xform "Away" { double3 xformOp:translate = (9, 9, 9); uniform token[] xformOpOrder = ["xformOp:translate"]
  def Cube "Cube" { double size = 1; double3 xformOp:translate = (1, 0, 0)
    uniform token[] xformOpOrder = ["!resetXformStack!", "xformOp:translate"]; } }
""")
        )
    )
    assert solid.pose.position == (1.0, 0.0, 0.0)


INSTANCER = """
def PointInstancer "Racks" {
    rel prototypes = [</Racks/Protos/Tall>, </Racks/Protos/Low>]
    int[] protoIndices = [0, 1, 0]
    point3f[] positions = [(0, 0, 0), (5, 0, 0), (0, 5, 0)]
    float3[] scales = [(1, 1, 1), (1, 1, 1), (2, 2, 2)]
    quath[] orientations = [(1, 0, 0, 0), (1, 0, 0, 0), (1, 0, 0, 0)]
    EXTRA
    def Scope "Protos" {
        def Xform "Tall" { double3 xformOp:translate = (0, 0, 1); uniform token[] xformOpOrder = ["xformOp:translate"]
            def Cube "Post" { double size = 1; } }
        def Sphere "Low" { double radius = 0.5; }
    }
}
"""


def test_point_instancers_place_their_prototypes_and_nothing_else(write):
    solids = named(load_usd(write(INSTANCER.replace("EXTRA", ""))))
    assert sorted(solids) == ["/Racks[0]/Tall/Post", "/Racks[1]/Low", "/Racks[2]/Tall/Post"]
    assert solids["/Racks[2]/Tall/Post"].shape == Box((2.0, 2.0, 2.0))
    assert solids["/Racks[2]/Tall/Post"].pose.position == (0.0, 5.0, 2.0)
    assert solids["/Racks[1]/Low"].pose.position == (5.0, 0.0, 0.0)


@pytest.mark.parametrize("home", ["class", "over"])
def test_prototypes_may_be_kept_where_nothing_is_drawn(write, home):
    solids = named(load_usd(write(INSTANCER.replace("EXTRA", "").replace("def Scope", f"{home}"))))
    assert sorted(solids) == ["/Racks[0]/Tall/Post", "/Racks[1]/Low", "/Racks[2]/Tall/Post"]


def test_an_instanced_instancer_is_mirrored_as_a_whole(write):
    write(INSTANCER.replace("EXTRA", ""), "lib.usda")
    path = write("""
def Xform "Hall" { float3 xformOp:scale = (-1, 1, 1); uniform token[] xformOpOrder = ["xformOp:scale"]
  def "A" (prepend references = @lib.usda@</Racks>; instanceable = true) {}
  def "B" (prepend references = @lib.usda@</Racks>; instanceable = true) {
    double3 xformOp:translate = (0, 0, 7); uniform token[] xformOpOrder = ["xformOp:translate"]; } }
""")
    at = {name: solid.pose.position for name, solid in named(load_usd(path)).items()}
    assert at["/Hall/B[1]/Low"] == pytest.approx((-5.0, 0.0, 7.0))
    assert at["/Hall/A[2]/Tall/Post"] == pytest.approx((0.0, 5.0, 2.0))
    assert len(at) == 6


def test_hidden_instances_stay_hidden_and_can_be_left_out_by_prototype_or_number(write):
    path = write(INSTANCER.replace("EXTRA", "int64[] invisibleIds = [1]"))
    assert len(load_usd(path).solids) == 2
    assert [solid.name for solid in load_usd(path, exclude=["/Racks[0]"]).solids] == ["/Racks[2]/Tall/Post"]
    assert [solid.name for solid in load_usd(path, exclude=["*cks[0]*"]).solids] == ["/Racks[2]/Tall/Post"]
    assert load_usd(path, exclude=["/Racks/Protos/Tall"]).solids == ()


@pytest.mark.parametrize(
    ("before", "after", "said"),
    [
        ("[0, 1, 0]", "[0, 7, 0]", "instance 1 refers to prototype 7"),
        ("[0, 1, 0]", "[0, 1]", "for each of its protoIndices"),
        ("(5, 0, 0)", "(nan, 0, 0)", "instance 1 is not finite"),
        ("</Racks/Protos/Tall>,", "</Racks/None>,", "instance 0 refers to prototype 0"),
        ("</Racks/Protos/Tall>,", "</Racks>,", "prototype of itself"),
    ],
)
def test_an_instancer_that_does_not_fit_together_is_named(write, before, after, said):
    with pytest.raises(WorldError, match=f"/Racks.*{said}"):
        load_usd(write(INSTANCER.replace("EXTRA", "").replace(before, after)))


ASSET = """
def Xform "Asset" (variants = {{ string size = "small" }} prepend variantSets = "size") {{
    variantSet "size" = {{
        "small" {{ def Cube "Body" {{ double size = 1; }} }}
        "large" {{ def Cube "Body" {{ double size = 4; }} }}
    }}
    def Mesh "Tip" {{ {tetra} }}
}}
"""


def test_references_payloads_variants_and_native_instances(write):
    write(ASSET.format(tetra=TETRA), "asset.usda")
    path = write("""
def "A" (prepend references = @asset.usda@</Asset>; instanceable = true) {}
def "B" (prepend payload = @asset.usda@</Asset>; variants = { string size = "large" }) {}
def "C" (prepend references = @asset.usda@</Asset>; instanceable = true) {
    double3 xformOp:translate = (0, 9, 0); uniform token[] xformOpOrder = ["xformOp:translate"]; }
""")
    solids = named(load_usd(path))
    assert solids["/A/Body"].shape == Box((1.0, 1.0, 1.0))
    assert solids["/B/Body"].shape == Box((4.0, 4.0, 4.0))
    assert solids["/C/Body"].pose.position == (0.0, 9.0, 0.0)
    assert solids["/A/Tip"].shape is solids["/C/Tip"].shape
    solids = named(load_usd(path, variants=["/A{size=large}"]))
    assert solids["/A/Body"].shape == Box((4.0, 4.0, 4.0))


@pytest.mark.parametrize(
    ("selection", "said"),
    [
        ("/A{size=huge}", "no 'huge'; it has: large, small"),
        ("/A{colour=red}", "no variant set 'colour'; it has: size"),
        ("/Z{size=small}", "no prim /Z"),
        ("A size large", "selected as"),
    ],
)
def test_a_variant_that_is_not_there_says_what_is(write, selection, said):
    write(ASSET.format(tetra=TETRA), "asset.usda")
    path = write('def "A" (prepend references = @asset.usda@</Asset>) {}')
    with pytest.raises(WorldError, match=said):
        load_usd(path, variants=[selection])


MISSING = """
def Xform "World" {
    def "Gone" (prepend references = @gone.usd@) {}
    def "Broken" (prepend payload = @broken.usda@) {}
    def "Nobody" (prepend references = @fine.usda@</Nobody>) {}
    def Cube "Here" { double size = 1; }
}
"""


def test_what_cannot_be_had_is_named_and_skipped_or_refused(write, capfd):
    write("def Xform {", "broken.usda")
    write('def Cube "Fine" {}', "fine.usda")
    path = write(MISSING)
    with pytest.warns(WorldWarning) as caught:
        assert only(load_usd(path)).name == "/World/Here"
    said = " ".join(str(warning.message) for warning in caught)
    assert all(word in said for word in ("/World/Gone", "gone.usd", "/World/Broken", "broken.usda", "/World/Nobody"))
    with pytest.raises(WorldError, match="/World/Gone"):
        load_usd(path, missing="error")
    assert capfd.readouterr().err == ""


def test_what_is_missing_under_what_is_left_out_is_no_matter(write):
    world = load_usd(write(MISSING), exclude=["/World/Gone", "/World/Broken", "/World/Nobody"], missing="error")
    assert only(world).name == "/World/Here"


def test_a_missing_sublayer_is_reported(write):
    head = '#usda 1.0\n(\n metersPerUnit = 1\n upAxis = "Z"\n subLayers = [@below.usda@]\n)\n'
    with pytest.warns(WorldWarning, match=r"below\.usda"):
        load_usd(write('def Cube "Cube" {}', head=head))


SEEN = """
def Cube "Shown" { double size = 1; }
def Xform "Hidden" { token visibility = "invisible"; def Cube "Cube" { double size = 2; } }
def Xform "Guides" { uniform token purpose = "guide"; def Cube "Cube" { double size = 3; } }
def Cube "Rendered" { uniform token purpose = "render"; double size = 4; }
def Cube "Inactive" (active = false) { double size = 5; }
class Cube "Class" { double size = 6; }
over Cube "Over" { double size = 7; }
def Cube "Late" { double size = 8; token visibility.timeSamples = { 0: "invisible", 9: "inherited" } }
"""


def test_visibility_and_purpose(write):
    path = write(SEEN)
    assert [solid.name for solid in load_usd(path).solids] == ["/Shown", "/Rendered"]
    assert [solid.name for solid in load_usd(path, purposes=["guide"]).solids] == ["/Guides/Cube"]


COLLIDERS = f"""
def Xform "Rack" {{
    def Mesh "Look" {{ {TETRA} }}
    def Cube "Collider" (prepend apiSchemas = ["PhysicsCollisionAPI"]) {{ {UNIT};
        uniform token purpose = "guide"; token visibility = "invisible"; }}
    def Cube "Off" (prepend apiSchemas = ["PhysicsCollisionAPI"]) {{ {UNIT}; bool physics:collisionEnabled = false; }}
    def Xform "Group" (prepend apiSchemas = ["PhysicsCollisionAPI"]) {{ def Sphere "Ball" {{ double radius = 1; }} }}
}}
"""


def test_colliders_or_looks_are_the_users_choice(write):
    path = write(COLLIDERS)
    colliders = ["/Rack/Collider", "/Rack/Group/Ball"]
    assert [solid.name for solid in load_usd(path, geometry="collision").solids] == colliders
    assert [solid.name for solid in load_usd(path).solids] == colliders
    looks = [solid.name for solid in load_usd(path, geometry="visual").solids]
    assert looks == ["/Rack/Look", "/Rack/Off", "/Rack/Group/Ball"]


def test_what_is_seen_far_from_any_collider_is_said(write):
    def cube(name: str, x: float, z: float = 0.5, collides: bool = False, size: str = "1, 1, 1") -> str:
        api = '(prepend apiSchemas = ["PhysicsCollisionAPI"])' if collides else ""
        return f"""def Cube "{name}" {api} {{ double size = 1
            double3 xformOp:translate = ({x}, 0, {z}); float3 xformOp:scale = ({size})
            uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]; }}"""

    stage = cube("Ground", 0, -0.5, True, "99, 99, 1") + cube("Rack", 0, collides=True) + cube("Look", 0.2)
    stage += cube("Lamp", 4, 3.0) + cube("Paint", 4, -0.5)
    assert len(load_usd(write(stage)).solids) == 2
    forgotten = stage + cube("Wall", 5) + cube("Door", 7)
    with pytest.warns(WorldWarning, match="2 visible shapes without a collider nearby.*first is /Wall"):
        load_usd(write(forgotten))
    assert len(load_usd(write(forgotten), geometry="collision").solids) == 2


def test_a_floor_collider_alone_does_not_hide_what_is_seen(write):
    path = write("""
def Plane "Ground" (prepend apiSchemas = ["PhysicsCollisionAPI"]) { uniform token axis = "Z"; }
def Cube "Box" { double size = 1; }
""")
    assert only(load_usd(path)).name == "/Box"
    with pytest.warns(WorldWarning, match="empty.*collider"):
        load_usd(path, geometry="collision")


NOTCHED = """
    point3f[] points = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0),
                        (0, 0, 1), (2, 0, 1), (2, 1, 1), (1, 1, 1), (1, 2, 1), (0, 2, 1)]
    int[] faceVertexCounts = [6, 6, 4, 4, 4, 4, 4, 4]
    int[] faceVertexIndices = [5, 4, 3, 2, 1, 0, 6, 7, 8, 9, 10, 11, 0, 1, 7, 6, 1, 2, 8, 7, 2, 3, 9, 8,
                               3, 4, 10, 9, 4, 5, 11, 10, 5, 0, 6, 11]
"""


@pytest.mark.parametrize(
    ("approximation", "expected"),
    [
        ("none", 3.0), ("meshSimplification", 3.0), ("convexDecomposition", 3.0), ("sdf", 3.0),
        ("convexHull", 3.5), ("boundingCube", 4.0), ("boundingSphere", None),
    ],
)  # fmt: skip
def test_colliders_have_the_shape_of_their_approximation(write, approximation, expected):
    path = write(f"""
def Mesh "L" (prepend apiSchemas = ["PhysicsCollisionAPI", "PhysicsMeshCollisionAPI"]) {{ {NOTCHED}
    uniform token physics:approximation = "{approximation}"
    float3 xformOp:scale = (2, 2, 2); uniform token[] xformOpOrder = ["xformOp:scale"]; }}
""")
    solid = only(load_usd(path))
    match solid.shape:
        case Mesh() as mesh:
            assert volume(mesh) == pytest.approx(8.0 * expected)
        case Box(size):
            assert math.prod(size) == pytest.approx(8.0 * expected)
            assert solid.pose.position == pytest.approx((2.0, 2.0, 1.0))
        case Sphere(radius):
            assert expected is None
            assert radius == pytest.approx(3.0)
    assert volume(only(load_usd(path, geometry="visual")).shape) == pytest.approx(24.0)


LABELLED = """
def Xform "World" {
    def Xform "Robot" { def Cube "Body" { double size = 1; } }
    def Cube "Robot2" { double size = 1; }
    def Xform "Pallets" (prepend apiSchemas = ["SemanticsLabelsAPI:class"]) {
        token[] semantics:labels:class = ["Pallet", "wood"]; def Cube "One" { double size = 1; } }
    def Cube "Old" (prepend apiSchemas = ["SemanticsAPI:Semantics_x"]) { double size = 1
        string semantic:Semantics_x:params:semanticData = "rack"
        string semantic:Semantics_x:params:semanticType = "class"; }
    def Cube "Slab" { double size = 1; double3 xformOp:translate = (0, 0, -0.05); float3 xformOp:scale = (9, 9, 0.1)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]; }
    def Cube "Roof" { double size = 1; double3 xformOp:translate = (0, 0, 4); float3 xformOp:scale = (9, 9, 0.1)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]; }
}
"""


@pytest.mark.parametrize(
    ("exclude", "gone"),
    [
        (["/World/Robot"], {"Robot/Body"}),
        (["/World/Robot/"], {"Robot/Body"}),
        (["/World/Robot*"], {"Robot/Body", "Robot2"}),
        (["*/Body"], {"Robot/Body"}),
        (["Robot"], set()),
        (["pallet", "RACK"], {"Pallets/One", "Old"}),
        (["wood"], {"Pallets/One"}),
        (["pal*"], {"Pallets/One"}),
        (["floor"], {"Slab"}),
        (["ceiling"], {"Roof"}),
    ],
)
def test_things_are_left_out_by_path_label_and_place(write, exclude, gone):
    path = write(LABELLED)
    everything = {solid.name for solid in load_usd(path).solids}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        left = {solid.name for solid in load_usd(path, exclude=exclude).solids}
    assert everything - left == {f"/World/{name}" for name in gone}
    assert ["nothing to exclude matches" in str(warning.message) for warning in caught] == ([] if gone else [True])


def test_labels_are_kinds(write):
    solids = named(load_usd(write(LABELLED)))
    assert (solids["/World/Pallets/One"].kind, solids["/World/Old"].kind) == ("Pallet", "rack")
    assert solids["/World/Robot2"].kind == ""


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


def test_a_robot_in_the_scene_is_pointed_out(write):
    path = write("""
def Xform "Carter" (prepend apiSchemas = ["PhysicsArticulationRootAPI"]) { def Cube "Body" { double size = 1; } }
def Cube "Box" { double size = 1; }
""")
    with pytest.warns(WorldWarning, match="/Carter is an articulation"):
        load_usd(path)
    assert only(load_usd(path, exclude=["/Carter"])).name == "/Box"


@pytest.mark.parametrize(
    ("prim", "said"),
    [
        (
            "point3f[] points = [(nan, 0, 0)]; int[] faceVertexCounts = [3]; int[] faceVertexIndices = [0, 0, 0];",
            "not finite",
        ),
        (
            "point3f[] points = [(1, 0, 0)]; int[] faceVertexCounts = [3]; int[] faceVertexIndices = [0, 1, 2];",
            r"outside 0\.\.0",
        ),
        (
            "point3f[] points = [(1, 0, 0)]; int[] faceVertexCounts = [4]; int[] faceVertexIndices = [0, 0, 0];",
            "4 corners",
        ),
    ],
)
def test_a_mesh_whose_numbers_do_not_fit_is_refused_by_name(write, prim, said):
    with pytest.raises(WorldError, match=f"scene.usda: /World/Bad: .*{said}"):
        load_usd(write(f'def Xform "World" {{ def Mesh "Bad" {{ {prim} }} }}'))


SCALE = 'float3 xformOp:scale = ({}); uniform token[] xformOpOrder = ["xformOp:scale"];'


@pytest.mark.parametrize(
    ("prim", "said"),
    [
        ('def Mesh "Bad" {}', "no faces"),
        (f'def Mesh "Bad" {{ {TETRA} int[] holeIndices = [0, 1, 2, 3]; }}', "no faces"),
        ('def Sphere "Bad" { double radius = 0; }', "radius is 0"),
        ('def Capsule_1 "Bad" { double radiusTop = 0; double radiusBottom = 0; }', "radii are 0"),
        (f'def Cube "Bad" {{ {SCALE.format("0, 0, 0")} }}', "scale of 0"),
        (f'def Mesh "Bad" {{ {TETRA} {SCALE.format("0, 0, 2")} }}', "scale of 0"),
        ('def BasisCurves "Bad" {}', "BasisCurves have no solid shape"),
    ],
)  # fmt: skip
def test_what_there_is_nothing_of_is_left_out_with_a_warning(write, prim, said):
    path = write(f'{prim}\ndef Cube "Good" {{ double size = 1; }}')
    with pytest.warns(WorldWarning, match=said) as caught:
        assert only(load_usd(path)).name == "/Good"
    assert "/Bad" in str(caught[0].message)


@pytest.mark.parametrize("value", ["-1", "nan", "inf"])
def test_an_impossible_size_is_refused_by_name(write, value):
    with pytest.raises(WorldError, match="/Bad: size"):
        load_usd(write(f'def Cube "Bad" {{ double size = {value}; }}'))


def test_a_transform_that_is_not_finite_is_refused_by_name(write):
    with pytest.raises(WorldError, match="/Bad: its transform"):
        load_usd(
            write(
                'def Xform "Bad" { double3 xformOp:translate = (nan, 0, 0);'
                ' uniform token[] xformOpOrder = ["xformOp:translate"]; }'
            )
        )


def test_a_world_of_which_nothing_is_chosen_says_why(write):
    with pytest.warns(WorldWarning, match="of the purposes default, render"):
        load_usd(write('def Cube "Gone" { token visibility = "invisible"; }'))


def test_world_load_takes_usd_by_suffix_and_lists_as_text(write):
    path = write(
        'def Cube "A" { double size = 1; } def Cube "B" { double size = 1; } def Cube "C" { double size = 1; }'
    )
    assert [solid.name for solid in World.load(path, exclude="/A, /C").solids] == ["/B"]
    with pytest.warns(WorldWarning, match="contains no solids"):
        World.load(write(""))


@pytest.fixture(scope="module")
def crate(tmp_path_factory):
    path = tmp_path_factory.mktemp("crate") / "whole.usdc"
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    for number in range(4):
        mesh = UsdGeom.Mesh.Define(stage, f"/World/Mesh{number}")
        points = np.random.default_rng(number).random((200, 3), dtype=np.float32)
        mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(points))
        mesh.CreateFaceVertexCountsAttr([3] * 60)
        mesh.CreateFaceVertexIndicesAttr(list(range(180)))
    stage.Save()
    return path.read_bytes()


def test_a_package_with_all_it_refers_to_loads(write, tmp_path):
    write(ASSET.format(tetra=TETRA), "asset.usda")
    path = write('def "A" (prepend references = @asset.usda@</Asset>) {}')
    assert UsdUtils.CreateNewUsdzPackage(str(path), str(tmp_path / "scene.usdz"))
    (tmp_path / "asset.usda").unlink()
    assert {solid.name for solid in World.load(tmp_path / "scene.usdz").solids} == {"/A/Body", "/A/Tip"}


def test_a_whole_crate_loads(tmp_path, crate):
    (tmp_path / "whole.usdc").write_bytes(crate)
    assert len(load_usd(tmp_path / "whole.usdc").solids) == 4


@pytest.mark.parametrize("share", [0.0, 0.01, 0.1, 0.5, 0.9, 0.99, 0.9999])
def test_a_truncated_crate_is_one_clear_error(tmp_path, crate, share, capfd):
    path = tmp_path / "cut.usdc"
    path.write_bytes(crate[: int(share * len(crate))])
    with pytest.raises(WorldError, match=r"cut\.usdc: cannot be read as a USD file"):
        load_usd(path)
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize("name", ["noise.usd", "noise.usda", "noise.usdc", "noise.usdz"])
def test_garbage_is_one_clear_error(tmp_path, name):
    (tmp_path / name).write_bytes(np.random.default_rng(1).bytes(5000))
    with pytest.raises(WorldError, match=f"{name}: cannot be read as a USD file"):
        load_usd(tmp_path / name)


@pytest.mark.parametrize("place", ["name", "metadata", "comment"])
def test_bytes_that_are_no_text_are_one_clear_error(tmp_path, place):
    text = {
        "name": HEAD + 'def Cube "A?" {\n}\n',
        "metadata": HEAD + 'def Cube "A" (\n doc = ?\n) {\n}\n',
        "comment": HEAD + 'def Cub? "A" {\n}\n def x',
    }[place]
    (tmp_path / "scene.usda").write_bytes(text.encode().replace(b"?", b"\xc3\x28\xff"))
    with pytest.raises(WorldError, match=r"scene\.usda: cannot be read as a USD file"):
        load_usd(tmp_path / "scene.usda")


@pytest.mark.parametrize(
    ("prim", "said"),
    [
        ('def Cube "Bad" { doubl size = 1; }', "/Bad: size must be a number"),
        ('def Plane "Bad" { toke axis = "Y"; }', "/Bad: axis must be X, Y or Z"),
        ('def Cone "Bad" { uniform token axis = "W"; }', "/Bad: axis must be X, Y or Z, got W"),
        (f'def Mesh "Bad" {{ {TETRA.replace("point3f[] points", "point3ff[] points")} }}', "/Bad: points"),
    ],
)
def test_values_of_a_type_that_there_is_not_are_refused_by_name(write, prim, said):
    with pytest.raises(WorldError, match=said):
        load_usd(write(prim))


def test_a_syntax_error_has_its_line(write):
    with pytest.raises(WorldError, match=r"scene\.usda:7:"):
        load_usd(write('def Cube "A" {\n  what is this\n}'))


def test_a_missing_file_says_so(tmp_path):
    with pytest.raises(WorldError, match="no such file"):
        load_usd(tmp_path / "none.usd")


@pytest.mark.parametrize(
    "options",
    [{"geometry": "pretty"}, {"missing": "ignore"}, {"purposes": ["all"]}, {"up_axis": "X"}],
)
def test_an_option_that_there_is_not_lists_those_that_there_are(write, options):
    with pytest.raises(InputError, match="one of"):
        load_usd(write('def Cube "A" {}'), **options)


def test_without_usd_core_the_install_line_is_given(write, monkeypatch):
    monkeypatch.setitem(sys.modules, "pxr.Usd", None)
    with pytest.raises(MissingExtraError, match=r'pip install "trundle\[usd\]"'):
        load_usd(write('def Cube "A" {}'))


def test_a_world_from_usd_has_a_map(write):
    from trundle.maps import OccupancyGrid

    path = write("""
def Cube "Pillar" { double size = 1; }
def Xform "Frame" { float3 xformOp:scale = (-1, 1, 1); uniform token[] xformOpOrder = ["xformOp:scale"]
    def Cube "Wall" { double size = 1; double3 xformOp:translate = (3, 0, 0.5); float3 xformOp:scale = (0.1, 4, 1)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]; } }
""")
    grid = OccupancyGrid.from_world(load_usd(path), resolution=0.1)
    assert (grid.data == 100).any()
