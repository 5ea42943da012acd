import math

import numpy as np
import pytest

from trundle.control.regulated_pure_pursuit import DrivingOff, RegulatedPurePursuit
from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D, wrap_angle
from trundle.maps import OccupancyGrid
from trundle.path import Path
from trundle.robots import Robot
from trundle.sim.mujoco.simulator import MujocoSimulator
from trundle.worlds import World

DT = 0.05
CARTER = Robot.load("nova_carter")
HALF_TRACK = CARTER.drive.track_width / 2.0
FREE = Costmap.from_grid(OccupancyGrid(np.zeros((200, 200), np.int8), 0.05, Pose2D(-5.0, -5.0)), CARTER.outline)


def right_angle(side):
    """A path with a sharp bend, to the left or to the right, and a turn at its start."""
    corner = side * math.pi / 2.0
    return Path(np.array([[0, 0, -corner], [0, 0, 0], [2, 0, 0], [2, 0, corner], [2, 2 * side, corner]]))


@pytest.mark.parametrize("side", [1, -1])
def test_the_odometry_of_a_robot_that_drives_off_after_a_turn_in_place_stays_right(side):
    controller = RegulatedPurePursuit(CARTER)
    path = right_angle(side)
    controller.set_path(path)
    with MujocoSimulator(World(name="empty", solids=()), CARTER) as sim:
        state = sim.reset(path.start)
        for _ in range(400):
            state = sim.step(controller.compute_velocity(state.pose, state.twist, FREE, DT), DT)
            if controller.is_done:
                break
    assert controller.is_done
    assert abs(wrap_angle(state.odometry.yaw - state.pose.yaw)) < math.radians(0.6)  # 2.6 to 5.0° without the limit


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("limit", [None, 0.6])
def test_no_wheel_speeds_up_faster_than_the_setting(side, limit):
    controller = RegulatedPurePursuit(CARTER, max_linear_accel=limit)
    path = right_angle(side)
    controller.set_path(path)
    most = 0.8 / 0.5 if limit is None else limit
    pose, twist = path.start, Twist2D()
    for _ in range(600):
        command = controller.compute_velocity(pose, twist, FREE, DT)
        after = CARTER.limits.approach(twist, command, DT)
        faster = (abs(after.v) - abs(twist.v)) / DT
        if faster > 0.25 * most + 1e-9:
            assert faster + HALF_TRACK * abs(after.w - twist.w) / DT <= most + 1e-9
        twist, pose = after, after.integrate(pose, DT)
    assert controller.is_done


def test_the_arc_stays_the_same():
    command = DrivingOff(CARTER, 1.6).limit(Twist2D(0.8, 0.4), Twist2D(), DT)
    assert 0.0 < command.v < 1.6 * DT
    assert command.w / command.v == pytest.approx(0.5)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_braking_and_turning_in_place_are_not_limited(sign):
    limit = DrivingOff(CARTER, 1.6).limit
    for command in (Twist2D(), Twist2D(sign * 0.3, 0.7), Twist2D(0.0, -0.7)):
        assert limit(command, Twist2D(sign * 0.8, 0.7), DT) == command


def test_a_robot_whose_motors_lag_behind_reaches_its_speed():
    drive_off, twist = DrivingOff(CARTER, 1.6), Twist2D()
    for _ in range(60):
        command = drive_off.limit(Twist2D(0.8, 0.0), twist, DT)
        drive_off.note(command)
        twist = Twist2D(twist.v + (command.v - twist.v) * DT / 0.3, 0.0)
    assert twist.v > 0.75


def test_after_a_standstill_that_somebody_else_asked_for_it_drives_off_gently():
    drive_off = DrivingOff(CARTER, 1.6)
    for _ in range(60):
        command = drive_off.limit(Twist2D(0.8, 0.0), Twist2D(), DT)
        drive_off.note(command)
    assert command.v == pytest.approx(1.6 * (0.2 + DT))


def test_an_acceleration_of_zero_is_refused():
    with pytest.raises(InputError, match="max_linear_accel"):
        RegulatedPurePursuit(CARTER, max_linear_accel=0.0)
