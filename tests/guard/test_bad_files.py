"""Files that crash the libraries that read them, keep them busy or take all memory: one typed error each."""

from __future__ import annotations

import json
import os
import struct
import sys

import pytest

from trundle.errors import InputError, MapError, RobotError, ScenarioError, WorldError
from trundle.files.opening import read_up_to
from trundle.maps import OccupancyGrid
from trundle.mission import Scenario
from trundle.robots import Robot
from trundle.sim.mujoco.joints import list_joints
from trundle.worlds import World

linux = pytest.mark.skipif(sys.platform != "linux", reason="only Linux limits memory")

YAML = "image: m.pgm\nresolution: {}\norigin: {}\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
BALL = "<geom size='.1'/>"


@pytest.fixture
def fifo(tmp_path):
    os.mkfifo(tmp_path / "fifo")
    return "fifo"


def write(folder, name: str, content: str | bytes):
    (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return folder / name


@pytest.fixture
def no_child(monkeypatch):
    """Fail where a process is started."""

    def refuse(*_args, **_kwargs):
        raise AssertionError("a process was started")

    monkeypatch.setattr("subprocess.Popen", refuse)


def test_our_own_worlds_robots_and_maps_need_no_child(tmp_path, no_child):
    World.generate("maze", seed=1)
    Robot.load("nova_carter")
    list_joints("nova_carter")
    write(tmp_path, "m.pgm", b"P5 3 3 255\n" + bytes([0] * 3 + [254] * 6))
    World.load(write(tmp_path, "m.yaml", YAML.format(0.05, [0, 0, 0])))


# In the child ---------------------------------------------------------------------------------------------------------


def doubling(depth: int) -> str:
    lines = ['#usda 1.0\n(metersPerUnit = 1\nupAxis = "Z")\n']
    for i in range(depth):
        twice = "".join(f'  def "{name}" (references = </P{i + 1}>) {{}}\n' for name in "ab")
        lines.append(f'def Xform "P{i}" {{\n{twice}}}\n')
    return "".join(lines) + f'def Cube "P{depth}" {{}}\n'


def test_references_that_double_end_at_the_time_limit(tmp_path):
    file = write(tmp_path, "w.usda", doubling(24))
    with pytest.raises(WorldError, match=r"w\.usda: reading it took longer than 2 s"):
        World.load(file, time_limit_s=2)


@pytest.mark.parametrize("arc", ['def Xform "A" (references = @{}@) {{}}', "(subLayers = [@{}@])"])
def test_a_pipe_that_usd_would_open_ends_at_the_time_limit(tmp_path, arc):
    os.mkfifo(tmp_path / "pipe.usda")
    file = write(tmp_path, "w.usda", "#usda 1.0\n" + arc.format("./pipe.usda") + "\n")
    with pytest.raises(WorldError, match=r"w\.usda: reading it took longer than 1 s"):
        World.load(file, time_limit_s=1)


@pytest.mark.parametrize(("load", "error"), [(World.load, WorldError), (list_joints, RobotError)])
def test_prims_nested_deeply_are_a_crash_of_the_child_alone(tmp_path, load, error):
    file = write(tmp_path, "w.usda", "#usda 1.0\n" + 'def "a" {' * 60_000 + "}" * 60_000)
    with pytest.raises(error, match=r"w\.usda: the reader crashed on it"):
        load(file)


@linux
def test_a_height_field_that_is_too_large_ends_at_the_memory_limit(tmp_path):
    text = (
        "<mujoco><asset><hfield name='h' nrow='4000' ncol='4000' size='1 1 1 1'/></asset>"
        "<worldbody><geom type='hfield' hfield='h'/></worldbody></mujoco>"
    )
    with pytest.raises(WorldError, match=r"w\.xml: .*more than 0\.3 GB of memory"):
        World.load(write(tmp_path, "w.xml", text), memory_limit_gb=0.3)


@linux
@pytest.mark.parametrize(("load", "error"), [(World.load, WorldError), (Robot.load, RobotError)])
def test_a_height_field_for_which_mujoco_raises_an_exception_of_no_type(tmp_path, load, error):
    text = (
        "<mujoco><asset><hfield name='h' nrow='100000000' ncol='5' size='1 1 1 1'/></asset>"
        "<worldbody><geom type='hfield' hfield='h'/></worldbody></mujoco>"
    )
    with pytest.raises(error, match=r"w\.xml:1: a height field has up to"):
        load(write(tmp_path, "w.xml", text), memory_limit_gb=0.5)


def test_a_scenario_cannot_say_that_a_file_is_trusted(tmp_path):
    text = "world: {name: hall.usda, options: {trusted: true}}\nrobot: nova_carter\n"
    with pytest.raises(ScenarioError, match=r"trusted is no option of a scenario.*TRUNDLE_TRUSTED"):
        Scenario.load(write(tmp_path, "s.yaml", text))


# Read here before a library sees them: they are recognized at once ----------------------------------------------------


@pytest.fixture
def read_here(monkeypatch):
    monkeypatch.setenv("TRUNDLE_TRUSTED", "1")


def attach(file: str) -> str:
    return (
        f"<mujoco><asset><model name='a' file='{file}'/></asset><worldbody><body name='b'>{BALL}</body>"
        "<frame><attach model='a' body='b' prefix='p'/></frame></worldbody></mujoco>"
    )


@pytest.mark.usefixtures("read_here")
@pytest.mark.parametrize(("load", "error"), [(World.load, WorldError), (list_joints, RobotError)])
class TestModels:
    def test_a_model_that_contains_itself(self, tmp_path, load, error):
        write(tmp_path, "other.xml", attach("self.xml"))
        with pytest.raises(error, match=r"self\.xml:1: self\.xml includes itself"):
            load(write(tmp_path, "self.xml", attach("self.xml")))
        write(tmp_path, "other.xml", attach("round.xml"))
        with pytest.raises(error, match=r"other\.xml:1: round\.xml includes itself"):
            load(write(tmp_path, "round.xml", attach("other.xml")))

    @pytest.mark.parametrize(
        "size", ["nrow='100000' ncol='100000'", "nrow='-4' ncol='5'", "nrow='2147483647' ncol='2'"]
    )
    def test_a_height_field_that_is_too_large(self, tmp_path, load, error, size):
        field = f"<asset>\n<hfield name='h' {size} size='1 1 1 1'/></asset>"
        text = f"<mujoco>{field}<worldbody><geom type='hfield' hfield='h'/></worldbody></mujoco>"
        with pytest.raises(error, match=r"w\.xml:2: a height field has up to 20000000 heights, got nrow"):
            load(write(tmp_path, "w.xml", text))

    @pytest.mark.parametrize("made", ["count='100000000'", "count='1000'><replicate count='2000'"])
    def test_a_hundred_million_copies(self, tmp_path, load, error, made):
        end = "</replicate>" * made.count("count")
        text = f"<mujoco>\n<worldbody><replicate {made}>{BALL}{end}</worldbody></mujoco>"
        with pytest.raises(error, match=r"w\.xml:2: this generates more than 1000000 elements"):
            load(write(tmp_path, "w.xml", text))

    def test_a_pipe_is_not_opened(self, tmp_path, load, error, fifo):
        text = f"<mujoco><worldbody>{BALL}</worldbody>\n<include file='{fifo}'/></mujoco>"
        with pytest.raises(error, match=r"w\.xml:2: cannot read .*fifo: not a regular file"):
            load(write(tmp_path, "w.xml", text))

    def test_a_pipe_in_the_folder_of_meshes_is_not_opened(self, tmp_path, load, error):
        (tmp_path / "meshes").mkdir()
        os.mkfifo(tmp_path / "meshes" / "a.stl")
        text = (
            "<mujoco><compiler meshdir='meshes'/><asset><mesh name='a' file='a.stl'/></asset>"
            "<worldbody><geom type='mesh' mesh='a'/></worldbody></mujoco>"
        )
        with pytest.raises(error, match="not a regular file"):
            load(write(tmp_path, "w.xml", text))

    def test_too_many_files(self, tmp_path, load, error):
        for index in range(40):
            write(tmp_path, f"{index}.xml", f"<mujocoinclude><include file='{index + 1}.xml'/></mujocoinclude>")
        write(tmp_path, "40.xml", "<mujocoinclude/>")
        with pytest.raises(error, match="nests them more than"):
            load(write(tmp_path, "w.xml", f"<mujoco><worldbody>{BALL}</worldbody><include file='0.xml'/></mujoco>"))


@pytest.mark.usefixtures("read_here")
def test_included_models_are_counted(tmp_path):
    for level in range(12):
        inside = "".join(f"<include><uri>{level + 1}.sdf</uri><name>m{k}</name></include>" for k in range(10))
        inside = inside if level < 11 else "<link name='l'/>"
        write(tmp_path, f"{level}.sdf", f"<sdf version='1.9'><model name='m'><static>1</static>{inside}</model></sdf>")
    with pytest.raises(WorldError, match="more than 10000 models are included"):
        World.load(tmp_path / "0.sdf")


TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n"


@pytest.mark.usefixtures("read_here")
@pytest.mark.parametrize("name", ["w.obj", "w.gltf"])
def test_pipes_that_meshes_name_are_not_opened(tmp_path, fifo, name):
    gltf = {
        "asset": {"version": "2.0"},
        "buffers": [{"uri": fifo, "byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
    }
    text = f"mtllib {fifo}\n{TRIANGLE}" if name.endswith("obj") else json.dumps(gltf)
    with pytest.raises(WorldError, match="it refers to 'fifo', which cannot be read: not a regular file"):
        World.load(write(tmp_path, name, text))


@pytest.mark.usefixtures("read_here")
def test_a_mesh_finds_the_materials_beside_it(tmp_path):
    write(tmp_path, "a.mtl", "newmtl a\nKd 1 0 0\n")
    (solid,) = World.load(write(tmp_path, "w.obj", f"mtllib a.mtl\n{TRIANGLE}")).solids
    assert solid.color == (1.0, 0.0, 0.0, 1.0)


@pytest.mark.usefixtures("read_here")
def test_json_nested_deeply_is_refused(tmp_path):
    text = '{"asset":' + "[" * 200_000 + "]" * 200_000 + "}"
    with pytest.raises(WorldError, match="nested too deeply"):
        World.load(write(tmp_path, "w.gltf", text))


@pytest.mark.usefixtures("read_here")
@pytest.mark.parametrize("sizes", [(0xFFFFFFF0, 0xFFFFFF00), (60, 0xFFFFFF00), (0xFFFFFFF0, 2)])
def test_a_header_of_glb_is_held_against_the_file(tmp_path, sizes):
    content = b"glTF" + struct.pack("<III", 2, *sizes) + b"JSON" + b"{}" + bytes(40)
    with pytest.raises(WorldError, match=r"more bytes than the file has \(62\)"):
        World.load(write(tmp_path, "w.glb", content))


def test_memory_for_an_image_is_that_of_its_file(tmp_path, monkeypatch):
    """The header says 800 MB, and the file has a byte."""
    write(tmp_path, "m.pgm", b"P5 20000 20000 65535\n" + b"x" * 70_000)
    asked = []

    def read(stream, most: int) -> bytes:
        content = read_up_to(stream, most)
        asked.append((most, len(content)))
        return content

    monkeypatch.setattr("trundle.maps.images.image.read_up_to", read)
    with pytest.raises(MapError, match="truncated"):
        OccupancyGrid.load(write(tmp_path, "m.yaml", YAML.format(0.05, [0, 0, 0])), max_cells=400_000_000)
    assert asked == [(20_000 * 20_000 * 2 + 21 - 65536, 70_021 - 65536)]


@pytest.mark.parametrize("kind", ["yaml", "map", "pgm"])
def test_maps_are_regular_files(tmp_path, kind):
    name = "m.map" if kind == "map" else "m.yaml"
    if kind == "pgm":
        write(tmp_path, name, YAML.format(0.05, [0, 0, 0]))
        os.mkfifo(tmp_path / "m.pgm")
    else:
        os.mkfifo(tmp_path / name)
    with pytest.raises(InputError, match=r"not a regular file|does not exist"):
        OccupancyGrid.load(tmp_path / name)


@pytest.mark.parametrize("text", ["1e6", "1001", "1000"])
def test_a_map_is_at_most_100_km_wide(tmp_path, text):
    """Paths are checked every few centimetres."""
    write(tmp_path, "m.pgm", b"P5 101 1 255\n" + bytes([254] * 101))
    with pytest.raises(MapError, match=r"m\.yaml.*(km wide|between 1e-06 and 1000)"):
        OccupancyGrid.load(write(tmp_path, "m.yaml", YAML.format(text, [0, 0, 0])))


@pytest.mark.parametrize(("origin", "what"), [([1e300, 0, 0], "x"), ([0, -2e9, 0], "y"), ([0, 0, 1e300], "yaw")])
def test_origins_too_far_away_to_resolve_a_cell_are_refused(tmp_path, origin, what):
    write(tmp_path, "m.pgm", b"P5 3 3 255\n" + bytes([254] * 9))
    with pytest.raises(MapError, match=rf"m\.yaml:3:\d+: origin's {what} is .* must be between"):
        OccupancyGrid.load(write(tmp_path, "m.yaml", YAML.format(0.05, origin)))
