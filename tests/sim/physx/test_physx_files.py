"""PhysX in USD files of the user: an environment, and a robot."""

import pytest

pytest.importorskip("pxr")

from support.physx import BODY, COLLIDER, FLOOR, cube, needs_physx, stage
from trundle.errors import RobotWarning
from trundle.export import export_robot, export_world
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Solid
from trundle.mission import run
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

pytestmark = needs_physx

CARTER, EMPTY, START = Robot.load("nova_carter"), World("empty", ()), Pose2D(0.0, 0.0)


@pytest.fixture
def place(tmp_path):
    """An environment with a wall, a box that can be knocked over, and no physics scene."""
    wall = cube("wall", (0.2, 4.0, 1.0), (3.0, 0.0, 0.5), COLLIDER)
    carton = cube("carton", (0.2, 0.2, 0.6), (1.2, 0.0, 0.3), COLLIDER, BODY)
    path = tmp_path / "place.usda"
    path.write_text(stage(FLOOR, wall, carton))
    return str(path)


def drive(sim, periods, command=Twist2D(0.4, 0.0)):
    return [sim.step(command, 0.05) for _ in range(periods)]


def test_contacts_have_the_names_of_prims_and_the_floor_is_none(place):
    with simulate(EMPTY, CARTER, backend="physx", environment=place) as sim:
        assert sim.world is None
        assert not sim.reset(START).contacts
        knocked = drive(sim, 60)
        sim.reset(Pose2D(2.0, 1.5))
        pushed = drive(sim, 60)
    for states, name in ((knocked, "/W/carton"), (pushed, "/W/wall")):
        assert {contact.other for state in states for contact in state.contacts} == {name}
    assert max(state.tilt for state in knocked) < 0.1
    assert all(state.pose.x < 2.9 for state in pushed)


def test_one_mesh_may_be_floor_and_wall(tmp_path):
    points = "(-9, -9, 0), (2, -9, 0), (2, 9, 0), (-9, 9, 0), (2, -9, 1), (2, 9, 1)"
    mesh = f"""\
    def Mesh "hall" (
        prepend apiSchemas = ["PhysicsCollisionAPI", "PhysicsMeshCollisionAPI"]
    )
    {{
        point3f[] points = [{points}]
        int[] faceVertexCounts = [4, 4]
        int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 5, 2]
    }}
"""
    (tmp_path / "hall.usda").write_text(stage(mesh))
    with simulate(EMPTY, CARTER, backend="physx", environment=str(tmp_path / "hall.usda")) as sim:
        assert not sim.reset(START).contacts
        states = drive(sim, 120)
    first = next(state for state in states if state.contacts)
    assert {contact.other for contact in first.contacts} == {"/W/hall"}
    assert first.pose.x == pytest.approx(2.0 - float(CARTER.outline[:, 0].max()), abs=0.05)


def test_lidars_see_the_environment(place):
    with simulate(EMPTY, CARTER, backend="physx", environment=place, lidar=True) as sim:
        scan = next(scan for scan in sim.reset(START).scans if scan.lidar == "front")
        assert sim.world is not None
        assert {solid.name for solid in sim.world.solids} >= {"/W/wall", "/W/carton"}
    assert scan.ranges.min() < 1.2


def test_an_exported_world_and_robot_drive_as_trundle_s_own(tmp_path):
    world = World("w", (Solid("the box", Box((0.4, 0.4, 0.8)), Pose3D((1.5, 0.0, 0.4))),))
    export_world(world, tmp_path / "world.usd", profile="isaac")
    export_robot(CARTER, tmp_path / "robot.usd", profile="isaac")
    files = {"environment": str(tmp_path / "world.usd"), "robot_usd": str(tmp_path / "robot.usd")}
    ends = []
    for options in ({}, files):
        with simulate(world, CARTER, backend="physx", **options) as sim:
            sim.reset(START)
            ends.append(drive(sim, 60)[-1])
    assert ends[0].pose.distance_to(ends[1].pose) < 0.002
    assert {contact.other for contact in ends[1].contacts} == {"the box"}


def test_a_robot_without_a_drive_on_its_wheels_is_told(tmp_path):
    export_robot(CARTER, tmp_path / "robot.usda", profile="isaac")
    text = (tmp_path / "robot.usda").read_text()
    (tmp_path / "robot.usda").write_text(text.replace("float drive:angular:physics:damping", "float other:damping"))
    with (
        pytest.warns(RobotWarning, match="will not follow a commanded speed"),
        simulate(EMPTY, CARTER, backend="physx", robot_usd=str(tmp_path / "robot.usda")),
    ):
        pass


def test_a_run_that_starts_in_what_is_not_on_its_map_ends_with_its_name():
    world = World("w", (Solid("not on the map", Box((0.4, 0.4, 0.8)), Pose3D((0.2, 0.0, 0.4))),))
    with simulate(world, CARTER, backend="physx") as sim:
        episode = run(sim, lambda *_: Twist2D(0.2, 0.0), START, None, time_limit_s=5.0)
    assert episode.outcome == "collided"
    assert episode.metrics.contacts == ("not on the map",)
