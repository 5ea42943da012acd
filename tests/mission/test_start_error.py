import math
from typing import ClassVar

import numpy as np
import pytest

from trundle.errors import InputError
from trundle.geometry import Pose2D, wrap_angle
from trundle.mission import Outcome, Scenario
from trundle.mission.fields import StartError
from trundle.observation import Estimate

START = Pose2D(2.0, -1.0, 3.0)


def told(seed=0, **error):
    return StartError(**error).draw(START, seed)


def test_the_pose_is_off_by_the_distance_and_the_heading_in_a_direction_by_seed():
    directions, signs = set(), set()
    for seed in range(20):
        pose, _ = told(seed, distance=0.5, heading="10deg")
        assert pose.distance_to(START) == pytest.approx(0.5)
        turn = math.degrees(wrap_angle(pose.yaw - START.yaw))
        assert abs(turn) == pytest.approx(10.0)
        signs.add(round(turn))
        directions.add(round(math.atan2(pose.y - START.y, pose.x - START.x), 3))
    assert signs == {-10, 10}
    assert len(directions) == 20


def test_the_covariance_tells_how_uncertain_the_pose_is():
    _, covariance = told(distance=0.5, heading="10deg")
    np.testing.assert_allclose(np.diag(covariance), [0.125, 0.125, math.radians(10.0) ** 2])
    assert np.count_nonzero(covariance) == 3
    assert (np.linalg.eigvalsh(told(distance=0.5)[1]) > 0.0).all()
    assert told(distance=0.5, covariance=False)[1] is None


def test_without_an_error_the_true_start_is_told_as_exact():
    assert told() == (START, None)


def test_an_unknown_start_is_not_told():
    assert told(unknown=True) == (None, None)
    made = Scenario.make(world="maze", localizer="odometry", start_error="unknown")
    assert made.start_error == StartError(unknown=True)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"distance": -1.0}, "distance"),
        ({"heading": "-10deg"}, "heading"),
        ({"unknown": True, "distance": 1.0}, "give either"),
        ("unknwon", "start_error"),
        ({"distence": 1.0}, "distance"),
    ],
)
def test_errors_that_cannot_be_are_refused(given, message):
    with pytest.raises(InputError, match=message):
        Scenario.make(world="maze", localizer="odometry", start_error=given)


def test_a_start_is_told_to_localizers_alone():
    with pytest.raises(InputError, match="start_error is what a localizer is told of the start"):
        Scenario.make(world="maze", start_error={"distance": 1.0})


class Believing:
    """Estimates what it was told, which all of them keep."""

    told: ClassVar[list] = []

    def reset(self, pose, *, covariance=None, seed=0):
        self.told.append((pose, covariance, seed))
        self.pose = pose or Pose2D(0.0, 0.0)

    def reinitialize_global(self):
        raise NotImplementedError

    def update(self, observation):
        return Estimate(observation.time, self.pose, None, self.pose @ observation.odometry.inverse())


def begin(**settings):
    scenario = Scenario.make(
        world={"name": "maze", "seed": 3}, robot="jackal", backend="kinematic", localizer=Believing, **settings
    )
    with scenario.build() as mission, mission.session() as session:
        session.step()
        return mission, session.finish()


@pytest.mark.parametrize("seed", [2, 5])
def test_a_run_tells_the_localizer_the_wrong_start_and_stands_at_the_true_one(seed):
    error = {"distance": 0.5, "heading": "10deg"}
    mission, episode = begin(start_error=error, seed=seed)
    pose, covariance, told_seed = Believing.told[-1]
    expected = StartError(**error).draw(mission.start, seed)
    assert (pose, told_seed) == (expected[0], seed)
    np.testing.assert_array_equal(covariance, expected[1])
    assert episode.trajectory.poses[0].tolist() == list(mission.start.as_tuple())


def test_a_run_with_an_unknown_start_tells_no_pose():
    begin(start_error="unknown")
    assert Believing.told[-1][:2] == (None, None)


def test_a_drive_by_odometry_from_a_wrong_start_ends_elsewhere(tmp_path):
    settings = {"robot": "jackal", "backend": "kinematic", "localizer": "odometry", "lidar": False, "seed": 4}
    scenario = Scenario.make(world="warehouse", **settings, start_error={"distance": 0.4, "covariance": False})
    with scenario.build() as mission:
        first = mission.run()
    assert first.outcome is not Outcome.ARRIVED
    scenario.save(tmp_path / "scenario.yaml")
    with Scenario.load(tmp_path / "scenario.yaml").build() as mission:
        np.testing.assert_array_equal(mission.run().trajectory.poses, first.trajectory.poses)
    assert first.metrics.position_error_m == pytest.approx(0.4, abs=1e-6)
    assert first.metrics.localization_error_m == pytest.approx(0.4, abs=1e-6)


def test_the_robot_plans_from_where_it_believes_to_stand():
    given = {"world": "maze", "backend": "kinematic", "localizer": "odometry"}
    for error, begins in (({"distance": 0.5}, 0.5), (None, 0.0)):
        with Scenario.make(start_error=error, **given).build() as mission, mission.session() as session:
            session.step()
            believed = mission.navigator.path.start
            assert believed.distance_to(mission.start) == pytest.approx(begins, abs=0.05)
