"""USD files with errors: values that do not fit, damaged files, invalid options."""

import sys

import numpy as np
import pytest
from pxr import Usd, UsdGeom, Vt

from support.usd_scenes import HEAD, TETRA, only
from trundle.errors import InputError, MissingExtraError, WorldError, WorldWarning
from trundle.worlds.usd import load_usd


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
def test_a_mesh_whose_numbers_do_not_fit_is_refused_by_name(write_usd, prim, said):
    with pytest.raises(WorldError, match=f"scene.usda: /World/Bad: .*{said}"):
        load_usd(write_usd(f'def Xform "World" {{ def Mesh "Bad" {{ {prim} }} }}'))


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
def test_what_there_is_nothing_of_is_left_out_with_a_warning(write_usd, prim, said):
    path = write_usd(f'{prim}\ndef Cube "Good" {{ double size = 1; }}')
    with pytest.warns(WorldWarning, match=said) as caught:
        assert only(load_usd(path)).name == "/Good"
    assert "/Bad" in str(caught[0].message)


@pytest.mark.parametrize("value", ["-1", "nan", "inf"])
def test_an_impossible_size_is_refused_by_name(write_usd, value):
    with pytest.raises(WorldError, match="/Bad: size"):
        load_usd(write_usd(f'def Cube "Bad" {{ double size = {value}; }}'))


def test_a_transform_that_is_not_finite_is_refused_by_name(write_usd):
    with pytest.raises(WorldError, match="/Bad: its transform"):
        load_usd(
            write_usd(
                'def Xform "Bad" { double3 xformOp:translate = (nan, 0, 0);'
                ' uniform token[] xformOpOrder = ["xformOp:translate"]; }'
            )
        )


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
def test_values_of_a_type_that_there_is_not_are_refused_by_name(write_usd, prim, said):
    with pytest.raises(WorldError, match=said):
        load_usd(write_usd(prim))


def test_a_syntax_error_has_its_line(write_usd):
    with pytest.raises(WorldError, match=r"scene\.usda:7:"):
        load_usd(write_usd('def Cube "A" {\n  what is this\n}'))


def test_a_missing_file_says_so(tmp_path):
    with pytest.raises(WorldError, match="no such file"):
        load_usd(tmp_path / "none.usd")


@pytest.mark.parametrize(
    "options",
    [{"geometry": "pretty"}, {"missing": "ignore"}, {"purposes": ["all"]}, {"up_axis": "X"}],
)
def test_an_option_that_there_is_not_lists_those_that_there_are(write_usd, options):
    with pytest.raises(InputError, match="one of"):
        load_usd(write_usd('def Cube "A" {}'), **options)


def test_without_usd_core_the_install_line_is_given(write_usd, monkeypatch):
    monkeypatch.setitem(sys.modules, "pxr.Usd", None)
    with pytest.raises(MissingExtraError, match=r'pip install ".*\[usd\]"'):
        load_usd(write_usd('def Cube "A" {}'))
