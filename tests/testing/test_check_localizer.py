from dataclasses import replace

import numpy as np
import pytest

from trundle.geometry import Pose2D
from trundle.localization import create_localizer, localizer_names
from trundle.localization.odometry import OdometryLocalizer
from trundle.observation import Estimate
from trundle.robots import Robot
from trundle.testing import ConformanceError, check_localizer


@pytest.mark.parametrize("name", localizer_names())
@pytest.mark.parametrize("robot", ["nova_carter", "turtlebot3_burger"])
def test_our_localizers_keep_their_promises(name, robot):
    check_localizer(lambda grid, driven: create_localizer(name, grid, driven), robot=Robot.load(robot))


class WithoutReset:
    def __init__(self, grid, robot):
        pass

    def update(self, observation):
        return Estimate(observation.time, observation.odometry)


class OwnClock(OdometryLocalizer):
    def update(self, observation):
        return replace(super().update(observation), time=0.0)


class OdometryAsMap(OdometryLocalizer):
    """Takes the odom frame for the map frame."""

    def update(self, observation):
        super().update(observation)
        return Estimate(observation.time, observation.odometry)


class WithoutCorrection(OdometryLocalizer):
    """Leaves out T_map_odom."""

    def update(self, observation):
        found = super().update(observation)
        return Estimate(found.time, found.pose)


class Drifting(OdometryLocalizer):
    def update(self, observation):
        found = super().update(observation)
        shift = Pose2D(0.2 * observation.time, 0.0)
        return Estimate(found.time, shift @ found.pose, None, shift @ found.T_map_odom)


class Unseeded(OdometryLocalizer):
    def update(self, observation):
        found = super().update(observation)
        shift = Pose2D(float(np.random.default_rng().normal(0.0, 0.001)), 0.0)
        return Estimate(found.time, shift @ found.pose, None, shift @ found.T_map_odom)


class KeepsAfterReset(OdometryLocalizer):
    """A reset does not forget the noise."""

    noise = None

    def update(self, observation):
        self.noise = self.noise or np.random.default_rng(0)
        found = super().update(observation)
        shift = Pose2D(float(self.noise.normal(0.0, 0.001)), 0.0)
        return Estimate(found.time, shift @ found.pose, None, shift @ found.T_map_odom)


class Shared(OdometryLocalizer):
    """Localizers share where they are."""

    begin = None

    def reset(self, pose, *, seed=0):
        super().reset(pose, seed=seed)
        Shared.begin = None

    def update(self, observation):
        found = super().update(observation)
        Shared.begin = Shared.begin or found.T_map_odom
        return Estimate(found.time, Shared.begin @ observation.odometry, None, Shared.begin)


class Ignorant(OdometryLocalizer):
    """Moves only where there are scans."""

    last = None

    def update(self, observation):
        found = super().update(observation)
        if self.last is None or observation.scans or observation.time == 0.0:
            self.last = found.pose
        pose = self.last
        return Estimate(found.time, pose, None, pose @ observation.odometry.inverse())


class Unsure(OdometryLocalizer):
    def update(self, observation):
        return replace(super().update(observation), covariance=-np.eye(3))


@pytest.mark.parametrize(
    ("localizer", "words"),
    [
        (WithoutReset, r"has no reset\(pose\)"),
        (OwnClock, "an estimate has the time of its observation"),
        (OdometryAsMap, "must stay near the truth"),
        (WithoutCorrection, "pose must be T_map_odom @ odometry"),
        (Drifting, "must stay near the truth"),
        (Unseeded, "the same observations give other estimates"),
        (KeepsAfterReset, "the same observations give other estimates"),
        (Shared, "while another localizer is used"),
        (Ignorant, "must follow the odometry|must stay near"),
        (Unsure, "no negative eigenvalue"),
    ],
)
def test_broken_promises_are_found(localizer, words):
    with pytest.raises(ConformanceError, match=words):
        check_localizer(localizer)


class AnyTime(OdometryLocalizer):
    """Does not look at times."""

    def update(self, observation):
        self._time = None
        return super().update(observation)


def test_a_localizer_need_not_look_at_times():
    check_localizer(AnyTime)
