"""Which prims of a USD scene become solids: visibility, purpose, colliders, and parts left out by name or label."""

import math
import warnings

import pytest

from support.usd_scenes import TETRA, UNIT, named, only, volume
from trundle.errors import WorldWarning
from trundle.geometry.solids import Box, Mesh, Sphere
from trundle.worlds.usd import load_usd

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


def test_visibility_and_purpose(write_usd):
    path = write_usd(SEEN)
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


def test_colliders_or_looks_are_the_users_choice(write_usd):
    path = write_usd(COLLIDERS)
    colliders = ["/Rack/Collider", "/Rack/Group/Ball"]
    assert [solid.name for solid in load_usd(path, geometry="collision").solids] == colliders
    assert [solid.name for solid in load_usd(path).solids] == colliders
    looks = [solid.name for solid in load_usd(path, geometry="visual").solids]
    assert looks == ["/Rack/Look", "/Rack/Off", "/Rack/Group/Ball"]


def test_what_is_seen_far_from_any_collider_is_said(write_usd):
    def cube(name: str, x: float, z: float = 0.5, collides: bool = False, size: str = "1, 1, 1") -> str:
        api = '(prepend apiSchemas = ["PhysicsCollisionAPI"])' if collides else ""
        return f"""def Cube "{name}" {api} {{ double size = 1
            double3 xformOp:translate = ({x}, 0, {z}); float3 xformOp:scale = ({size})
            uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]; }}"""

    stage = cube("Ground", 0, -0.5, True, "99, 99, 1") + cube("Rack", 0, collides=True) + cube("Look", 0.2)
    stage += cube("Lamp", 4, 3.0) + cube("Paint", 4, -0.5)
    assert len(load_usd(write_usd(stage)).solids) == 2
    forgotten = stage + cube("Wall", 5) + cube("Door", 7)
    with pytest.warns(WorldWarning, match="2 visible shapes without a collider nearby.*first is /Wall"):
        load_usd(write_usd(forgotten))
    assert len(load_usd(write_usd(forgotten), geometry="collision").solids) == 2


def test_a_floor_collider_alone_does_not_hide_what_is_seen(write_usd):
    path = write_usd("""
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
def test_colliders_have_the_shape_of_their_approximation(write_usd, approximation, expected):
    path = write_usd(f"""
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
def test_things_are_left_out_by_path_label_and_place(write_usd, exclude, gone):
    path = write_usd(LABELLED)
    everything = {solid.name for solid in load_usd(path).solids}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        left = {solid.name for solid in load_usd(path, exclude=exclude).solids}
    assert everything - left == {f"/World/{name}" for name in gone}
    assert ["nothing to exclude matches" in str(warning.message) for warning in caught] == ([] if gone else [True])


def test_labels_are_kinds(write_usd):
    solids = named(load_usd(write_usd(LABELLED)))
    assert (solids["/World/Pallets/One"].kind, solids["/World/Old"].kind) == ("Pallet", "rack")
    assert solids["/World/Robot2"].kind == ""


def test_a_robot_in_the_scene_is_pointed_out(write_usd):
    path = write_usd("""
def Xform "Carter" (prepend apiSchemas = ["PhysicsArticulationRootAPI"]) { def Cube "Body" { double size = 1; } }
def Cube "Box" { double size = 1; }
""")
    with pytest.warns(WorldWarning, match="/Carter is an articulation"):
        load_usd(path)
    assert only(load_usd(path, exclude=["/Carter"])).name == "/Box"


def test_a_world_of_which_nothing_is_chosen_says_why(write_usd):
    with pytest.warns(WorldWarning, match="of the purposes default, render"):
        load_usd(write_usd('def Cube "Gone" { token visibility = "invisible"; }'))
