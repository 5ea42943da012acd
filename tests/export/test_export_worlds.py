import mujoco
import numpy as np
import pytest

from trundle.errors import InputError, MapWarning, OutputError, UnknownNameError, WorldError
from trundle.export import FORMATS, export_robot, export_world
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Cylinder, Mesh, OccupancyCells, Solid, Sphere
from trundle.maps import OccupancyGrid
from trundle.robots import Robot
from trundle.worlds import World

# An L: not convex, so that a convex hull would be seen.
CORNERS = np.array([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], dtype=float) - 0.7
TURNED = Pose3D((3.1, -2.2, 0.9), (0.8, 0.2, -0.3, 0.47))


def l_shape() -> Mesh:
    vertices = np.vstack([np.c_[CORNERS, np.zeros(6)], np.c_[CORNERS, np.full(6, 0.8)]])
    caps = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    faces = [(a, c, b) for a, b, c in caps] + [(a + 6, b + 6, c + 6) for a, b, c in caps]
    for i in range(6):
        j = (i + 1) % 6
        faces += [(i, j, j + 6), (i, j + 6, i + 6)]
    return Mesh(vertices, np.array(faces))


@pytest.fixture
def zoo() -> World:
    """One solid of every shape, turned in space, with colours, and names that need quoting."""
    return World(
        "zoo",
        (
            Solid("a box", Box((1.25, 0.4, 0.7)), TURNED, (0.1, 0.2, 0.3, 1.0), "box"),
            Solid('cylinder<&"é>', Cylinder(0.31, 1.7), Pose3D((0.0, 1.0, 0.2), (0.5, 0.5, 0.5, -0.5))),
            Solid("ball/1", Sphere(1.0 / 3.0), Pose3D((-2.0, 0.1, 0.4)), (0.9, 0.5, 0.25, 0.5)),
            Solid("mesh", l_shape(), TURNED, (0.0, 1.0, 0.5, 1.0)),
        ),
    )


def assert_same(found: World, expected: World, tolerance: float) -> None:
    assert [solid.name for solid in found.solids] == [solid.name for solid in expected.solids]
    for one, other in zip(found.solids, expected.solids, strict=True):
        assert one.color == pytest.approx(other.color, abs=2e-3), other.name
        assert type(one.shape) is type(other.shape), other.name
        if isinstance(one.shape, Mesh) and isinstance(other.shape, Mesh):
            corners = [solid.pose.transform_points(solid.shape.vertices) for solid in (one, other)]
            triangles = [points[solid.shape.faces] for points, solid in zip(corners, (one, other), strict=True)]
            rows = [np.array(sorted(part.reshape(len(part), -1).round(4).tolist())) for part in triangles]
            assert np.allclose(*rows, atol=10.0 * tolerance), other.name
            continue
        assert np.allclose(one.pose.position, other.pose.position, atol=tolerance), other.name
        assert np.allclose(one.pose.rotation(), other.pose.rotation(), atol=tolerance), other.name
        for field in ("size", "radius", "length"):
            if hasattr(other.shape, field):
                assert getattr(one.shape, field) == pytest.approx(getattr(other.shape, field), abs=tolerance)


@pytest.mark.parametrize("to", ["mjcf", "sdf", "usd"])
def test_what_is_written_loads_back_to_the_same_solids(to, zoo, tmp_path):
    path = export_world(zoo, tmp_path / f"zoo{FORMATS[to].suffixes[0]}", to=to)
    back = World.load(path)
    assert back.name == "zoo"
    assert_same(back, zoo, 1e-6)


@pytest.mark.parametrize("to", ["mjcf", "sdf", "usd"])
@pytest.mark.parametrize("name", ["office", "lot", "cylinders"])
def test_generated_worlds_load_back_from(to, name, tmp_path):
    world = World.generate(name, seed=2)
    assert_same(World.load(export_world(world, tmp_path / f"x{FORMATS[to].suffixes[0]}")), world, 1e-6)


def test_a_glb_loads_back_to_meshes_that_hold_the_same_space(zoo, tmp_path):
    back = World.load(export_world(zoo, tmp_path / "zoo.glb"))
    found = {solid.name: solid for solid in back.solids}
    assert set(found) == {solid.name for solid in zoo.solids}
    for solid in zoo.solids:
        assert np.allclose(found[solid.name].bounds(), solid.bounds(), atol=0.01), solid.name
        assert found[solid.name].color == pytest.approx(solid.color, abs=3e-3)
    bounds = ((-4.0, -4.0), (5.0, 5.0))
    free, again = (OccupancyGrid.from_world(w, bounds=bounds, seeds=[(-3.9, -3.9)]).data == 0 for w in (zoo, back))
    assert (free != again).sum() < 0.03 * (~free).sum()


def test_a_map_is_the_map_of_the_world(tmp_path):
    world = World.generate("corridors")
    export_world(world, tmp_path / "c.yaml", resolution=0.1, z_range=(0.2, 0.5))
    expected = OccupancyGrid.from_world(world, resolution=0.1, z_range=(0.2, 0.5))
    assert np.array_equal(OccupancyGrid.load(tmp_path / "c.yaml").data, expected.data)


@pytest.mark.parametrize("to", ["mjcf", "sdf", "glb"])
def test_blocked_cells_are_written_as_boxes_of_the_same_space(to, tmp_path):
    blocked = np.random.default_rng(1).random((12, 9)) < 0.4
    world = World("m", (Solid("map", OccupancyCells(blocked, 0.5, 1.0), Pose3D.planar(1.0, 2.0, 0.0, 0.6)),))
    back = World.load(export_world(world, tmp_path / f"m{FORMATS[to].suffixes[0]}"))
    assert all(solid.name.startswith("map[") for solid in back.solids)
    bounds = ((-5.0, -1.0), (7.0, 10.0))
    one, other = (OccupancyGrid.from_world(w, bounds=bounds, seeds=[(-4.9, -0.9)]) for w in (world, back))
    assert ((one.data == 0) == (other.data == 0)).mean() > 0.9995


def test_a_world_with_a_robot_is_the_model_that_is_simulated(tmp_path):
    robot = Robot.load("nova_carter")
    world = World.generate("corridors")
    path = export_world(world, tmp_path / "both.xml", robot=robot)
    model = mujoco.MjModel.from_xml_path(str(path))
    assert model.joint(robot.drive.left_joint).type[0] == mujoco.mjtJoint.mjJNT_HINGE
    assert model.body_subtreemass[0] == pytest.approx(robot.total_mass, rel=1e-6)
    names = {model.geom(index).name for index in range(model.ngeom)}
    assert {solid.name for solid in world.solids} <= names


def test_colons_that_sdf_keeps_for_itself_become_slashes(tmp_path):
    world = World("w", (Solid("a::b", Box((1, 1, 1))), Solid("a/b", Box((2, 1, 1)))))
    back = World.load(export_world(world, tmp_path / "w.sdf"))
    assert [solid.name for solid in back.solids] == ["a/b", "a/b#2"]


STRANGE = [
    "tab\tnew\nline",
    "日本語 상자",
    "a/b",
    "a.b",
    "a b",
    "a:b",
    "world:floor",
    "floor",
    "__x__",
    "7",
    "😀",
    "n" * 300,
]


@pytest.mark.parametrize("to", ["mjcf", "sdf", "usd", "glb"])
def test_strange_names_come_back(to, tmp_path):
    """But for those that a format needs itself."""
    world = World("w", tuple(Solid(name, Box((1, 1, 1)), Pose3D((2.0 * n, 0, 0.5))) for n, name in enumerate(STRANGE)))
    back = World.load(export_world(world, tmp_path / f"w{FORMATS[to].suffixes[0]}"))
    found = {solid.name for solid in back.solids}
    reserved = {"mjcf": ["world:floor"], "sdf": ["world", "__x__"]}.get(to, [])
    assert found == {f"{name}#2" if name in reserved else name for name in STRANGE}
    places = {round(solid.bounds()[0][0] + 0.5, 3): solid.name for solid in back.solids}
    assert places[2.0] == "日本語 상자"


@pytest.mark.parametrize("to", ["mjcf", "sdf", "usd", "glb"])
def test_names_that_are_no_unicode_are_refused(to, tmp_path):
    world = World("w", (Solid("a\udcff", Box((1, 1, 1))),))
    with pytest.raises(WorldError, match=r"a\\udcff.* Unicode"):
        export_world(world, tmp_path / f"w{FORMATS[to].suffixes[0]}")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("to", ["mjcf", "sdf", "usd"])
def test_a_mirrored_mesh_keeps_its_faces_as_they_look(to, tmp_path):
    mirrored = Mesh(l_shape().vertices * (-1, 1, 1), l_shape().faces)
    world = World("w", (Solid("mirrored", mirrored, TURNED),))
    assert_same(World.load(export_world(world, tmp_path / f"w{FORMATS[to].suffixes[0]}")), world, 1e-6)


@pytest.mark.parametrize("to", ["mjcf", "sdf", "usd"])
def test_a_world_of_thousands_of_solids_loads_back(to, tmp_path):
    shapes = (Box((0.5, 0.4, 0.3)), Cylinder(0.3, 1.0), Sphere(0.4))
    places = np.random.default_rng(3).uniform(-100.0, 100.0, (3000, 2))
    solids = (Solid(f"s{n}", shapes[n % 3], Pose3D.planar(x, y, 0.5, n)) for n, (x, y) in enumerate(places))
    world = World("many", tuple(solids))
    assert_same(
        World.load(export_world(world, tmp_path / f"w{FORMATS[to].suffixes[0]}")), World("w", world.solids), 1e-6
    )


def test_an_empty_world_is_written_as_a_floor_or_refused(tmp_path):
    model = mujoco.MjModel.from_xml_path(str(export_world(World("empty", ()), tmp_path / "e.xml")))
    assert model.ngeom == 1
    with pytest.raises(WorldError, match="no solids"):
        export_world(World("empty", ()), tmp_path / "e.sdf")


def test_unknown_formats_and_wrong_suffixes_are_refused(zoo, tmp_path):
    with pytest.raises(UnknownNameError, match="Did you mean 'mjcf'"):
        export_world(zoo, tmp_path / "a.xml", to="mjfc")
    with pytest.raises(InputError, match=r"end in \.sdf or \.world"):
        export_world(zoo, tmp_path / "a.xml", to="sdf")
    with pytest.raises(InputError, match=r"\.glb \(glb\)"):
        export_world(zoo, tmp_path / "a.txt")
    with pytest.raises(InputError, match="cannot hold a world; a world can be written as glb, map, mjcf, sdf, usd"):
        export_world(zoo, tmp_path / "a.urdf")
    with pytest.raises(InputError, match="cannot hold a robot"):
        export_robot(Robot.load("jackal"), tmp_path / "a.glb")
    with pytest.raises(InputError, match="colour"):
        export_world(zoo, tmp_path / "a.glb", colour=1)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("to", ["mjcf", "usd", "sdf", "glb", "map"])
def test_paths_that_cannot_be_written_are_errors(to, zoo, tmp_path):
    suffix = FORMATS[to].suffixes[0]
    with pytest.raises(OutputError, match="cannot write"):
        export_world(zoo, tmp_path / "none" / f"a{suffix}")
    folder = tmp_path / f"b{suffix}"
    folder.mkdir()
    with pytest.raises(OutputError, match="folder"):
        export_world(zoo, folder)


@pytest.mark.parametrize("to", ["mjcf", "sdf"])
def test_names_that_xml_cannot_hold_are_refused(to, tmp_path):
    world = World("w", (Solid("a\x00b", Box((1, 1, 1))),))
    with pytest.raises(WorldError, match=r"a\\x00b"):
        export_world(world, tmp_path / f"w{FORMATS[to].suffixes[0]}")
    assert list(tmp_path.iterdir()) == []


def test_a_flat_mesh_that_mujoco_refuses_says_so_and_keeps_what_was_there(tmp_path):
    path = tmp_path / "w.xml"
    path.write_text("kept")
    flat = Mesh(np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0)], dtype=float), np.array([(0, 1, 2)]))
    with pytest.raises(WorldError, match="MuJoCo cannot represent"):
        export_world(World("w", (Solid("flat", flat),)), path)
    assert path.read_text() == "kept"
    assert list(tmp_path.iterdir()) == [path]


def test_what_was_there_is_replaced(tmp_path, zoo):
    for to, known in FORMATS.items():
        if known.world is None:
            continue
        path = tmp_path / f"w{known.suffixes[0]}"
        path.write_text("old")
        export_world(zoo, path, to=to)
        assert path.read_bytes() != b"old"


def test_a_map_of_a_band_that_nothing_is_in_says_so(tmp_path):
    world = World("high", (Solid("lamp", Box((1, 1, 0.2)), Pose3D((0, 0, 3.0))),))
    with pytest.warns(MapWarning, match="no obstacles: no solid within its bounds reaches into heights 0.1 to 0.62"):
        export_world(world, tmp_path / "w.yaml")
    with pytest.raises(InputError, match="z_range"):
        export_world(world, tmp_path / "w.yaml", z_range=(0.6, 0.1))


def test_every_format_says_what_it_can_hold():
    for name, known in FORMATS.items():
        assert known.world or known.robot or known.scene, name
        assert all(suffix.startswith(".") for suffix in known.suffixes)
