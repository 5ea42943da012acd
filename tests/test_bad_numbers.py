"""Numbers, poses, seeds and lists that cannot be what was meant: typed errors, and nothing that hangs."""

import math
import warnings

import numpy as np
import pytest

from trundle.control import create_controller
from trundle.control.collision import stopping_poses
from trundle.costmap import Costmap
from trundle.errors import InputError, NoValidControlError, RobotWarning
from trundle.geometry import Pose2D, Pose3D, Twist2D, path_length, wrap_angles
from trundle.geometry.solids import Box, Mesh, OccupancyCells
from trundle.maps import OccupancyGrid, SpeedMask
from trundle.mission import DropBox, Manual, Scenario, StepOnce, Trajectory, load_directives, run, sample_mission
from trundle.navigation import Navigator, NavigatorSettings
from trundle.navigation.command_check import SpeedLimiter
from trundle.observation import Scan
from trundle.path import Path
from trundle.planning import PathCheck, create_planner
from trundle.robots import Robot
from trundle.sim import simulate
from trundle.worlds import World

CARTER = Robot.load("nova_carter")
GRID = OccupancyGrid(np.zeros((80, 120), np.int8), 0.05)
COSTMAP = Costmap.from_grid(GRID, CARTER)
HERE = (2.0, 2.0, 0.0)
RAGGED = [[1, 2], [3]]


def navigator(**options):
    made = Navigator(GRID, CARTER, **options)
    made.set_goal(5.0, 2.0)
    return made


@pytest.mark.parametrize("twist", [(1e6, 0.0), (-1e300, 0.0), (0.0, 1e6), (0.0, -1e300), (1e300, 1e300)])
def test_a_twist_that_no_robot_has_is_cut_with_a_warning(twist):
    with pytest.warns(RobotWarning, match="nova_carter cannot move by"):
        command = navigator().update(HERE, Twist2D(*twist))
    assert CARTER.limits.clamp(command) == command


def test_twists_that_no_robot_has_are_one_warning_of_a_navigator():
    driven = navigator()
    with pytest.warns(RobotWarning, match="and all others from now on, are cut to") as caught:
        assert all(driven.update(HERE, Twist2D(1e4 + step, 0.0)) for step in range(5))
    assert [one.filename for one in caught] == [__file__]


def test_a_twist_somewhat_above_the_limits_is_taken_as_it_is():
    limits = CARTER.limits
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        navigator().update(HERE, Twist2D(-2.0 * limits.linear_speed, 3.0 * limits.angular_speed))


@pytest.mark.parametrize("twist", [Twist2D(1e6, 0.0), Twist2D(1e300, -1e300), Twist2D(0.0, 1e9), Twist2D(0.4, 0.1)])
@pytest.mark.parametrize("dt", [0.05, 1e6, 1e300])
@pytest.mark.parametrize("deceleration", [2.5, 1e-9])
def test_stopping_has_a_bounded_number_of_poses(twist, dt, deceleration):
    limits = CARTER.limits.model_copy(update={"linear_acceleration": deceleration})
    poses = stopping_poses(Pose2D(0.0, 0.0), twist, Twist2D(0.5, 0.1), limits, dt, turn_step=math.radians(90.0))
    assert 1 <= len(poses) - 1 <= 2000 * 180
    straight = stopping_poses(Pose2D(0.0, 0.0), twist, Twist2D(0.5, 0.1), limits, dt)
    assert 1 <= len(straight) - 1 <= 2000


def test_a_controller_survives_a_twist_and_a_period_that_nothing_has():
    controller = create_controller("regulated_pure_pursuit", CARTER)
    made = navigator()
    made.plan(HERE)
    controller.set_path(made.path)
    # The map ends 4 m ahead.
    for twist, dt in (
        (Twist2D(1e6, 0.0), 0.05),
        (Twist2D(6.0, 0.0), 0.05),
        (Twist2D(), 1e6),
    ):
        with pytest.raises(NoValidControlError):
            controller.compute_velocity(Pose2D(*HERE), twist, COSTMAP, dt)
    assert controller.compute_velocity(Pose2D(*HERE), Twist2D(), COSTMAP, 0.05).v > 0.0
    assert 0.0 < 10.0 * controller.compute_velocity(Pose2D(*HERE), Twist2D(), COSTMAP, 10.0).v < 4.0
    with pytest.raises(NoValidControlError):
        controller.compute_velocity(Pose2D(1e308, 2.0), Twist2D(), COSTMAP, 0.05)


def test_a_speed_limit_is_looked_for_on_a_bounded_stretch():
    weak = CARTER.model_copy(update={"limits": CARTER.limits.model_copy(update={"linear_acceleration": 1e-12})})
    limiter = SpeedLimiter(SpeedMask(OccupancyGrid([[30]], 1.0)), weak)
    assert limiter.limit(Pose2D(-3.0, 0.5), Twist2D(), 0, 0.05) <= 0.31 * CARTER.limits.linear_speed


@pytest.mark.parametrize("frequency", [1e-6, 0.0, -20.0, 1e300, math.nan, "fast"])
def test_a_control_frequency_is_one_of_a_robot(frequency):
    with pytest.raises(InputError, match="control_frequency"):
        NavigatorSettings(control_frequency=frequency)
    with pytest.raises(InputError, match="control_frequency"):
        Scenario.make(world="warehouse", control_frequency=frequency)


@pytest.mark.parametrize("time", [math.nan, math.inf, -math.inf, "now"])
def test_a_time_is_a_finite_number(time):
    made = navigator()
    with pytest.raises(InputError, match="time must be a"):
        made.update(HERE, time=time)
    assert made.update(HERE, time=0.0).v > 0.0


@pytest.mark.parametrize(
    "pose", [(math.nan, 0.0, 0.0), (0.0, math.inf), (0.0, 0.0, -math.inf), "ab", None, 5, RAGGED, (1,), 1j]
)
def test_a_pose_is_two_or_three_finite_numbers(pose):
    simulator = simulate(World.from_map(GRID), CARTER, backend="kinematic")
    calls = [
        lambda: Pose2D.of(pose),
        lambda: navigator().update(pose),
        lambda: navigator().plan(pose),
        lambda: navigator().set_goal(pose),
        lambda: create_planner("astar").plan(COSTMAP, pose, HERE),
        lambda: simulator.reset(pose),
        lambda: run(simulator, navigator(), pose, (5.0, 2.0)),
        lambda: run(simulator, navigator(), HERE, pose),
    ]
    if pose is not None:  # which means: pick one
        calls.append(lambda: sample_mission(COSTMAP, 1, start=pose))
    for call in calls:
        with pytest.raises(InputError):
            call()


@pytest.mark.parametrize("given", [("a", "b"), ("1", "2"), (1.0, "b"), (1.0, 2.0, "c"), ((1, 2), 3), (1.0,), (1j, 2)])
def test_a_goal_is_numbers_or_one_pose(given):
    with pytest.raises(InputError):
        navigator().set_goal(*given)


def test_a_goal_may_be_numbers_of_numpy():
    made = navigator()
    made.set_goal(np.int64(4), np.float32(2))
    assert made.goal == Pose2D(4.0, 2.0)
    made.set_goal(np.array([4.0, 2.0, 1.0]))
    assert made.goal == Pose2D(4.0, 2.0, 1.0)


@pytest.mark.parametrize("twist", [(0.1, 0.0), "fast", 0.5])
def test_a_twist_is_a_twist(twist):
    with pytest.raises(InputError, match="Twist2D"):
        navigator().update(HERE, twist)


@pytest.mark.parametrize("seed", [-1, 1.5, "a", None, True, RAGGED])
@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_a_seed_is_a_whole_number_of_0_or_more(seed, backend):
    with simulate(World.from_map(GRID), CARTER, backend=backend) as simulator:
        with pytest.raises(InputError, match="seed"):
            simulator.reset(Pose2D(2.0, 2.0), seed=seed)
        assert simulator.reset(Pose2D(2.0, 2.0), seed=np.int64(3)).time == 0.0
    with pytest.raises(InputError, match="seed"):
        sample_mission(COSTMAP, seed)
    with pytest.raises(InputError, match="seed"):
        World.generate("warehouse", seed=seed)


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
@pytest.mark.parametrize(
    ("command", "dt"), [((0.1, 0.0), 0.05), (None, 0.05), (Twist2D(), "a"), (Twist2D(), math.nan), (Twist2D(), 1e6)]
)
def test_a_step_is_a_twist_for_a_time(backend, command, dt):
    with simulate(World.from_map(GRID), CARTER, backend=backend) as simulator, pytest.raises(InputError):
        simulator.step(command, dt)


@pytest.mark.parametrize(
    "call",
    [
        lambda: Path(RAGGED),
        lambda: Path("abc"),
        lambda: Path([[0, 0, 0], [1, 0, 0]], backward=RAGGED),
        lambda: wrap_angles(RAGGED),
        lambda: path_length(RAGGED),
        lambda: Pose2D(0, 0).transform_points(RAGGED),
        lambda: Pose2D(0, 0).transform_points([[1, 2, 3]]),
        lambda: Pose3D(RAGGED),
        lambda: Pose3D((1, 2)),
        lambda: Pose3D.from_rpy((0, 0, 0), (1, 2)),
        lambda: Pose3D.from_matrix(RAGGED),
        lambda: Pose3D.from_matrix([[1, 2], [3, 4]]),
        lambda: OccupancyGrid(RAGGED, 0.05),
        lambda: OccupancyGrid([[0]], "a"),
        lambda: OccupancyGrid([[0]], 0.05, RAGGED),
        lambda: Costmap(RAGGED, 0.05, Pose2D(0, 0), CARTER.outline, 0.5),
        lambda: Costmap.from_grid(GRID, RAGGED),
        lambda: COSTMAP.cost_at(RAGGED, RAGGED),
        lambda: OccupancyGrid.from_world(World.from_map(GRID), bounds=RAGGED),
        lambda: OccupancyGrid.from_world(World.from_map(GRID), seeds=RAGGED),
        lambda: OccupancyGrid.from_world(World.from_map(GRID), seeds=[(1, 2, 3)]),
        lambda: Mesh(RAGGED, RAGGED),
        lambda: OccupancyCells(RAGGED, 0.05, 1.0),
        lambda: Scan("front", 0.0, Pose2D(0, 0), 0.4, RAGGED, [1.0], 0.1, 10.0),
        lambda: Trajectory(*[RAGGED] * len(Trajectory.columns())),
        lambda: Pose2D("1", "2"),
        lambda: Twist2D(None, 0.0),
    ],
)
def test_ragged_lists_and_text_are_refused_as_input(call):
    with pytest.raises(InputError):
        call()


def test_a_path_that_is_too_long_to_be_checked_is_refused():
    with pytest.raises(InputError, match="too long to be checked"):
        PathCheck(Path([[0, 0, 0], [1e9, 0, 0]]))


HUGE = int("9" * 400)
HUGER = 1 << 40_000
"""Python does not write it in decimals."""


@pytest.mark.parametrize("number", [HUGE, -HUGE, HUGER], ids=["400 digits", "negative", "12,000 digits"])
@pytest.mark.parametrize(
    "take",
    [
        lambda number: Costmap.from_grid(GRID, CARTER, inflation_radius=number),
        lambda number: OccupancyGrid(GRID.data, number),
        lambda number: OccupancyGrid.from_world(World("empty", ()), resolution=number),
        lambda number: Box((1.0, 1.0, number)),
        lambda number: Pose2D(number, 0.0),
        lambda number: Twist2D(0.0, number),
        lambda number: World.generate("warehouse", seed=1, size=(number, 20.0)),
        lambda number: World.generate("warehouse", seed=number),
        lambda number: create_controller("regulated_pure_pursuit", robot=CARTER, lookahead_time=number),
        lambda number: Manual(number, 0.0),
        lambda number: DropBox(1.0, number),
        lambda number: StepOnce(number),
        lambda number: Scenario.make(world="warehouse", goal_yaw_tolerance=number),
        lambda number: Scenario.make(world="warehouse", start=(0.0, 0.0, number)),
        lambda number: Scenario.make(world="warehouse", time_limit_s=number),
    ],
    ids=lambda take: "",
)
def test_an_integer_that_no_float_can_hold_is_refused(take, number):
    with pytest.raises(InputError) as caught:
        take(number)
    assert len(str(caught.value)) < 400


def test_a_directive_with_an_integer_of_400_digits_is_refused_with_its_file(tmp_path):
    file = tmp_path / "directives.json"
    file.write_text(f'{{"directives": [{{"index": 0, "time": {HUGE}, "directive": "pause"}}]}}')
    with pytest.raises(
        InputError, match=r"directives\.json: directive 1: time must be a number of 0 or more s, got 99"
    ):
        load_directives(file)
