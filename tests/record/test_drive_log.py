from pathlib import Path

from trundle.geometry import Pose2D, Twist2D
from trundle.record.drive_log import DriveLog
from trundle.robots import WheelSpeeds
from trundle.sim import Contact, RobotState


def state(time: float, *touched: str) -> RobotState:
    contacts = tuple(Contact("chassis", name, 0.0, 0.0) for name in touched)
    still = WheelSpeeds(0.0, 0.0)
    return RobotState(time, Pose2D(0.0, 0.0), Twist2D(), still, still, Pose2D(0.0, 0.0), contacts)


def test_every_contact_of_every_period_is_kept(tmp_path: Path) -> None:
    log = DriveLog()
    log.add(state(0.0))
    log.begin(0.5, 0.0, 0.1)
    log.add(state(0.05, "wall", "post"))
    log.add(state(0.1, "rack"))
    assert log.legs()[0]["contacts"] == ["post", "rack", "wall"]
    log.save(tmp_path / "drive.csv")
    rows = (tmp_path / "drive.csv").read_text().splitlines()
    assert [row.rpartition(",")[2] for row in rows[1:]] == ["", "post wall", "rack"]
