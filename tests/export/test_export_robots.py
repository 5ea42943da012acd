import math
import xml.etree.ElementTree as ElementTree

import mujoco
import numpy as np
import pytest

from trundle.export import export_robot
from trundle.export.urdf import describe_robot
from trundle.robots import Robot, robot_names
from trundle.sim.mujoco.joints import list_joints
from trundle.sim.mujoco.model import robot_spec


@pytest.mark.parametrize("name", robot_names())
def test_a_urdf_has_the_robots_masses_inertias_and_joints(name, tmp_path):
    robot = Robot.load(name)
    path = export_robot(robot, tmp_path / "robot.urdf")
    root = ElementTree.parse(path).getroot()
    model = robot_spec(robot, looks=False).compile()
    total = 0.0
    for link in root.findall("link"):
        inertial = link.find("inertial")
        if inertial is None:
            continue
        body = model.body(link.get("name"))
        mass = float(inertial.find("mass").get("value"))
        total += mass
        assert mass == body.mass[0]
        tensor = {key: float(value) for key, value in inertial.find("inertia").attrib.items()}
        moments = np.linalg.eigvalsh(
            [
                [tensor["ixx"], tensor["ixy"], tensor["ixz"]],
                [tensor["ixy"], tensor["iyy"], tensor["iyz"]],
                [tensor["ixz"], tensor["iyz"], tensor["izz"]],
            ]
        )
        assert moments == pytest.approx(sorted(body.inertia.tolist()), rel=1e-9)
    assert total == pytest.approx(robot.total_mass, rel=1e-12)
    joints = {joint.name: joint for joint in list_joints(str(path))}
    for wheel in (robot.drive.left_joint, robot.drive.right_joint):
        assert (joints[wheel].type, joints[wheel].axis) == ("continuous", (0.0, 1.0, 0.0))
    swivels = {caster.swivel_joint for caster in robot.casters if caster.is_swivel}
    assert swivels <= set(joints)
    frame = robot.caster_frame
    if frame is not None:
        assert joints[frame.joint].limits == pytest.approx((-frame.limit, frame.limit))
        assert {joints[name].parent for name in swivels} == {joints[frame.joint].child}


@pytest.mark.parametrize("name", robot_names())
def test_mujoco_reads_the_urdf_with_the_wheels_where_they_are(name, tmp_path):
    robot = Robot.load(name)
    path = export_robot(robot, tmp_path / "robot.urdf")
    spec = mujoco.MjSpec.from_file(str(path))
    spec.compiler.fusestatic = False
    spec.meshdir = str(tmp_path / "robot_meshes")
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    drive = robot.drive
    left, right = (data.joint(joint).xanchor for joint in (drive.left_joint, drive.right_joint))
    assert left - right == pytest.approx([0.0, drive.track_width, 0.0], abs=1e-9)
    assert left[2] == pytest.approx(drive.wheel_radius)


@pytest.mark.parametrize("name", robot_names())
def test_an_mjcf_is_the_robot_that_is_simulated(name, tmp_path):
    robot = Robot.load(name)
    model = mujoco.MjModel.from_xml_path(str(export_robot(robot, tmp_path / "robot.xml")))
    expected = robot_spec(robot, floor=True).compile()
    assert (model.nbody, model.njnt, model.nu, model.ngeom) == (
        expected.nbody,
        expected.njnt,
        expected.nu,
        expected.ngeom,
    )
    assert np.allclose(model.body_mass, expected.body_mass, rtol=1e-6)
    assert np.allclose(model.body_inertia, expected.body_inertia, rtol=1e-5)
    assert model.opt.integrator == expected.opt.integrator
    assert math.isclose(model.opt.timestep, expected.opt.timestep)


@pytest.mark.filterwarnings("ignore::trundle.errors.RobotWarning")
@pytest.mark.parametrize("suffix", [".urdf", ".xml"])
@pytest.mark.parametrize("name", robot_names())
def test_a_robot_loads_back_with_its_drive_mass_and_footprint(name, suffix, tmp_path):
    robot = Robot.load(name)
    back = Robot.load(export_robot(robot, tmp_path / f"robot{suffix}"))
    assert (back.drive.left_joint, back.drive.right_joint) == (robot.drive.left_joint, robot.drive.right_joint)
    assert back.drive.track_width == pytest.approx(robot.drive.track_width, rel=1e-5)
    assert back.drive.wheel_radius == pytest.approx(robot.drive.wheel_radius, rel=1e-5)
    assert back.total_mass == pytest.approx(robot.total_mass, rel=1e-5)
    assert back.outline.min(axis=0) == pytest.approx(robot.outline.min(axis=0), abs=0.06)
    assert back.outline.max(axis=0) == pytest.approx(robot.outline.max(axis=0), abs=0.06)


@pytest.mark.parametrize("name", ["nova_carter", "jackal"])
def test_the_text_of_a_urdf_is_that_of_the_file(name, tmp_path):
    path = export_robot(Robot.load(name), tmp_path / "robot.urdf")
    assert describe_robot(Robot.load(name)) == path.read_text()


def test_the_text_of_a_urdf_needs_no_file_beside_it():
    corners = ((0.3, 0.0), (0.0, 0.25), (-0.3, 0.0), (0.0, -0.25))
    text = describe_robot(Robot.load("nova_carter").model_copy(update={"footprint": corners}))
    assert "mesh" not in text
    assert 'size="0.6 0.5 0.56"' in text
