import math
import subprocess
import sys

import mujoco
import numpy as np
import pytest

from trundle.errors import InputError, RobotError, SimulationError
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Cylinder, OccupancyCells, Solid, Sphere
from trundle.robots import Robot, robot_names
from trundle.sim import simulate
from trundle.sim.kinematic import KinematicSimulator
from trundle.sim.mujoco.model import build_spec
from trundle.sim.mujoco.simulator import MujocoSimulator
from trundle.worlds import World

EMPTY = World("empty", ())
CARTER = Robot.load("nova_carter")
ROBOTS = ["nova_carter", "turtlebot3_burger", "turtlebot3_waffle", "jackal"]


def drive(simulator, command, duration, pose=Pose2D(0.0, 0.0), *, seed=0):
    simulator.reset(pose, seed=seed)
    return [simulator.step(command, 0.05) for _ in range(round(duration / 0.05))]


@pytest.mark.parametrize(
    ("casters", "millimetres"), [("trailing", 10.0), ("reversed", 25.0)], ids=["trailing", "reversed"]
)
@pytest.mark.parametrize("command", [(0.4, 0.0), (0.0, 0.8), (0.25, -0.5)], ids=["straight", "spin", "arc"])
def test_five_seconds_end_where_the_limited_twist_leads(command, casters, millimetres):
    with MujocoSimulator(EMPTY, CARTER, casters=casters) as engine, KinematicSimulator(EMPTY, CARTER) as exact:
        got, expected = (drive(each, Twist2D(*command), 5.0)[-1].pose for each in (engine, exact))
    assert got.distance_to(expected) * 1000.0 < millimetres
    assert abs(math.remainder(got.yaw - expected.yaw, math.tau)) < math.radians(1.0)


def test_the_same_run_comes_out_bit_for_bit():
    world = World("post", (Solid("post", Cylinder(0.2, 1.0), Pose3D((0.8, 0.1, 0.5))),))
    with MujocoSimulator(world, CARTER, lidar=True) as first, MujocoSimulator(world, CARTER, lidar=True) as second:
        runs = [drive(each, Twist2D(0.4, 0.1), 4.0, seed=3) for each in (first, second, first)]
    assert any(state.contacts for state in runs[0])
    for a, b, c in zip(*runs, strict=True):
        for field in ("time", "pose", "twist", "wheel_positions", "wheel_speeds", "odometry", "contacts"):
            assert getattr(a, field) == getattr(b, field) == getattr(c, field)
        for one, other in zip(a.scans, c.scans, strict=True):
            assert np.array_equal(one.ranges, other.ranges)


def test_a_run_is_the_same_wherever_it_starts():
    with MujocoSimulator(EMPTY, CARTER) as simulator:
        here = drive(simulator, Twist2D(0.3, 0.4), 3.0)[-1].pose
        start = Pose2D(7.0, -3.0, 2.0)
        there = start.inverse() @ drive(simulator, Twist2D(0.3, 0.4), 3.0, start)[-1].pose
    assert here.distance_to(there) < 1e-4


@pytest.mark.parametrize("robot", ROBOTS)
def test_a_robot_never_touches_itself_or_reports_the_floor(robot):
    with MujocoSimulator(EMPTY, Robot.load(robot)) as simulator:
        for command in (Twist2D(9.0, 9.0), Twist2D(-9.0, 0.5), Twist2D(0.0, -9.0)):
            assert not any(state.contacts for state in drive(simulator, command, 2.0))
        spec = build_spec(EMPTY, Robot.load(robot))
        own = [geom for geom in spec.geoms if geom.name.startswith("robot:")]
        assert not any(a.contype & b.conaffinity for a in own for b in own)


def test_the_floor_carries_all_wheels_at_rest():
    with MujocoSimulator(EMPTY, CARTER) as simulator:
        simulator.reset(Pose2D(1.0, 1.0, 1.0))
        force, carried = np.zeros(6), 0.0
        for index in range(simulator.data.ncon):
            mujoco.mj_contactForce(simulator.model, simulator.data, index, force)
            carried += force[0]
        assert simulator.data.ncon == 4
        assert carried == pytest.approx(CARTER.total_mass * 9.81, rel=1e-3)


@pytest.mark.parametrize("joint", [CARTER.drive.left_joint, "joint_caster_left"])
def test_wheels_are_balanced(joint):
    model = build_spec(EMPTY, CARTER).compile()
    body = model.jnt_bodyid[model.joint(joint).id]
    assert model.body_ipos[body] == pytest.approx([0.0, 0.0, 0.0])


def test_the_model_weighs_what_the_robot_does():
    model = build_spec(EMPTY, CARTER).compile()
    assert model.body_mass.sum() == pytest.approx(CARTER.total_mass)


@pytest.mark.parametrize(
    ("solid", "part", "touched"),
    [
        (Solid("crate", Box((0.4, 0.4, 0.5)), Pose3D((1.0, 0.0, 0.25))), "chassis", "crate"),
        (Solid("drum", Cylinder(0.3, 1.0), Pose3D((1.0, 0.1, 0.5))), "chassis", "drum"),
        (Solid("ball", Sphere(0.3), Pose3D((1.0, 0.0, 0.3))), "chassis", "ball"),
        (Solid("kerb", Box((0.2, 4.0, 0.05)), Pose3D((1.0, 0.0, 0.025))), "wheel_", "kerb"),
    ],
    ids=lambda value: value.name if isinstance(value, Solid) else None,
)
def test_a_collision_names_both_parts(solid, part, touched):
    with MujocoSimulator(World("w", (solid,)), CARTER) as simulator:
        states = drive(simulator, Twist2D(0.5, 0.0), 3.0)
    first = next(state for state in states if state.contacts)
    assert {contact.other for contact in first.contacts} == {touched}
    assert all(contact.part.startswith(part) for contact in first.contacts)
    assert 0.5 < first.contacts[0].x < 1.0


def test_a_collision_with_cells_names_the_cell():
    blocked = np.zeros((40, 40), dtype=bool)
    blocked[20, 30] = True
    world = World("w", (Solid("map", OccupancyCells(blocked, 0.1, 1.0), Pose3D.planar(-2.0, -2.05, 0.0)),))
    with MujocoSimulator(world, CARTER) as simulator:
        states = drive(simulator, Twist2D(0.4, 0.0), 4.0)
    first = next(state for state in states if state.contacts)
    assert {contact.other for contact in first.contacts} == {"map[20,30]"}
    # Cell (20, 30) begins at x = 1.0 m; the slope to it is 6 % of a cell away at the height of the chassis's edge.
    assert first.pose.x + 0.14 == pytest.approx(1.0, abs=0.03)


@pytest.mark.parametrize("backend", ["mujoco", "kinematic"])
@pytest.mark.parametrize(
    "solid",
    [
        Solid("rack_3", Box((2.0, 2.0, 2.0)), Pose3D((5.0, 5.0, 1.0))),
        Solid("rack_3", Cylinder(1.0, 2.0), Pose3D((5.0, 5.0, 1.0))),
        Solid("rack_3", OccupancyCells(np.ones((40, 40), bool), 0.05, 1.0), Pose3D((4.0, 4.0, 0.0))),
    ],
    ids=["box", "cylinder", "cells"],
)
def test_a_start_inside_a_solid_shows_in_the_state(solid, backend):
    with simulate(World("w", (solid,)), CARTER, backend=backend) as simulator:
        state = simulator.reset(Pose2D(5.1, 4.9, 0.3))
        assert state.contacts
        assert all(contact.other.startswith("rack_3") for contact in state.contacts)
        assert not simulator.reset(Pose2D(0.0, 0.0)).contacts


def test_odometry_follows_the_wheels_and_a_slippery_floor_fools_it():
    wall = Solid("wall", Box((0.2, 4.0, 1.0)), Pose3D((0.5, 0.0, 0.5)))
    with MujocoSimulator(World("w", (wall,)), CARTER) as simulator:
        for side in ("left", "right"):
            simulator.model.geom_friction[simulator.model.geom(f"robot:wheel_{side}").id, 0] = 0.2
        last = drive(simulator, Twist2D(0.4, 0.0), 3.0)[-1]
        assert last.pose.x < 0.4
        assert last.odometry.x > 0.9
        turned = 0.14 * (last.wheel_positions.left + last.wheel_positions.right) / 2.0
        assert last.odometry.x == pytest.approx(turned, abs=0.01)


def test_wheels_that_grip_stop_at_a_wall():
    wall = Solid("wall", Box((0.2, 4.0, 1.0)), Pose3D((0.5, 0.0, 0.5)))
    with MujocoSimulator(World("w", (wall,)), CARTER) as simulator:
        last = drive(simulator, Twist2D(0.4, 0.0), 3.0)[-1]
    assert last.wheel_speeds.left == pytest.approx(0.0, abs=0.012)
    assert last.odometry.x == pytest.approx(last.pose.x, abs=0.01)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("name", robot_names())
def test_a_robot_that_pushes_a_wall_is_not_thrown_back(name, sign):
    robot = Robot.load(name)
    start = max(sign * robot.outline[:, 0]) + 0.05
    wall = Solid("wall", Box((0.2, 4.0, 1.0)), Pose3D((sign * (start + 0.1), 0.0, 0.5)))
    with MujocoSimulator(World("w", (wall,)), robot) as simulator:
        height = float(simulator.data.qpos[2])
        speed = sign * robot.limits.linear_speed
        touched = False
        for step in range(500):
            state = simulator.step(Twist2D(speed if step < 400 else 0.0, 0.0), 0.005)
            touched = touched or bool(state.contacts)
            if touched:
                assert sign * simulator.data.qvel[0] > -0.1
                assert 0.05 - sign * state.pose.x < 0.001
                assert simulator.data.qpos[2] - height < 0.0005
    assert touched


def test_a_wheel_that_meets_a_kerb_below_the_chassis_touches_it_and_does_not_climb():
    kerb = Solid("kerb", Box((0.2, 4.0, 0.05)), Pose3D((0.5, 0.0, 0.025)))
    with MujocoSimulator(World("w", (kerb,)), CARTER) as simulator:
        states = drive(simulator, Twist2D(0.4, 0.0), 3.0)
    assert {contact.part for state in states for contact in state.contacts} == {"wheel_left", "wheel_right"}
    assert states[-1].pose.x < 0.4


def test_odometry_is_good_where_nothing_is_in_the_way():
    with MujocoSimulator(EMPTY, CARTER) as simulator:
        last = drive(simulator, Twist2D(0.4, -0.5), 5.0, Pose2D(1.0, 2.0, 3.0))[-1]
    assert last.odometry.distance_to(last.pose) < 0.015


def test_the_twist_is_that_of_base_link():
    with MujocoSimulator(EMPTY, CARTER) as simulator:
        last = drive(simulator, Twist2D(0.4, 0.3), 3.0, Pose2D(0.0, 0.0, 2.0))[-1]
    assert (last.twist.v, last.twist.w) == pytest.approx((0.4, 0.3), abs=0.002)
    assert last.wheel_speeds == pytest.approx(CARTER.wheel_speeds(Twist2D(0.4, 0.3)), abs=0.02)


def test_other_periods_and_timesteps_give_nearly_the_same_run():
    ends = []
    for timestep, period in ((0.005, 0.05), (0.005, 0.1), (0.0025, 0.05), (0.01, 0.05)):
        with MujocoSimulator(EMPTY, CARTER, timestep=timestep) as simulator:
            simulator.reset(Pose2D(0.0, 0.0))
            for _ in range(round(3.0 / period)):
                state = simulator.step(Twist2D(0.4, 0.2), period)
            ends.append(state.pose)
    assert max(end.distance_to(ends[0]) for end in ends) < 0.01


def test_the_physics_breaking_down_is_an_error_and_leaves_no_log_file(tmp_path, monkeypatch, caplog):
    monkeypatch.chdir(tmp_path)
    with MujocoSimulator(EMPTY, CARTER) as simulator:
        simulator.step(Twist2D(), 0.05)
        simulator.data.qvel[0] = 1e6
        with pytest.raises(SimulationError, match=r"diverged at 0\.1"):
            simulator.step(Twist2D(), 0.05)
        simulator.data.qpos[0] = math.nan
        with pytest.raises(SimulationError, match="diverged"):
            simulator.step(Twist2D(), 0.05)
        assert simulator.reset(Pose2D(1.0, 0.0)).pose.x == 1.0
    assert "MuJoCo: " in caplog.text
    assert not list(tmp_path.iterdir())


def test_the_state_says_how_far_the_robot_is_tilted():
    with MujocoSimulator(EMPTY, CARTER) as simulator:
        simulator.reset(Pose2D(0.0, 0.0, 1.0))
        assert simulator.step(Twist2D(0.4, 0.2), 0.05).tilt < 0.05
        simulator.data.qpos[3:7] = (math.cos(0.75), math.sin(0.75), 0.0, 0.0)  # rolled by 1.5 rad
        simulator.data.qpos[2] += 0.5
        assert simulator.step(Twist2D(), 0.05).tilt == pytest.approx(1.5, abs=0.1)


def test_options_out_of_range_are_refused():
    with pytest.raises(InputError, match=r"timestep 0\.5"):
        MujocoSimulator(EMPTY, CARTER, timestep=0.5)
    with pytest.raises(InputError, match="'trailing' or 'reversed'"):
        MujocoSimulator(EMPTY, CARTER, casters="sideways")
    with pytest.raises(InputError, match="backend 'mujoco'"):
        simulate(EMPTY, CARTER, lidars=True)


def test_a_robot_that_does_not_stand_is_refused():
    falling = CARTER.model_copy(update={"casters": ()})
    with pytest.raises(RobotError, match="wheels and casters do not support it"):
        MujocoSimulator(EMPTY, falling)


def test_two_joints_of_one_name_are_refused():
    drive_of_one_name = CARTER.drive.model_copy(update={"right_joint": CARTER.drive.left_joint})
    with pytest.raises(RobotError, match="MuJoCo cannot model the robot 'nova_carter'"):
        MujocoSimulator(EMPTY, CARTER.model_copy(update={"drive": drive_of_one_name}))


def test_what_is_out_of_reach_costs_nothing_and_is_still_seen():
    solids = (
        Solid("lintel", Box((1.0, 1.0, 1.0)), Pose3D((0.0, 0.0, 1.5))),
        Solid("shelf", Box((1.0, 1.0, 0.1)), Pose3D((0.0, 0.0, 0.7))),
    )
    with MujocoSimulator(World("w", solids), CARTER) as simulator:
        names = {simulator.model.geom(index).name for index in range(simulator.model.ngeom)}
        assert names & {"lintel", "shelf"} == {"shelf"}
        assert not any(state.contacts for state in drive(simulator, Twist2D(0.0, 0.5), 1.0))
    spec = build_spec(World("w", solids), CARTER)  # older MuJoCos do not keep it for its elements
    assert {geom.name for geom in spec.geoms} >= {"lintel", "shelf"}


def test_an_outline_that_is_no_rectangle_becomes_a_prism():
    corners = ((0.2, 0.0), (0.0, 0.25), (-0.55, 0.25), (-0.55, -0.25), (0.0, -0.25))
    robot = CARTER.model_copy(update={"footprint": corners})
    robot = Robot.model_validate(robot.model_dump())
    world = World("w", (Solid("post", Box((0.02, 0.02, 1.0)), Pose3D((0.11, 0.24, 0.5))),))
    with MujocoSimulator(world, robot) as simulator:
        assert not simulator.reset(Pose2D(0.0, 0.0)).contacts
    with MujocoSimulator(world, CARTER) as simulator:
        assert simulator.reset(Pose2D(0.0, 0.0)).contacts


def test_the_engine_is_imported_only_when_it_is_used():
    code = (
        "import sys, trundle; from trundle.sim.kinematic import KinematicSimulator; trundle.simulate; "
        "sys.exit('mujoco' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_the_frame_of_the_casters_rocks_and_keeps_the_masses_of_the_robot():
    rigid = CARTER.model_copy(update={"caster_frame": None})
    with MujocoSimulator(EMPTY, CARTER) as simulator:
        joint = simulator.model.joint("joint_caster_base")
        assert tuple(joint.range) == pytest.approx((-math.radians(2.0), math.radians(2.0)))
        assert float(joint.stiffness[0]) * math.pi / 180.0 == pytest.approx(100.0)
        assert simulator.model.body("caster_0_fork").parentid[0] == simulator.model.body("caster_frame").id
        assert simulator.model.body_subtreemass[1] == pytest.approx(CARTER.total_mass)
        place = simulator.data.body("caster_1").xpos
        assert abs(simulator.data.qpos[joint.qposadr[0]]) < 1e-4
    with MujocoSimulator(EMPTY, rigid) as simulator:
        assert simulator.data.body("caster_1").xpos == pytest.approx(place, abs=5e-4)
    assert CARTER.total_mass == pytest.approx(rigid.total_mass + 1.69)


def test_casters_of_other_robots_may_be_on_a_frame(tmp_path):
    frame = "caster_frame: {joint: rock, x: -0.07, z: 0.05, mass: 0.05, limit: 3deg, stiffness: 50, damping: 1}\n"
    (tmp_path / "rocker.yaml").write_text("base: turtlebot3_waffle\n" + frame)
    robot = Robot.load(tmp_path / "rocker.yaml")
    with MujocoSimulator(EMPTY, robot) as simulator:
        last = drive(simulator, Twist2D(0.2, 0.0), 2.0)[-1]
        assert simulator.model.body("caster_0").parentid[0] == simulator.model.body("caster_frame").id
    assert last.pose.x == pytest.approx(0.4, abs=0.02)
