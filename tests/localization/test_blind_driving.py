"""Localizers that find a robot by scans say so where none arrive: `BlindDriving`."""

import warnings

import numpy as np
import pytest

from trundle.errors import InputError, SensorWarning
from trundle.evaluation import Suite
from trundle.geometry import Pose2D, Twist2D
from trundle.localization import create_localizer
from trundle.maps import OCCUPIED, OccupancyGrid
from trundle.mission import Scenario
from trundle.observation import Observation, Scan
from trundle.robots import Robot
from trundle.robots.file_format import describe_robot

START = Pose2D(2.0, 2.0)
WALLED = OccupancyGrid(np.pad(np.zeros((80, 80), np.int8), 1, constant_values=OCCUPIED), 0.05)
ROBOT = Robot.load("nova_carter")


def make(name, robot=ROBOT):
    localizer = create_localizer(name, WALLED, robot)
    localizer.reset(START)
    return localizer


def seen(step, *, speed=0.0, turning=0.0, scans=()):
    time = 0.1 * step
    return Observation(time, Twist2D(speed, turning), Pose2D(speed * time, 0.0, turning * time), scans)


def scan(time):
    angles = np.linspace(-1.5, 1.5, 60)
    return Scan(next(iter(ROBOT.lidars)), time, Pose2D(0.0, 0.0), 0.4, angles, 2.0 / np.cos(angles), 0.05, 40.0)


@pytest.mark.parametrize("name", ["amcl", "slam"])
@pytest.mark.parametrize("motion", [{"speed": 0.3}, {"turning": 0.5}], ids=["ahead", "turning"])
def test_a_robot_that_drives_without_scans_is_lost_after_two_seconds_with_one_warning(name, motion):
    localizer = make(name)
    with pytest.warns(SensorWarning, match=f"localizer '{name}' has got no scan for 2.1 s") as caught:
        found = [localizer.update(seen(step, **motion)) for step in range(60)]
    assert [one.state for one in found] == 21 * ["localized"] + 39 * ["lost"]
    assert len(caught) == 1
    assert caught[0].filename == __file__
    assert found[-1].covariance[0, 0] >= 1.0 > found[20].covariance[0, 0]
    assert found[-1].pose.distance_to(START @ seen(59, **motion).odometry) < 0.02


@pytest.mark.parametrize("name", ["amcl", "slam"])
def test_a_robot_that_stands_without_scans_stays_where_it_is(name):
    localizer = make(name)
    assert {localizer.update(seen(step)).state for step in range(100)} == {"localized"}


def test_a_scan_ends_it_and_a_new_run_warns_again():
    localizer = make("slam")
    for _ in range(2):
        localizer.reset(START)
        with pytest.warns(SensorWarning, match="no scan"):
            states = [localizer.update(seen(step, speed=0.3)).state for step in range(40)]
        assert states[-1] == "lost"
    assert localizer.update(seen(40, speed=0.3, scans=(scan(4.0),))).state == "localized"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert [localizer.update(seen(step, speed=0.3)).state for step in (50, 61)] == ["localized", "lost"]


def test_a_slow_lidar_is_waited_for():
    slow = {name: lidar.model_copy(update={"rate": 0.5}) for name, lidar in ROBOT.lidars.items()}
    localizer = make("amcl", ROBOT.model_copy(update={"lidars": slow}))
    assert {localizer.update(seen(step, speed=0.3)).state for step in range(40)} == {"localized"}


@pytest.fixture
def blind_robot(tmp_path):
    """The file of a robot without lidars."""
    file = tmp_path / "blind.yaml"
    file.write_text(describe_robot(ROBOT.model_copy(update={"lidars": {}})))
    return str(file)


NO_LIDARS = r"localizer (amcl|slam) .* lidars, and nova_carter has none: give a robot with lidars"


@pytest.mark.parametrize("name", ["amcl", "slam"])
def test_a_mission_of_a_robot_without_lidars_is_refused(name, blind_robot):
    scenario = Scenario.make(world="office", backend="kinematic", robot=blind_robot, lidar=True, localizer=name)
    with scenario.build() as mission, pytest.raises(InputError, match=NO_LIDARS):
        mission.session()


def test_a_suite_with_a_robot_without_lidars_is_refused_before_it_runs(blind_robot):
    robots = ["jackal", blind_robot]
    suite = Suite.make(worlds="office", backends="kinematic", robots=robots, lidar=True, localizer=["odometry", "amcl"])
    with pytest.raises(InputError, match=NO_LIDARS):
        suite.check()


def test_a_suite_that_crosses_localizers_with_no_lidars_is_refused_before_it_runs():
    suite = Suite.make(worlds="office", backends="kinematic", lidar=[True, False], localizer=["odometry", "amcl"])
    with pytest.raises(InputError, match="localizer amcl finds the robot by the scans of its lidars: give lidar: true"):
        suite.check()
