"""Small worlds built as public Gazebo worlds are: they load as they are."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from trundle.errors import MissingExtraError, WorldError, WorldWarning
from trundle.files.uris import SEARCH_VARIABLES
from trundle.worlds import World

BOX = "<geometry><box><size>1 2 3</size></box></geometry>"
TETRAHEDRON = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="f" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array><technique_common>
<accessor source="#f" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 1 2 3 0 3 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


@pytest.fixture(autouse=True)
def _no_models_of_this_machine(tmp_path, monkeypatch):
    for name in (*SEARCH_VARIABLES, "GZ_FUEL_CACHE_PATH", "IGN_FUEL_CACHE_PATH"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))


def write(file: Path, text: str) -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text)
    return file


def world_file(file: Path, body: str, version: str = "1.6") -> Path:
    return write(file, f"<?xml version='1.0'?><sdf version='{version}'><world name='hall'>{body}</world></sdf>")


def model_folder(folder: Path, name: str, geometry: str = BOX) -> Path:
    """A model as Gazebo's editor saves it."""
    shapes = f"<collision name='c'>{geometry}</collision><visual name='v'>{geometry}</visual>"
    text = f"<model name='{name}'><static>1</static><link name='l'>{shapes}</link></model>"
    write(folder / name / "model.sdf", f"<sdf version='1.6'>{text}</sdf>")
    config = f"<model><name>{name}</name><sdf version='1.6'>model.sdf</sdf></model>"
    return write(folder / name / "model.config", config).parent


def names(world: World) -> list[str]:
    return sorted(solid.name for solid in world.solids)


def include(uri: str, name: str = "", pose: str = "0 0 0 0 0 0") -> str:
    named = f"<name>{name}</name>" if name else ""
    return f"<include>{named}<uri>{uri}</uri><pose frame=''>{pose}</pose></include>"


def test_a_robomaker_style_world(tmp_path):
    """Models beside the worlds, wrapped in models that hold the pose, with COLLADA meshes named from the repository."""
    mesh = (
        "<geometry><mesh><uri>file://models/shop_shelf_01/meshes/shelf.DAE</uri><scale>1 1 1</scale></mesh></geometry>"
    )
    folder = model_folder(tmp_path / "models", "shop_shelf_01", mesh)
    write(folder / "meshes" / "shelf.DAE", DAE)
    body = "".join(
        f"<model name='Shelf_{n}'><include><uri>model://shop_shelf_01</uri></include>"
        f"<pose frame=''>{n} 0 0 0 -0 0</pose></model>"
        for n in (1, 4)
    )
    extras = (
        "<gui><camera name='c'><pose>1 2 3 0 0 0</pose></camera></gui><gravity>0 0 -9.8</gravity><scene/>"
        "<physics type='ode'/><light name='s' type='directional'/><plugin name='p' filename='p.so'><x>${y}</x></plugin>"
    )
    world = World.load(world_file(tmp_path / "worlds" / "small" / "small.world", extras + body))
    assert names(world) == ["Shelf_1::shop_shelf_01", "Shelf_4::shop_shelf_01"]
    assert [solid.bounds()[0][0] for solid in world.solids] == pytest.approx([1.0, 4.0])


def test_a_turtlebot_style_world(tmp_path):
    """Floor and light are Gazebo's own; the model lies in the package's folder of models."""
    package = tmp_path / "arena_gazebo"
    model_folder(package / "models", "arena")
    body = include("model://ground_plane") + include("model://sun") + include("model://arena")
    world = World.load(world_file(package / "worlds" / "arena.world", body, "1.4"))
    assert names(world) == ["arena"]


@pytest.mark.parametrize(
    "uri",
    [
        "model://ground_plane",
        "model://Ground Plane",
        "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground Plane",
        "https://fuel.gazebosim.org/1.0/OpenRobotics/models/Ground%20Plane/2",
        "https://fuel.ignitionrobotics.org/1.0/openrobotics/models/ground plane",
    ],
)
def test_gazebos_own_floor_and_light_need_no_files(tmp_path, uri):
    sun = uri.replace("ground_plane", "sun").replace("Ground Plane", "Sun").replace("Ground%20Plane", "Sun")
    sun = sun.replace("ground plane", "sun")
    body = include(uri) + include(sun) + f"<model name='m'><static>1</static><link name='l'><collision name='c'>{BOX}"
    world = World.load(world_file(tmp_path / "w.sdf", body + "</collision></link></model>", "1.9"))
    assert names(world) == ["m"]


@pytest.mark.parametrize("height", [0.5, -0.5])
def test_a_ground_plane_lies_where_its_pose_says(tmp_path, height):
    body = include("model://ground_plane", pose=f"1 0 {height} 0 0 0")
    body += f"<model name='m'><static>1</static><pose>0 0 {height} 0 0 0</pose><link name='l'><collision name='c'>{BOX}"
    world = World.load(world_file(tmp_path / "w.sdf", body + "</collision></link></model>"))
    assert names(world) == ["m"]
    assert world.ground_z == height


def test_models_of_other_names_are_no_floor(tmp_path):
    for uri in ("model://my_ground_plane", "model://a/ground_plane", "sun", "https://x.org/sun"):
        with pytest.raises(WorldError, match="was not found"):
            World.load(world_file(tmp_path / "w.sdf", include(uri)))


def test_a_downloaded_world_finds_its_downloaded_models(tmp_path):
    cache = tmp_path / "home" / ".gz" / "fuel" / "fuel.gazebosim.org" / "someone" / "models"
    mesh = "<geometry><mesh><uri>model://Big Shelf/meshes/t.obj</uri></mesh></geometry>"
    write(model_folder(cache / "big shelf", "3", mesh) / "meshes" / "t.obj", TETRAHEDRON)
    uri = "https://fuel.gazebosim.org/1.0/Someone/models/Big Shelf"
    world = World.load(world_file(tmp_path / "w.sdf", include(uri, "shelf_a", "2 0 0 0 0 0"), "1.9"))
    assert names(world) == ["shelf_a"]


def test_a_world_with_conditions_on_its_plugins_is_read(tmp_path):
    plugins = (
        "<xacro:unless value='$(arg headless)'><plugin name='p' filename='f'/></xacro:unless>"
        "<plugin name='q' filename='f'><a>$(arg b)</a></plugin>"
    )
    folder = model_folder(tmp_path / "models", "arena").parent.parent
    body = plugins + "<model name='arena'><static>1</static><include><uri>model://arena</uri></include></model>"
    text = (
        "<sdf version='1.6' xmlns:xacro='http://www.ros.org/wiki/xacro'><xacro:arg name='headless' default='true'/>"
        f"<world name='default'>{body}</world></sdf>"
    )
    file = write(folder / "worlds" / "arena.sdf.xacro", text)
    assert names(World.load(file)) == ["arena::arena"]
    for macro in ("<xacro:if value='1'><include><uri>model://arena</uri></include></xacro:if>", "<xacro:wall x='1'/>"):
        file.write_text(text.replace("</world>", f"{macro}</world>"))
        with pytest.raises(WorldError, match=r"expand the file first: xacro arena\.sdf\.xacro > world\.sdf"):
            World.load(file)
    file.write_text(text.replace("</world>", "<model name='m'><pose>${x} 0 0 0 0 0</pose></model></world>"))
    with pytest.raises(WorldError, match="<pose> contains a xacro expression"):
        World.load(file)


def test_of_the_versions_of_a_model_the_newest_that_is_read_is_taken(tmp_path):
    folder = model_folder(tmp_path / "models", "shelf")
    for name, size, version in (("old", 1, "1.4"), ("new", 2, "1.10"), ("future", 3, "1.99")):
        geometry = f"<geometry><sphere><radius>{size}</radius></sphere></geometry>"
        link = f"<link name='l'><collision name='c'>{geometry}</collision></link>"
        text = f"<sdf version='{version}'><model name='s'><static>1</static>{link}</model></sdf>"
        write(folder / f"{name}.sdf", text)
    versions = [("1.10", "new"), ("1.99", "future"), ("1.4", "old"), ("1.11", "gone")]
    text = "".join(f"<sdf version='{version}'>{name}.sdf</sdf>" for version, name in versions)
    write(folder / "model.config", f"<model>{text}</model>")
    (solid,) = World.load(world_file(tmp_path / "w.world", include("model://shelf"))).solids
    assert solid.shape.radius == 2.0


def test_lights_and_actors_that_are_included_are_no_obstacles(tmp_path):
    write(tmp_path / "models" / "lamp" / "model.sdf", "<sdf version='1.5'><light type='point' name='x'/></sdf>")
    body = include("model://lamp") + "<actor name='walker'><skin/></actor>"
    body += f"<model name='m'><static>1</static><link name='l'><collision name='c'>{BOX}</collision></link></model>"
    with pytest.warns(WorldWarning, match="left out: the actor 'walker'"):
        assert names(World.load(world_file(tmp_path / "w.world", body))) == ["m"]


def test_what_is_not_found_names_the_places_and_the_option(tmp_path, monkeypatch):
    monkeypatch.setenv("GAZEBO_MODEL_PATH", str(tmp_path / "mine"))
    file = world_file(tmp_path / "w.world", include("model://cafe"))
    with pytest.raises(WorldError) as caught:
        World.load(file, paths=[tmp_path / "given"])
    for words in ("'model://cafe' was not found", "--paths", str(tmp_path / "given"), "--set missing=skip"):
        assert words in str(caught.value)
    assert f"GAZEBO_MODEL_PATH={tmp_path / 'mine'}" in str(caught.value)
    assert "GZ_SIM_RESOURCE_PATH" in str(caught.value)


def test_collada_without_its_reader_gives_the_install_line(tmp_path, monkeypatch):
    write(tmp_path / "x.dae", DAE)
    monkeypatch.setitem(sys.modules, "collada", None)
    with pytest.raises(MissingExtraError, match=r'pycollada, which is not installed\..*pip install ".*\[mesh\]"'):
        World.load(tmp_path / "x.dae")
