from __future__ import annotations

import json
import re
import struct
import sys

import numpy as np
import pytest
import trimesh

from trundle.errors import InputError, MissingExtraError, WorldError
from trundle.geometry.solids import Mesh
from trundle.worlds import World


def scene() -> trimesh.Scene:
    """A red crate of 1 x 2 x 3 m at (1, 2, 3) and a ball, twice, once mirrored and half as large."""
    crate = trimesh.creation.box((1, 2, 3))
    red = trimesh.visual.material.PBRMaterial(baseColorFactor=[255, 0, 0, 255])
    crate.visual = trimesh.visual.TextureVisuals(material=red)
    made = trimesh.Scene()
    made.add_geometry(crate, node_name="crate", geom_name="box", transform=move(1, 2, 3))
    made.add_geometry(trimesh.creation.icosphere(2), node_name="ball", geom_name="sphere")
    made.graph.update("mirrored", matrix=move(0, 0, 9) @ np.diag([0.5, 0.5, -0.5, 1.0]), geometry="sphere")
    return made


def move(x, y, z):
    return trimesh.transformations.translation_matrix([x, y, z])


def volume(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0)


def by_name(world: World) -> dict[str, object]:
    return {solid.name: solid for solid in world.solids}


def test_a_glb_scene_is_flattened_with_names_and_colours_and_z_up(tmp_path):
    scene().export(tmp_path / "hall.glb")
    world = World.load(tmp_path / "hall.glb")
    solids = by_name(world)
    assert set(solids) == {"crate", "ball", "mirrored"}
    # glTF is y up: its y is our z, its z is our -y.
    low, high = solids["crate"].bounds()
    np.testing.assert_allclose((low, high), ((0.5, -4.5, 1.0), (1.5, -1.5, 3.0)), atol=1e-6)
    assert solids["crate"].color == (1.0, 0.0, 0.0, 1.0)
    np.testing.assert_allclose(np.mean(solids["mirrored"].bounds(), axis=0), (0, -9, 0), atol=1e-6)
    assert all(volume(solid.shape) > 0.0 for solid in world.solids)
    assert volume(solids["mirrored"].shape) == pytest.approx(volume(solids["ball"].shape) / 8.0, rel=1e-4)


@pytest.mark.parametrize("suffix", ["stl", "ply", "obj", "glb", "dae"])
def test_every_format_gives_the_same_box(tmp_path, suffix):
    box = trimesh.creation.box((1, 2, 3))
    box.visual = trimesh.visual.TextureVisuals(material=trimesh.visual.material.SimpleMaterial())
    box.export(tmp_path / f"box.{suffix}")
    (solid,) = World.load(tmp_path / f"box.{suffix}", up="z", unit="cm").solids
    np.testing.assert_allclose(np.ptp(solid.shape.vertices, axis=0), (0.01, 0.02, 0.03), rtol=1e-6)
    assert solid.shape.vertices.shape == (8, 3)
    assert volume(solid.shape) == pytest.approx(6e-6, rel=1e-5)


@pytest.mark.parametrize(("unit", "metres"), [("mm", 0.001), ("in", 0.0254), (2.5, 2.5), ("2.5", 2.5)])
def test_units(tmp_path, unit, metres):
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "b.stl")
    world = World.load(tmp_path / "b.stl", unit=unit)
    np.testing.assert_allclose(world.bounds[1], np.full(3, metres / 2.0))


def test_up_axis(tmp_path):
    trimesh.creation.box((1, 2, 3)).export(tmp_path / "b.stl")
    np.testing.assert_allclose(World.load(tmp_path / "b.stl", up="y").bounds[1] * 2, (1, 3, 2))


def test_the_objects_of_an_obj_are_solids(tmp_path):
    square = "v {0} 0 0\nv {1} 0 0\nv {1} 1 1\n"
    (tmp_path / "two.obj").write_text(
        "o left\n" + square.format(0, 1) + "f 1 2 3\no right\n" + square.format(5, 6) + "f 4 5 6\n"
    )
    world = World.load(tmp_path / "two.obj")
    assert [solid.bounds()[0][0] for solid in world.solids] == [0.0, 5.0]
    assert {"left", "right"} == {solid.name for solid in world.solids}


def test_collada_says_its_axis_and_unit(tmp_path):
    box = trimesh.creation.box((1, 2, 3))
    box.visual = trimesh.visual.TextureVisuals(material=trimesh.visual.material.SimpleMaterial())
    box.export(tmp_path / "b.dae")
    text = (tmp_path / "b.dae").read_text()
    assert "Y_UP" in text
    np.testing.assert_allclose(World.load(tmp_path / "b.dae").bounds[1] * 2, (1, 3, 2), rtol=1e-6)
    inches = (
        re.sub("<unit[^>]*/>", "", text).replace("Y_UP", "Z_UP").replace("<up_axis>", '<unit meter="0.0254"/><up_axis>')
    )
    assert inches.count("0.0254") == 1
    (tmp_path / "b.dae").write_text(inches)
    np.testing.assert_allclose(World.load(tmp_path / "b.dae").bounds[1] * 2, np.array((1, 2, 3)) * 0.0254, rtol=1e-6)


def gltf(**changes: object) -> bytes:
    """A GLB of one triangle at x = 5 in the second of two scenes, which is the one to show."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4").tobytes()
    data = corners + np.array([0, 1, changes.pop("index", 2)], dtype="<u4").tobytes()
    text = {
        "asset": {"version": "2.0"},
        "scene": 1,
        "scenes": [{"nodes": [0]}, {"nodes": [1]}],
        "nodes": [{"name": "left", "mesh": 0}, {"name": "right", "mesh": 0, "translation": [5, 0, 0]}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": len(data)}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 12}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5125, "count": 3, "type": "SCALAR"},
        ],
    }
    head = json.dumps(text | changes).encode()
    head += b" " * (-len(head) % 4)
    chunks = struct.pack("<I4s", len(head), b"JSON") + head + struct.pack("<I4s", len(data), b"BIN\0") + data
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def test_the_scene_that_a_glb_shows_is_taken(tmp_path):
    (tmp_path / "two.glb").write_bytes(gltf())
    np.testing.assert_allclose(World.load(tmp_path / "two.glb").bounds, ((5, 0, 0), (6, 0, 1)), atol=1e-6)


PLY = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face {}\n"
BAD = {
    "nan.obj": ("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertices that are not finite numbers"),
    "inf.obj": ("v inf 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertices that are not finite numbers"),
    "points.obj": ("v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no mesh with faces"),
    "empty.obj": ("", "no mesh with faces"),
    "words.stl": ("solid nothing\nendsolid", ".stl"),
    "line.obj": ("v 0 0 0\nv 1 0 0\nv 0 0 0\nf 1 2 3\n", "only faces without area"),
    "dot.obj": ("v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "no extent"),
    "garbage.glb": (b"glTF\x02\x00\x00\x00garbage", "cannot be read as a .glb file"),
    "garbage.ply": (b"\x00\x01\x02", ".ply"),
    "garbage.stl": (bytes(range(256)) * 2, ".stl"),
    "bomb.dae": ("<!DOCTYPE x [<!ENTITY a 'b'>]><COLLADA>&a;</COLLADA>", "a <!DOCTYPE …> is not accepted"),
    "circle.glb": (
        gltf(nodes=[{"mesh": 0, "children": [1]}, {"mesh": 0, "children": [0]}]),
        "its node graph has a cycle",
    ),
    "far.glb": (gltf(index=9), "has faces with vertex indices outside 0..2"),
    "packed.glb": (
        gltf(extensionsUsed=["KHR_draco_mesh_compression"]),
        "it uses KHR_draco_mesh_compression, which is not supported",
    ),
    "many.glb": (gltf(extensionsUsed=["EXT_mesh_gpu_instancing"]), "it uses EXT_mesh_gpu_instancing"),
    "flat.obj": ("v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n", "flat.obj"),
    # Whether its text is refused or has no face depends on the version of NumPy.
    "noise.obj": (bytes(range(256)) * 9, "noise.obj: c"),
    "cloud.ply": (PLY.format(0).encode() + b"end_header\n0 0 0\n1 0 0\n0 1 0\n", "no mesh with faces"),
    "bare.dae": ("<COLLADA/>", "cannot be read as a .dae file"),
}


@pytest.mark.parametrize("name", BAD)
def test_bad_meshes_are_refused(tmp_path, name):
    content, message = BAD[name]
    (tmp_path / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(WorldError) as caught:
        World.load(tmp_path / name)
    assert message in str(caught.value)
    assert name in str(caught.value)


@pytest.mark.parametrize("suffix", ["glb", "stl", "ply"])
def test_truncated_files_are_refused(tmp_path, suffix):
    trimesh.creation.icosphere(2).export(tmp_path / f"ball.{suffix}")
    content = (tmp_path / f"ball.{suffix}").read_bytes()
    (tmp_path / f"ball.{suffix}").write_bytes(content[: len(content) // 2])
    with pytest.raises(WorldError, match="ball"):
        World.load(tmp_path / f"ball.{suffix}")


def test_a_node_of_scale_0_is_refused_by_name(tmp_path):
    made = trimesh.Scene()
    made.add_geometry(trimesh.creation.box(), node_name="flat", transform=np.diag([1.0, 0.0, 1.0, 1.0]))
    made.add_geometry(trimesh.creation.box(), node_name="fine")
    made.export(tmp_path / "s.glb")
    with pytest.raises(WorldError, match=r"s\.glb: mesh 'flat' has a scale of 0"):
        World.load(tmp_path / "s.glb")


@pytest.mark.parametrize("options", [{"unit": "parsec"}, {"unit": 0}, {"unit": -1.0}, {"unit": "nan"}, {"up": "x"}])
def test_bad_options_are_refused(tmp_path, options):
    trimesh.creation.box().export(tmp_path / "b.stl")
    with pytest.raises(InputError, match="must be"):
        World.load(tmp_path / "b.stl", **options)


def test_a_missing_trimesh_is_said_with_what_to_install(tmp_path, monkeypatch):
    (tmp_path / "b.stl").write_text("solid x")
    monkeypatch.setitem(sys.modules, "trimesh", None)
    with pytest.raises(MissingExtraError, match=r'pip install ".*\[mesh\]"'):
        World.load(tmp_path / "b.stl")
