"""`open_drive`: which reader a recording needs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from trundle.errors import InputError
from trundle.messages.codec import DEFAULT, Distro
from trundle.recordings.carmen import looks_like_carmen, read_carmen
from trundle.recordings.drive import RecordedDrive
from trundle.robots import Robot
from trundle.values import as_path


def open_drive(
    path: str | os.PathLike[str],
    *,
    robot: Robot | str | None = None,
    scan_topics: Sequence[str] = (),
    odometry: str | None = None,
    distro: Distro = DEFAULT,
) -> RecordedDrive:
    """Open a recorded drive: a bag of ROS, or a CARMEN log.

    Args:
        path: A .mcap, .db3 or .bag file, the folder of a rosbag2, or a CARMEN log (.log, .clf, .gz).
        robot: The robot. By default, it is the recording's own in those of trundle; of another recording the robot is
            unknown, which is enough for a map.
        scan_topics: Topics of a bag whose scans are used. By default, all, and of those of one lidar the usual one.
        odometry: Topic of a bag's odometry; "tf" for the transforms, "none" to go by the scans alone.
        distro: The distribution of which message types are where the bag has no definitions of them: .db3 files.

    Raises:
        InputError: If it is neither, is damaged from the start, or has no scans, or no odometry that can be used.
        MissingExtraError: If a bag is given and rosbags is not installed.
    """
    source = Path(as_path(path, "a recording"))
    machine = Robot.load(robot) if isinstance(robot, str) else robot
    if looks_like_carmen(source) and not source.is_dir():
        if scan_topics or odometry is not None:
            raise InputError(f"{source}: topics of scans and odometry are for bags: a CARMEN log has none")
        return read_carmen(source, robot=machine)
    from trundle.recordings.bag_drive import read_bag_drive

    return read_bag_drive(source, robot=machine, scan_topics=scan_topics, odometry=odometry, distro=distro)
