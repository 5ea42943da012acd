"""Policies in ONNX files as agents."""

import itertools
import math
import subprocess
import sys

import numpy as np
import pytest

from support.policies import GOAL_SEEKER, write_path_follower, write_policy
from trundle.control import GoalChecker
from trundle.costmap import CostmapSettings
from trundle.errors import InputError
from trundle.geometry import Goal, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation import NavigationStatus, Navigator, create_agent
from trundle.observation import Estimate, Observation, Scan
from trundle.robots import Robot
from trundle.sim.ramp import count_steps
from trundle.testing import check_agent

pytest.importorskip("onnx", reason="makes policies with onnx, of the development tools")
pytest.importorskip("onnxruntime", reason="needs onnxruntime, of the extra policy")

ROBOT = Robot.load("nova_carter")
HERE = Pose2D(0.0, 0.0)


def scan_of(ranges, *, lidar="front", time=0.0):
    angles = np.linspace(-math.pi, math.pi, len(ranges), endpoint=False)
    return Scan(lidar, time, Pose2D(0.026, 0.0, math.pi), 0.4, angles, np.asarray(ranges, float), 0.05, 12.0)


def drive(agent, time, *, pose=HERE, twist=Twist2D(), scans=None):
    seen = (scan_of(np.full(72, np.inf), time=time),) if scans is None else scans
    return agent.update(Observation(time, twist, pose, seen), Estimate(time, pose))


@pytest.fixture
def policy(tmp_path):
    return write_policy(tmp_path / "policy.onnx")


@pytest.mark.parametrize("memory", [False, True])
def test_a_policy_passes_the_check_of_agents(tmp_path, memory):
    check_agent(str(write_policy(tmp_path / "policy.onnx", memory=memory)))


def test_the_agent_navigator_passes_it_too():
    check_agent("navigator")


def test_actions_are_scaled_and_cut_off(policy):
    agent = create_agent(str(policy), ROBOT)
    agent.set_goal(Goal(0.0, 5.0))
    turn = drive(agent, 0.0)
    assert (turn.v, turn.w) == pytest.approx((0.0, 0.7), abs=1e-6)
    double = write_policy(policy, {**GOAL_SEEKER, "normalisation": '{"goal": [0.0, 0.5]}', "offset": "0.1,0.0"})
    agent = create_agent(str(double), ROBOT)
    agent.set_goal(Goal(5.0, 0.0))
    assert drive(agent, 0.0).v == pytest.approx(0.6)


def test_an_action_is_held_for_the_period_of_the_policy(policy):
    agent = create_agent(str(policy), ROBOT)
    agent.set_goal(Goal(5.0, 0.0))
    first = drive(agent, 0.0)
    turned = Pose2D(0.0, 0.0, 1.0)
    assert all(drive(agent, step * 0.05, pose=turned) == first for step in (1, 2, 3))
    second = drive(agent, 0.2, pose=turned)
    assert (second.v, second.w) == pytest.approx((0.5 * math.cos(1.0), -0.7 * math.sin(1.0)))


@pytest.mark.parametrize(
    ("period", "tick"),
    [(0.2, 0.05), (0.05, 0.05), (0.12, 0.04), (0.035, 0.035), (0.005, 0.005), (0.033, 0.005), (1 / 30, 0.005)],
)
def test_control_periods_are_physics_steps_that_divide_the_period_of_the_policy(tmp_path, period, tick):
    agent = create_agent(str(write_policy(tmp_path / "p.onnx", {**GOAL_SEEKER, "period": repr(period)})), ROBOT)
    assert agent.dt == pytest.approx(tick)
    assert count_steps(agent.dt, 0.005) == round(tick / 0.005)
    agent.set_goal(Goal(50.0, 0.0))
    poses = [Pose2D(0.0, 0.0, 0.001 * step) for step in range(round(3.0 / tick))]
    commands = [drive(agent, step * agent.dt, pose=pose) for step, pose in enumerate(poses)]
    changes = sum(one != other for one, other in itertools.pairwise(commands))
    assert changes == pytest.approx(3.0 / period, abs=1.01)


def test_reset_zeroes_the_recurrent_state(tmp_path):
    agent = create_agent(str(write_policy(tmp_path / "policy.onnx", memory=True)), ROBOT)
    for _ in range(2):
        agent.reset()
        agent.set_goal(Goal(5.0, 0.0))
        assert [drive(agent, step * 0.2).v for step in range(3)] == pytest.approx([0.5, 0.45, 0.4])


def test_a_policy_sees_the_beam_nearest_to_each_of_its_own(tmp_path):
    beams = np.arange(72, dtype=float) / 10.0
    beams[::2][5] = np.nan
    agent = create_agent(str(write_policy(tmp_path / "policy.onnx")), ROBOT)
    agent.set_goal(Goal(5.0, 0.0))
    drive(agent, 0.0, scans=(scan_of(beams),))
    seen = agent._ranges("front")
    expected = np.clip(beams[::2], 0.05, 12.0)
    expected[5] = 12.0
    np.testing.assert_allclose(seen, expected, rtol=1e-6)


def test_it_stops_in_the_tolerance_of_the_missions_goal_checker(policy):
    agent = create_agent(str(policy), ROBOT)
    agent.goal_checker = GoalChecker(xy_tolerance=1.0)
    agent.set_goal(Goal(5.0, 0.0))
    near = Pose2D(4.1, 0.0)
    assert drive(agent, 0.0, pose=near, twist=Twist2D(0.3, 0.0)) == Twist2D()
    assert agent.status is NavigationStatus.DRIVING
    drive(agent, 0.05, pose=near)
    assert agent.status is NavigationStatus.ARRIVED


def test_it_turns_to_the_yaw_of_a_goal_once_it_stands(policy):
    agent = create_agent(str(policy), ROBOT)
    agent.set_goal(Goal(5.0, 0.0, 1.5))
    at = Pose2D(5.0, 0.1, 0.0)
    assert drive(agent, 0.0, pose=at, twist=Twist2D(0.3, 0.0)) == Twist2D()
    assert drive(agent, 0.05, pose=at) == Twist2D(0.0, 0.7)
    drive(agent, 0.1, pose=Pose2D(5.0, 0.1, 1.45))
    assert agent.status is NavigationStatus.ARRIVED


def test_its_speed_lets_it_stop_at_the_goal(policy):
    agent = create_agent(str(policy), ROBOT)
    agent.goal_checker = GoalChecker(xy_tolerance=0.0)
    agent.set_goal(Goal(0.02, 0.0))
    assert drive(agent, 0.0).v == pytest.approx(math.sqrt(2 * 2.5 * 0.02))


def test_without_scans_it_is_stuck_and_says_why(policy):
    agent = create_agent(str(policy), ROBOT)
    agent.set_goal(Goal(5.0, 0.0))
    assert drive(agent, 0.0, scans=()) == Twist2D()
    drive(agent, 2.5, scans=())
    assert agent.report().status is NavigationStatus.STUCK
    assert "give lidar: true" in agent.report().message


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"observations": None}, "its metadata lack trundle.observations"),
        ({"period": None}, "its metadata lack trundle.period"),
        ({"observations": "ranges,goal,critic"}, "a robot cannot observe 'critic'"),
        ({"observations": "goal,velocity"}, "the input 'ranges' is in neither"),
        ({"beams": "180"}, r"shape \(1, 36\), and the observation \(1, 180\)"),
        ({"beams": "-3"}, "trundle.beams is '-3': it must be a whole number"),
        ({"period": "nan"}, "trundle.period is 'nan': it must be from 0.005"),
        ({"period": "0.001"}, "trundle.period is '0.001': it must be from 0.005"),
        ({"scale": "1.0"}, "trundle.scale is '1.0': it must be two numbers"),
        ({"lidars": "front,back"}, "correct the metadata"),
        ({"lidars": "top"}, "observes the lidar 'top'; nova_carter has: front, back"),
        ({"states": "memory=memory_next"}, "trundle.states names the output 'memory_next'"),
        ({"states": "ranges"}, "trundle.states is 'ranges'"),
        ({"normalisation": '{"ranges": [0, 0]}'}, "scale above 0"),
        ({"normalisation": '{"ranges": [[0, 1], 1]}'}, "has 2 numbers for 'ranges'"),
        ({"normalisation": "[1"}, "trundle.normalisation is"),
        ({"normalisation": '{"odour": [0, 1]}'}, "for 'odour'"),
    ],
)
def test_wrong_metadata_are_refused_by_key(tmp_path, changes, message):
    metadata = {key: text for key, text in {**GOAL_SEEKER, **changes}.items() if text is not None}
    file = write_policy(tmp_path / "policy.onnx", metadata)
    with pytest.raises(InputError, match=message) as raised:
        create_agent(str(file), ROBOT)
    assert str(file) in str(raised.value)


def test_what_is_no_policy_is_refused(tmp_path):
    (tmp_path / "text.onnx").write_text("no model")
    with pytest.raises(InputError, match=r"text\.onnx: this is no ONNX model"):
        create_agent(str(tmp_path / "text.onnx"), ROBOT)
    with pytest.raises(InputError, match="no such file"):
        create_agent(str(tmp_path / "missing.onnx"), ROBOT)
    (tmp_path / "folder.onnx").mkdir()
    with pytest.raises(InputError, match="cannot read"):
        create_agent(str(tmp_path / "folder.onnx"), ROBOT)
    with pytest.raises(InputError, match="needs a lidar"):
        create_agent(str(write_policy(tmp_path / "p.onnx")), ROBOT.model_copy(update={"lidars": {}}))


def test_an_action_that_is_no_number_is_an_error(tmp_path):
    file = write_policy(tmp_path / "policy.onnx", weight=math.nan)
    agent = create_agent(str(file), ROBOT)
    agent.set_goal(Goal(5.0, 0.0))
    with pytest.raises(InputError, match="actions must be finite"):
        drive(agent, 0.0)


def walled_room():
    """A room of 10 m with a wall across, open at its upper end."""
    cells = np.pad(np.zeros((200, 200), np.int8), 2, constant_values=100)
    cells[:140, 100:104] = 100
    return OccupancyGrid(cells, 0.05, Pose2D(-5.1, -5.1))


def test_a_policy_observes_the_planners_path_every_half_metre_and_from_where_the_robot_is(tmp_path):
    grid = walled_room()
    navigator = Navigator(grid, ROBOT)
    file = str(write_path_follower(tmp_path / "path.onnx", points=60))
    agent = create_agent(file, ROBOT, grid, navigator=navigator)
    start, goal = Pose2D(-3.0, 0.0, 0.5), Goal(3.0, 0.0)
    agent.set_goal(goal)
    drive(agent, 0.0, pose=start)
    planned = navigator.plan_between(start, goal)
    planned_path = agent.report().path
    assert planned_path.length == pytest.approx(planned.length)
    seen = start.transform_points(agent._path_ahead(start).astype(float))
    steps = np.hypot(*np.diff(np.vstack([(start.x, start.y), seen]), axis=0).T)
    assert steps.max() < 0.5 + 0.03
    assert seen[-1] == pytest.approx((3.0, 0.0), abs=0.02)
    assert seen[:, 1].max() > 2.2  # around the wall
    # Half a second later nothing is planned again; the points begin where the robot is.
    along = agent._followed.check
    at = int(along.along.searchsorted(1.0))
    there = Pose2D(*along.poses[at])
    drive(agent, 0.6, pose=there)
    report = agent.report()
    assert report.path is planned_path
    assert report.distance_remaining == pytest.approx(planned.length - 1.0, abs=0.05)
    assert math.hypot(*agent._path_ahead(there)[0]) == pytest.approx(0.5, abs=0.03)


def test_a_policy_drives_along_the_planners_path_to_the_goal(tmp_path):
    grid = walled_room()
    agent = create_agent(
        str(write_path_follower(tmp_path / "path.onnx")), ROBOT, grid, navigator=Navigator(grid, ROBOT)
    )
    pose, goal, time = Pose2D(-3.0, 0.0, 1.5), Goal(3.0, 0.0), 0.0
    agent.set_goal(goal)
    while agent.status is NavigationStatus.DRIVING and time < 120.0:
        command = drive(agent, time, pose=pose, twist=Twist2D())
        pose = pose @ Pose2D(command.v * 0.05, 0.0, command.w * 0.05)
        time += 0.05
    assert agent.status is NavigationStatus.ARRIVED
    assert goal.distance_to(pose) < 0.3


def test_without_a_path_the_policy_ends_with_the_planners_reason(tmp_path):
    grid = walled_room()
    agent = create_agent(
        str(write_path_follower(tmp_path / "path.onnx")), ROBOT, grid, navigator=Navigator(grid, ROBOT)
    )
    agent.set_goal(Goal(30.0, 0.0))
    assert drive(agent, 0.0) == Twist2D()
    assert agent.report().status is NavigationStatus.NO_PATH
    assert agent.report().error is not None
    agent.set_goal(Goal(-3.0, 0.0))
    assert drive(agent, 0.1, pose=Pose2D(-4.0, -3.0)) != Twist2D()


def test_a_policy_that_needs_a_path_is_refused_without_a_map_and_with_other_shapes(tmp_path):
    file = write_path_follower(tmp_path / "path.onnx")
    agent = create_agent(str(file), ROBOT)
    agent.set_goal(Goal(3.0, 0.0))
    assert drive(agent, 0.0) == Twist2D()
    assert agent.report().status is NavigationStatus.STUCK
    assert "there is no map to plan it on" in agent.report().message
    with pytest.raises(InputError, match="use it in a scenario whose map is known"):
        create_agent(str(file), ROBOT, navigator=Navigator(None, ROBOT, costmap=CostmapSettings()))
    wrong = write_policy(
        tmp_path / "wrong.onnx", {**GOAL_SEEKER, "observations": "ranges,goal,path", "path_points": "3"}
    )
    with pytest.raises(InputError, match="the metadata name the input 'path'"):
        create_agent(str(wrong), ROBOT)


def test_without_onnxruntime_the_error_has_the_install_line(policy):
    code = (
        "import sys; sys.modules['onnxruntime'] = None\n"
        "from trundle.navigation import create_agent; from trundle.robots import Robot\n"
        f"create_agent({str(policy)!r}, Robot.load('nova_carter'))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    last = done.stderr.strip().splitlines()[-1]
    assert "MissingExtraError" in last
    assert "[policy]" in last
