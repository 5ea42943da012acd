"""Tests of what a robot's software takes the robot for."""

import numpy as np
import pytest

from trundle.errors import InputError
from trundle.mission import Scenario
from trundle.mission.fields import Assumed
from trundle.mission.setup import make_place
from trundle.robots import Robot

WIDE = ((0.4, 0.4), (-0.7, 0.4), (-0.7, -0.4), (0.4, -0.4))


def make(**changes) -> Scenario:
    place = {"world": {"name": "warehouse", "seed": 3}, "start": (-12.0, 0.0, 0.0), "goal": (-9.0, 0.0)}
    return Scenario.make(**place, backend="kinematic", **changes)


def test_the_outline_is_that_of_the_software_and_the_simulated_robot_keeps_its_own():
    setting = make(assumed={"footprint": WIDE}).prepare()
    own = Robot.load("nova_carter")
    assert sorted(map(tuple, setting.navigator.robot.outline.tolist())) == sorted(WIDE)
    assert setting.navigator.costmap.inscribed_radius == pytest.approx(0.4)
    assert setting.robot == own
    np.testing.assert_array_equal(setting.robot.outline, own.outline)


def test_lower_limits_hold_and_higher_ones_leave_the_robots():
    own = Robot.load("nova_carter")
    limits = Assumed.model_validate({"limits": {"linear_speed": 0.3, "angular_speed": 9.0}}).of(own).limits
    assert limits.linear_speed == 0.3
    assert limits.angular_speed == own.limits.angular_speed
    assert limits.reverse_speed == own.limits.linear_speed, "the reverse speed is not lowered with the forward speed"


def test_a_run_keeps_to_the_assumed_speed_and_repeats_from_its_file(tmp_path):
    scenario = make(assumed={"limits": {"linear_speed": 0.3, "reverse_speed": 0.3}})
    with scenario.build() as mission:
        episode = mission.run()
        mission.scenario.save(tmp_path / "scenario.yaml")
    assert episode.arrived
    assert 0.25 < np.abs(episode.trajectory.v).max() <= 0.3 + 1e-9
    with Scenario.load(tmp_path / "scenario.yaml").build() as again:
        np.testing.assert_array_equal(again.run().trajectory.poses, episode.trajectory.poses)


def test_what_is_measured_is_measured_on_the_simulated_robot():
    with make().build() as mission, make(assumed={"footprint": WIDE}).build() as cautious:
        plain, wide = mission.session(), cautious.session()
        assert wide.info.robot == plain.info.robot
        plain.finish()
        wide.finish()


def test_scenarios_that_differ_in_it_share_their_place():
    from trundle.mission.setup import place_key

    plain, wide = make(), make(assumed={"footprint": WIDE})
    assert place_key(plain) == place_key(wide)
    place = make_place(plain)
    assert wide.prepare(place).navigator.costmap.inscribed_radius == pytest.approx(0.4)


@pytest.mark.parametrize(
    ("assumed", "text"),
    [
        ({"footprint": [[0.1, 0.1], [0.2, 0.1]]}, "3 to 64"),
        ({"footprint": [[1.0, 0.1], [2.0, 0.1], [1.5, 0.4]]}, "base_link"),
        ({"limits": {"linear_speed": 0.0}}, "above 0"),
        ({"speed": 1.0}, "unknown key"),
    ],
)
def test_what_cannot_be_assumed_is_refused(assumed, text):
    with pytest.raises(InputError, match=text):
        make(assumed=assumed)
