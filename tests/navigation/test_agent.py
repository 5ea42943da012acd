import numpy as np
import pytest

from trundle.errors import InputError
from trundle.geometry import Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.navigation import Agent, CommandScript, Latency, NavigationStatus, Navigator, create_agent
from trundle.observation import Estimate, Observation
from trundle.robots import Robot

CARTER = Robot.load("nova_carter")
GRID = OccupancyGrid(np.zeros((120, 160), dtype=np.int8), 0.05)
START, GOAL = (1.5, 1.5, 0.0), (6.0, 4.0)


def look(time=0.0, pose=Pose2D(0.0, 0.0), twist=Twist2D()):
    return Observation(time, twist, pose), Estimate(time, pose)


def play(script):
    """(command, dt, index) of every period until the script is finished."""
    played = []
    while True:
        command = script.update(*look())
        if script.status is NavigationStatus.FINISHED:
            return played
        played.append((command, round(script.dt, 9), script.index))


def test_a_script_drives_its_commands_in_order_and_is_finished():
    script = CommandScript([(0.4, 0.0, 0.12), (0.0, 0.8, 0.05)])
    assert script.status is NavigationStatus.IDLE
    ahead, left = Twist2D(0.4, 0.0), Twist2D(0.0, 0.8)
    expected = [(ahead, 0.05, 0), (ahead, 0.05, 0), (ahead, 0.02, 0), (left, 0.05, 1)]
    assert play(script) == expected
    assert script.update(*look()) == Twist2D()
    script.reset(seed=3)
    assert play(script) == expected


def test_a_script_without_commands_is_finished_at_once():
    assert play(CommandScript([])) == []


@pytest.mark.parametrize("command", [(0.4, 0.0), (0.4, 0.0, 0.0), (float("nan"), 0.0, 1.0), (0.4, 0.0, "a"), 3])
def test_bad_commands_are_refused(command):
    with pytest.raises(InputError):
        CommandScript([command])
    with pytest.raises(InputError, match="control period"):
        CommandScript([], period_s=0.0)


def test_navigators_and_scripts_are_agents():
    assert isinstance(Navigator(GRID, CARTER), Agent)
    assert isinstance(CommandScript([]), Agent)


def test_a_navigator_takes_observations_as_it_takes_poses():
    by_pose, by_estimate = Navigator(GRID, CARTER), Navigator(GRID, CARTER)
    pose, twist, goal = Pose2D(*START), Twist2D(), GOAL
    by_pose.set_goal(goal)
    by_estimate.set_goal(goal)
    for tick in range(60):
        command = by_pose.update(pose, twist, time=tick * 0.05)
        assert command == by_estimate.update(*look(tick * 0.05, pose, twist))
        twist = command
        pose = twist.integrate(pose, 0.05)
    assert pose.distance_to(Pose2D(*START)) > 0.2


def test_an_update_is_called_by_the_names_of_what_it_takes():
    navigator = Navigator(GRID, CARTER)
    observation, estimate = look(0.5)
    for given in [
        {"observation": observation, "estimate": estimate},
        {"pose": estimate.pose, "twist": observation.twist, "time": 0.5, "scans": ()},
    ]:
        assert navigator.update(**given) == Twist2D()
    assert navigator.update(observation, estimate=estimate) == Twist2D()
    assert CommandScript([(0.4, 0.0, 1.0)]).update(observation=observation, estimate=estimate) == Twist2D(0.4, 0.0)
    agent = create_agent(lambda observation, estimate: Twist2D(0.1), CARTER)
    assert agent.update(observation=observation, estimate=estimate) == Twist2D(0.1)
    command = navigator.assist_teleop(command=Twist2D(), observation=observation, estimate=estimate)
    assert command.command == Twist2D()


OBSERVATION, ESTIMATE = look()
BOTH_WAYS = "update takes (pose, twist, time=…, scans=…) or (observation, estimate)"


@pytest.mark.parametrize(
    ("positional", "named", "found"),
    [
        ((), {}, "there is neither a pose nor an observation"),
        ((None,), {}, "there is neither a pose nor an observation"),
        ((ESTIMATE, OBSERVATION), {}, "an update's observation must be of type Observation, got Estimate"),
        ((Pose2D(0.0, 0.0), OBSERVATION), {}, "an update's observation must be of type Observation, got Pose2D"),
        ((OBSERVATION, Pose2D(0.0, 0.0)), {}, "an update's estimate must be of type Estimate, got Pose2D"),
        ((OBSERVATION,), {}, "an update's estimate must be of type Estimate, got NoneType"),
        ((), {"observation": OBSERVATION}, "an update's estimate must be of type Estimate, got NoneType"),
        ((), {"estimate": ESTIMATE}, "an update's observation must be of type Observation, got NoneType"),
        (
            (Pose2D(0.0, 0.0),),
            {"observation": OBSERVATION, "estimate": ESTIMATE},
            "there are both a pose and an observation",
        ),
        ((OBSERVATION, Twist2D()), {"estimate": ESTIMATE}, "there are both a twist and an estimate"),
        ((OBSERVATION, ESTIMATE), {"time": 1.0}, "an observation has its own time and scans"),
        ((OBSERVATION, ESTIMATE), {"scans": [1]}, "an observation has its own time and scans"),
    ],
)
def test_an_update_says_what_it_takes(positional, named, found):
    with pytest.raises(InputError) as refused:
        Navigator(GRID, CARTER).update(*positional, **named)
    assert str(refused.value).startswith(found)
    assert str(refused.value).endswith(f"; {BOTH_WAYS}")


def test_latencies_are_short_times():
    assert Latency(scan_age_s=0.1).command_delay_s == 0.0
    with pytest.raises(ValueError, match="command_delay_s"):
        Latency(command_delay_s=3.0)
