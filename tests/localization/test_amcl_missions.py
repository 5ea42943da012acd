"""Missions that are driven on estimates of amcl, where something goes wrong: all of them truly arrive."""

import math

import pytest

import trundle
from trundle.mission import PlaceRobot, Steering

ERRORS = {"scale": 0.05, "heading": "5deg"}
WAREHOUSE = {"name": "warehouse", "options": {"low_objects": False}}
SEES = {"noise": 0.02, "dropouts": 0.01, "short_returns": 0.01}


def scenario(**changes):
    settings = {
        "world": {"name": "office", "options": {"low_objects": False}},
        "seed": 5,
        "backend": "kinematic",
        "lidar": True,
        "lidar_errors": SEES,
        "localizer": "amcl",
        "odometry": ERRORS,
    }
    return trundle.Scenario.make(**{**settings, **changes})


def check(episode):
    assert episode.outcome is trundle.Outcome.ARRIVED, episode.message
    assert episode.metrics.contacts == ()
    assert episode.metrics.position_error_m < 0.1
    goal, last = episode.goals[-1], episode.trajectory
    assert math.dist((last.x[-1], last.y[-1]), (goal.x, goal.y)) < 0.25


@pytest.mark.parametrize(
    "changes",
    [
        {"odometry": {**ERRORS, "slips": {"every": 4.0, "distance": 0.3, "heading": "10deg"}}},
        {"start_error": {"distance": 1.0, "heading": "20deg"}},
        {"start_error": {"distance": 1.0, "heading": "20deg", "covariance": False}},
        {"map_errors": {"missing": 0.25, "ghosts": 12}},
        {"world": WAREHOUSE, "seed": 7, "movers": [{"crowd": "person", "count": 8}]},
        {"world": WAREHOUSE, "unmapped": {"boxes": 12}},
    ],
    ids=["wheels slip", "start off by 1 m", "start off, told as exact", "changed map", "crowd", "boxes"],
)
def test_it_arrives(changes):
    with scenario(**changes).build() as mission:
        check(mission.run())


@pytest.mark.filterwarnings("ignore:the estimate was corrected")
def test_a_robot_that_is_carried_away_finds_itself_and_arrives():
    steering, states = Steering(), set()
    with (
        scenario(odometry={"scale": 0.01, "heading": "1deg"}).build() as mission,
        mission.session(steering=steering) as session,
    ):
        while session.time < 6.0:
            session.step()
        steering.put(PlaceRobot(mission.start.x, mission.start.y, mission.start.yaw + 1.0))
        while (step := session.step()) is not None:
            states.add(step.estimate.state)
        check(session.finish())
    assert states != {"localized"}  # it noticed
