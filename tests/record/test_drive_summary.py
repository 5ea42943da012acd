import math

import pytest

from trundle.geometry import Pose2D, Twist2D
from trundle.record.drive_log import DriveSummary
from trundle.robots import WheelSpeeds
from trundle.sim import Contact, RobotState

STILL = WheelSpeeds(0.0, 0.0)


def state(time: float, pose: Pose2D, v: float = 0.0, *touched: str) -> RobotState:
    contacts = tuple(Contact("base", other, 0.0, 0.0) for other in touched)
    return RobotState(time, pose, Twist2D(v, 0.0), STILL, STILL, Pose2D(0.0, 0.0), contacts)


def test_distance_turns_speed_and_contacts_add_up() -> None:
    summary = DriveSummary.from_states(
        [
            state(0.0, Pose2D(0.0, 0.0, 3.0)),
            state(1.0, Pose2D(3.0, 4.0, -3.0), 0.5, "wall"),  # Past ±pi to the left.
            state(2.0, Pose2D(3.0, 4.0, -3.1), -0.8, "wall", "post"),
            state(3.0, Pose2D(3.0, 5.0, -3.1)),
            state(4.0, Pose2D(3.0, 5.0, -3.1), 0.0, "wall"),
        ]
    )
    assert (summary.seconds, summary.distance, summary.top_speed) == (4.0, 6.0, 0.8)
    assert summary.turned_left == pytest.approx(2.0 * math.pi - 6.0)
    assert summary.turned_right == pytest.approx(0.1)
    assert (summary.contacts, summary.touched) == (3, ("post", "wall"))
    assert summary.pose == Pose2D(3.0, 5.0, -3.1)


def test_a_contact_at_the_start_counts() -> None:
    summary = DriveSummary.from_states([state(0.0, Pose2D(0.0, 0.0), 0.0, "wall")])
    assert (summary.distance, summary.contacts) == (0.0, 1)
