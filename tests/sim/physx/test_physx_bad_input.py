"""USD that PhysX cannot simulate, or not all of: one message each."""

import pytest

pytest.importorskip("pxr")

from support.physx import BODY, COLLIDER, FLOOR, cube, needs_physx, prim, stage
from trundle.errors import InputError, RobotError, SimulationError, UnknownNameError, WorldError, WorldWarning
from trundle.export import export_robot
from trundle.geometry import Pose2D
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.sim.physx.files import choose_files, write_scene
from trundle.worlds import World

CARTER, EMPTY = Robot.load("nova_carter"), World("empty", ())
MESH = """\
        point3f[] points = [{points}]
        int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [{faces}]
"""


def compose(tmp_path, *, text=None, robot_usd=None):
    """The stage of an environment or a robot; PhysX itself is not needed for it."""
    environment = None
    if text is not None:
        (tmp_path / "place.usda").write_text(text)
        environment = str(tmp_path / "place.usda")
    files = choose_files(CARTER, environment=environment, robot_usd=robot_usd, assets_root=None)
    (tmp_path / "stage").mkdir(exist_ok=True)
    return write_scene(tmp_path / "stage", EMPTY, CARTER, files, None, height=0.02, timestep=0.005)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (stage(cube("floor", (9.0, 9.0, 0.2), (0.0, 0.0, -0.1))), "it has no physics: none of its prims is a collider"),
        (stage(FLOOR, meters=0.01), "the stage is in centimetres, but robots and maps are in metres"),
        (stage(FLOOR, up="Y"), "the up axis is Y, it must be Z"),
        ("hello", "cannot be read as a USD file"),
    ],
)
def test_an_environment_that_cannot_be_used(tmp_path, text, message):
    with pytest.raises(WorldError, match=message):
        compose(tmp_path, text=text)


def test_a_reference_that_is_missing_is_left_out_with_a_warning(tmp_path, capfd):
    text = stage(FLOOR, '    def "shelf" (\n        references = @./nowhere.usd@\n    )\n    {\n    }\n')
    with pytest.warns(WorldWarning, match="/W/shelf: .*nowhere.usd.* It is left out"):
        compose(tmp_path, text=text)
    assert capfd.readouterr().err == ""


@pytest.fixture
def carter_usd(tmp_path):
    path = tmp_path / "carter.usda"
    export_robot(CARTER, path, profile="isaac")
    return path


def changed(path, old, new):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    return str(path)


def test_a_robot_with_other_joint_names(tmp_path, carter_usd):
    usd = changed(carter_usd, "joint_wheel_left", "left_axle")
    with pytest.raises(RobotError, match=r"has no joint joint_wheel_left; it has .*left_axle.*left_joint"):
        compose(tmp_path, robot_usd=usd)


def test_a_robot_in_centimetres(tmp_path, carter_usd):
    usd = changed(carter_usd, "metersPerUnit = 1", "metersPerUnit = 0.01")
    with pytest.raises(RobotError, match=r"is in units of 0\.01 m, it must be in metres"):
        compose(tmp_path, robot_usd=usd)


def test_a_robot_without_physics(tmp_path):
    (tmp_path / "statue.usda").write_text(stage(cube("body", (1.0, 1.0, 1.0), (0.0, 0.0, 0.5))))
    with pytest.raises(RobotError, match=r"must have one articulation .*it has none. Is it the file of a robot"):
        compose(tmp_path, robot_usd=str(tmp_path / "statue.usda"))


def test_a_robot_without_a_default_prim(tmp_path, carter_usd):
    usd = changed(carter_usd, 'defaultPrim = "nova_carter"', "")
    with pytest.raises(RobotError, match="has no default prim to refer to"):
        compose(tmp_path, robot_usd=usd)


def test_a_robot_that_is_no_usd(tmp_path):
    (tmp_path / "robot.usda").write_text("hello")
    with pytest.raises(RobotError, match=r"robot\.usda cannot be read as a USD file: "):
        compose(tmp_path, robot_usd=str(tmp_path / "robot.usda"))


@pytest.mark.parametrize(
    ("options", "error", "message"),
    [
        ({"environment": "/nowhere.usd"}, InputError, "environment /nowhere.usd: no such file"),
        ({"environment": "hospitl"}, UnknownNameError, "Did you mean 'hospital'"),
        ({"environment": "hospital"}, InputError, "are not on this machine: give the folder"),
        ({"environment": "https://host/a.usd"}, InputError, "opens files of this machine only; download it first"),
        ({"robot_usd": "/nowhere.usd"}, InputError, "--robot-usd /nowhere.usd: no such file"),
    ],
)
def test_files_that_are_not_there(options, error, message):
    with pytest.raises(error, match=message):
        choose_files(CARTER, **{"environment": None, "robot_usd": None, "assets_root": None, **options})


@needs_physx
@pytest.mark.parametrize("option", [{"physics_dt": 0.0}, {"physics_dt": 0.1}, {"ground_offset": -1.0}])
def test_options_out_of_range(option):
    with pytest.raises(InputError, match="is out of range"):
        simulate(EMPTY, CARTER, backend="physx", **option)


@needs_physx
def test_no_floor_under_the_robot(tmp_path):
    (tmp_path / "pit.usda").write_text(stage(cube("far", (1.0, 1.0, 1.0), (9.0, 0.0, 0.5), COLLIDER)))
    with pytest.raises(SimulationError, match=r"the robot fell .* there is no collider under it"):
        simulate(EMPTY, CARTER, backend="physx", environment=str(tmp_path / "pit.usda"))


@needs_physx
@pytest.mark.parametrize(
    ("bad", "message"),
    [
        (prim("Mesh", "bad", MESH.format(points="", faces="0, 1, 2"), COLLIDER, "PhysicsMeshCollisionAPI"), "/W/bad"),
        (
            prim("Mesh", "bad", MESH.format(points="(0, 0, 0), (nan, 0, 0), (0, 1, 0)", faces="0, 1, 2"), COLLIDER),
            "corrupted vertex data|/W/bad",
        ),
        (prim("Mesh", "bad", MESH.format(points="(0, 0, 0)", faces="0, 1, 2"), COLLIDER), "/W/bad"),
        (
            prim("Mesh", "bad", MESH.format(points="(5, 0, 0), (6, 0, 0), (7, 0, 0)", faces="0, 1, 2"), COLLIDER),
            "/W/bad",
        ),
        (cube("bad", (0.0, 1.0, 1.0), (5.0, 0.0, 0.5), COLLIDER), "/W/bad"),
        (cube("bad", (1.0, 1.0, 1.0), ("nan", 0.0, 0.5), COLLIDER).replace("'nan'", "nan"), "/W/bad"),
    ],
)
def test_a_collider_that_physx_refuses_is_one_warning(tmp_path, capfd, caplog, bad, message):
    (tmp_path / "place.usda").write_text(stage(FLOOR, bad))
    with (
        pytest.warns(WorldWarning, match=rf"PhysX refuses a part of it, .*({message})") as told,
        simulate(EMPTY, CARTER, backend="physx", environment=str(tmp_path / "place.usda")) as sim,
    ):
        assert not sim.reset(Pose2D(0.0, 0.0)).contacts
    assert len(told) == 1
    # Nor from the resets, which read the stage again. (ovphysx itself advises once to install another package.)
    assert not [record for record in caplog.records if record.name.startswith("trundle")]
    assert "\n" not in str(told[0].message)
    assert capfd.readouterr() == ("", "")


@needs_physx
def test_a_body_that_moves_with_a_triangle_mesh_is_no_trouble(tmp_path):
    mesh = MESH.format(points="(4, 0, 0), (5, 0, 0), (4, 1, 0), (4, 0, 1)", faces="0, 1, 2")
    (tmp_path / "place.usda").write_text(stage(FLOOR, prim("Mesh", "body", mesh, COLLIDER, BODY)))
    with simulate(EMPTY, CARTER, backend="physx", environment=str(tmp_path / "place.usda")) as sim:
        assert not sim.reset(Pose2D(0.0, 0.0)).contacts


@needs_physx
def test_wheels_that_sink_into_a_thin_floor_are_told(tmp_path):
    floor = cube("floor", (50.0, 50.0, 0.2), (0.0, 0.0, -0.1), COLLIDER)
    (tmp_path / "place.usda").write_text(stage(floor))
    with pytest.warns(WorldWarning, match=r"stands tilted by 5\.\d°\. .* Make such a floor thicker, or a plane"):
        simulate(EMPTY, CARTER, backend="physx", environment=str(tmp_path / "place.usda")).close()
