"""The MJCF that is written is driven in MuJoCo, next to the simulator that it was written from."""

import math

import mujoco
import numpy as np
import pytest

from trundle.export import export_robot, export_world
from trundle.geometry import Pose2D, Pose3D, Twist2D
from trundle.geometry.solids import Box, Mesh, Solid
from trundle.robots import Robot, robot_names
from trundle.sim import simulate
from trundle.worlds import World
from trundle.worlds.tessellate import box_mesh

TIMESTEP = 0.005
COMMANDS = [(Twist2D(0.2, 0.0), 1.0), (Twist2D(0.15, 0.6), 2.0), (Twist2D(0.0, -0.5), 1.0), (Twist2D(-0.1, 0.0), 0.5)]


def yaw_of(quaternion):
    return Pose3D(quaternion=tuple(quaternion)).yaw()


def drive_both(model, robot, world):
    """Give a written model the servos' commands of our simulator, step by step; the poses of both."""
    data = mujoco.MjData(model)
    ours, theirs = [], []
    with simulate(world, robot, timestep=TIMESTEP) as sim:
        sim.reset(Pose2D(0.0, 0.0))
        data.qpos[:] = sim.data.qpos
        for twist, seconds in COMMANDS:
            for _ in range(round(seconds / TIMESTEP)):
                state = sim.step(twist, TIMESTEP)
                data.ctrl[:] = sim.data.ctrl
                mujoco.mj_step(model, data)
                ours.append(state.pose.as_tuple())
                theirs.append((*data.qpos[:2], yaw_of(data.qpos[3:7])))
    return np.array(ours), np.array(theirs)


@pytest.mark.parametrize("name", robot_names())
def test_a_written_robot_drives_as_it_is_simulated(name, tmp_path):
    robot = Robot.load(name)
    model = mujoco.MjModel.from_xml_path(str(export_robot(robot, tmp_path / "robot.xml")))
    assert [model.actuator(index).name for index in range(model.nu)] == [
        robot.drive.left_joint,
        robot.drive.right_joint,
    ]
    ours, theirs = drive_both(model, robot, World("floor", ()))
    assert (np.abs(ours).max(axis=0) > (0.3, 0.03, 0.5)).all()
    assert np.abs(theirs - ours).max() < 1e-3


def test_a_written_world_with_its_robot_drives_as_it_is_simulated(tmp_path):
    robot = Robot.load("nova_carter")
    world = World.generate("corridors")
    model = mujoco.MjModel.from_xml_path(str(export_world(world, tmp_path / "both.xml", robot=robot)))
    ours, theirs = drive_both(model, robot, world)
    assert np.abs(theirs - ours).max() < 1e-3


@pytest.mark.parametrize("name", robot_names())
def test_plain_wheel_speeds_drive_a_written_robot_as_far_as_they_say(name, tmp_path):
    robot = Robot.load(name)
    model = mujoco.MjModel.from_xml_path(str(export_robot(robot, tmp_path / "robot.xml")))
    data = mujoco.MjData(model)
    speed = 0.2
    for step in range(round(4.0 / model.opt.timestep)):
        wheels = robot.wheel_speeds(Twist2D(speed * min(1.0, step * model.opt.timestep), 0.0))
        data.actuator(robot.drive.left_joint).ctrl = wheels.left
        data.actuator(robot.drive.right_joint).ctrl = wheels.right
        mujoco.mj_step(model, data)
    assert data.qpos[0] == pytest.approx(speed * 3.5, rel=0.01)
    assert abs(yaw_of(data.qpos[3:7])) < math.radians(0.5)


def ball_dropped_at(path, x, y):
    """Where a ball comes to rest that falls from 3 m in a written world."""
    spec = mujoco.MjSpec.from_file(str(path))
    spec.option.timestep = 0.002
    ball = spec.worldbody.add_body(name="ball", pos=(x, y, 3.0))
    ball.add_freejoint()
    ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(0.1, 0, 0))
    model = spec.compile()
    data = mujoco.MjData(model)
    for _ in range(1500):
        mujoco.mj_step(model, data)
    return data.body("ball").xpos[2] - 0.1


def test_a_concave_mesh_is_not_filled(tmp_path):
    """A tray: a floor of 0.5 m and two walls of 2 m. Its convex hull is as high as the walls."""
    parts = [
        ((4.0, 4.0, 0.5), (0.0, 0.0, 0.25)),
        ((0.2, 4.0, 2.0), (-2.1, 0.0, 1.0)),
        ((0.2, 4.0, 2.0), (2.1, 0.0, 1.0)),
    ]
    meshes = [(box_mesh(size).vertices + np.array(middle), box_mesh(size).faces) for size, middle in parts]
    vertices = np.vstack([corners for corners, _ in meshes])
    faces = np.vstack([triangles + 8 * index for index, (_, triangles) in enumerate(meshes)])
    tray = Solid("tray", Mesh(vertices, faces), Pose3D((1.0, 0.0, 0.0)), (0.2, 0.4, 0.6, 1.0))
    path = export_world(World("tray", (tray,)), tmp_path / "tray.xml")
    assert ball_dropped_at(path, 1.0, 0.0) == pytest.approx(0.5, abs=0.01)
    (back,) = World.load(path).solids
    assert (back.name, back.color) == ("tray", pytest.approx(tray.color))
    assert len(back.shape.faces) == len(faces)
    np.testing.assert_allclose(back.bounds(), tray.bounds(), atol=1e-6)


@pytest.mark.parametrize("corners", [3, 4])
def test_a_sheet_stops_what_falls_on_it_and_loads_back(corners, tmp_path):
    vertices = np.array([(-3, -3, 1), (3, -3, 1), (3, 3, 1), (-3, 3, 1)], dtype=float)[:corners]
    faces = np.array([(0, 1, 2), (0, 2, 3)])[: corners - 2]
    world = World("sheet", (Solid("sheet", Mesh(vertices, faces)), Solid("box", Box((1, 1, 1)), Pose3D((9, 0, 0.5)))))
    path = export_world(world, tmp_path / "sheet.xml")
    assert ball_dropped_at(path, 1.0, -1.0) == pytest.approx(1.0, abs=0.01)
    back = World.load(path)
    assert {solid.name for solid in back.solids} == {"sheet", "box"}
    for before, after in zip(world.solids, back.solids, strict=True):
        np.testing.assert_allclose(after.bounds(), before.bounds(), atol=1e-6)


def test_a_model_with_a_robot_has_the_worlds_meshes_again_and_not_their_pieces(tmp_path):
    vertices = np.array([(2, -1, 0), (2, 1, 0), (2, 1, 1), (2, -1, 1)], dtype=float)
    world = World("wall", (Solid("wall", Mesh(vertices, np.array([(0, 1, 2), (0, 2, 3)]))),))
    path = export_world(world, tmp_path / "both.xml", robot=Robot.load("jackal"))
    with pytest.warns(UserWarning, match="geometry moved by joints was left out"):
        back = World.load(path)
    assert [solid.name for solid in back.solids] == ["wall"]


def test_a_triangle_alone_can_be_driven_into():
    """MuJoCo takes no mesh of fewer than four corners."""
    triangle = Mesh(np.array([(1.0, -1.0, 0.0), (1.0, 1.0, 0.0), (1.0, 0.0, 1.5)]), np.array([(0, 1, 2)]))
    with simulate(World("w", (Solid("triangle", triangle),)), Robot.load("jackal")) as sim:
        state = sim.reset(Pose2D(0.0, 0.0))
        touched = set()
        for _ in range(60):
            state = sim.step(Twist2D(0.5, 0.0), 0.05)
            touched |= {contact.other for contact in state.contacts}
    assert touched == {"triangle"}
    assert state.pose.x < 1.0
