"""Composition of USD scenes: instancers, references, payloads, variants, and missing files."""

import pytest
from pxr import UsdUtils

from support.usd_scenes import TETRA, named, only
from trundle.errors import WorldError, WorldWarning
from trundle.geometry.solids import Box
from trundle.worlds import World
from trundle.worlds.usd import load_usd

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


def test_point_instancers_place_their_prototypes_and_nothing_else(write_usd):
    solids = named(load_usd(write_usd(INSTANCER.replace("EXTRA", ""))))
    assert sorted(solids) == ["/Racks[0]/Tall/Post", "/Racks[1]/Low", "/Racks[2]/Tall/Post"]
    assert solids["/Racks[2]/Tall/Post"].shape == Box((2.0, 2.0, 2.0))
    assert solids["/Racks[2]/Tall/Post"].pose.position == (0.0, 5.0, 2.0)
    assert solids["/Racks[1]/Low"].pose.position == (5.0, 0.0, 0.0)


@pytest.mark.parametrize("home", ["class", "over"])
def test_prototypes_may_be_kept_where_nothing_is_drawn(write_usd, home):
    solids = named(load_usd(write_usd(INSTANCER.replace("EXTRA", "").replace("def Scope", f"{home}"))))
    assert sorted(solids) == ["/Racks[0]/Tall/Post", "/Racks[1]/Low", "/Racks[2]/Tall/Post"]


def test_an_instanced_instancer_is_mirrored_as_a_whole(write_usd):
    write_usd(INSTANCER.replace("EXTRA", ""), "lib.usda")
    path = write_usd("""
def Xform "Hall" { float3 xformOp:scale = (-1, 1, 1); uniform token[] xformOpOrder = ["xformOp:scale"]
  def "A" (prepend references = @lib.usda@</Racks>; instanceable = true) {}
  def "B" (prepend references = @lib.usda@</Racks>; instanceable = true) {
    double3 xformOp:translate = (0, 0, 7); uniform token[] xformOpOrder = ["xformOp:translate"]; } }
""")
    at = {name: solid.pose.position for name, solid in named(load_usd(path)).items()}
    assert at["/Hall/B[1]/Low"] == pytest.approx((-5.0, 0.0, 7.0))
    assert at["/Hall/A[2]/Tall/Post"] == pytest.approx((0.0, 5.0, 2.0))
    assert len(at) == 6


def test_hidden_instances_stay_hidden_and_can_be_left_out_by_prototype_or_number(write_usd):
    path = write_usd(INSTANCER.replace("EXTRA", "int64[] invisibleIds = [1]"))
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
def test_an_instancer_that_does_not_fit_together_is_named(write_usd, before, after, said):
    with pytest.raises(WorldError, match=f"/Racks.*{said}"):
        load_usd(write_usd(INSTANCER.replace("EXTRA", "").replace(before, after)))


ASSET = """
def Xform "Asset" (variants = {{ string size = "small" }} prepend variantSets = "size") {{
    variantSet "size" = {{
        "small" {{ def Cube "Body" {{ double size = 1; }} }}
        "large" {{ def Cube "Body" {{ double size = 4; }} }}
    }}
    def Mesh "Tip" {{ {tetra} }}
}}
"""


def test_references_payloads_variants_and_native_instances(write_usd):
    write_usd(ASSET.format(tetra=TETRA), "asset.usda")
    path = write_usd("""
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
def test_a_variant_that_is_not_there_says_what_is(write_usd, selection, said):
    write_usd(ASSET.format(tetra=TETRA), "asset.usda")
    path = write_usd('def "A" (prepend references = @asset.usda@</Asset>) {}')
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


def test_what_cannot_be_had_is_named_and_skipped_or_refused(write_usd, capfd):
    write_usd("def Xform {", "broken.usda")
    write_usd('def Cube "Fine" {}', "fine.usda")
    path = write_usd(MISSING)
    with pytest.warns(WorldWarning) as caught:
        assert only(load_usd(path)).name == "/World/Here"
    said = " ".join(str(warning.message) for warning in caught)
    assert all(word in said for word in ("/World/Gone", "gone.usd", "/World/Broken", "broken.usda", "/World/Nobody"))
    with pytest.raises(WorldError, match="/World/Gone"):
        load_usd(path, missing="error")
    assert capfd.readouterr().err == ""


def test_what_is_missing_under_what_is_left_out_is_no_matter(write_usd):
    world = load_usd(write_usd(MISSING), exclude=["/World/Gone", "/World/Broken", "/World/Nobody"], missing="error")
    assert only(world).name == "/World/Here"


def test_a_missing_sublayer_is_reported(write_usd):
    head = '#usda 1.0\n(\n metersPerUnit = 1\n upAxis = "Z"\n subLayers = [@below.usda@]\n)\n'
    with pytest.warns(WorldWarning, match=r"below\.usda"):
        load_usd(write_usd('def Cube "Cube" {}', head=head))


def test_a_package_with_all_it_refers_to_loads(write_usd, tmp_path):
    write_usd(ASSET.format(tetra=TETRA), "asset.usda")
    path = write_usd('def "A" (prepend references = @asset.usda@</Asset>) {}')
    assert UsdUtils.CreateNewUsdzPackage(str(path), str(tmp_path / "scene.usdz"))
    (tmp_path / "asset.usda").unlink()
    assert {solid.name for solid in World.load(tmp_path / "scene.usdz").solids} == {"/A/Body", "/A/Tip"}
