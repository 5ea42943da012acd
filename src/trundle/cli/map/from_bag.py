"""`trundle map from-bag`: a map from a recorded drive."""

from __future__ import annotations

from pathlib import Path

from cyclopts import App

from trundle.cli.map import drives
from trundle.cli.shared import options, sources
from trundle.messages.codec import DEFAULT

app = App(
    name="from-bag",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle map from-bag run.mcap -o map.yaml\n"
        "  trundle map from-bag rosbag2_2026_05_04-10_31_07 --robot my_robot.yaml -o site/map.yaml\n"
        "  trundle map from-bag drive.log.gz -o map.yaml --resolution 0.025 --origin 12.5,3,90deg"
    ),
)


@app.default
def from_bag(
    recording: Path,
    /,
    *,
    out: drives.MapOut = Path("map.yaml"),
    posegraph: drives.GraphOut = None,
    resolution: drives.Resolution = 0.05,
    origin: drives.Origin = None,
    robot: drives.AnyRobot = None,
    scan_topic: drives.ScanTopics = None,
    odom: drives.Odom = None,
    distro: options.Distro = None,
    seed: options.Seed = 0,
    overwrite: drives.Overwrite = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Make a map from a recorded drive: a bag of trundle's, anyone's rosbag2, or a CARMEN log.

    Needed are scans and odometry (/odom or /tf of any name); without odometry the scans are tried alone. The robot need
    not be known. Writes the map, its pose graph, which can be continued, moved and merged, and a picture with the path
    and the loops. The map is checked at the end. Exits with 1 if that finds an error, or a part of the drive is not in
    the map.

    Args:
        recording: A .mcap or .db3 file, the folder of a rosbag2, or a CARMEN log (.log, .clf, .gz).
    """
    from trundle.mapping import Mapper
    from trundle.recordings import open_drive

    drives.check_resolution(resolution)
    machine = sources.load_robot(robot) if robot is not None else None
    if origin is not None:
        options.parse_pose("--origin", origin)
    targets = drives.choose_targets(out, posegraph, overwrite=overwrite)
    drive = open_drive(recording, robot=machine, scan_topics=scan_topic or (), odometry=odom, distro=distro or DEFAULT)
    mapper = Mapper(drive.robot, seed=seed)
    said = drives.feed(mapper, drive, quiet=quiet)
    return drives.write(
        drives.move(mapper.graph(), origin),
        targets,
        resolution=resolution,
        robot=drive.robot if drive.knows_robot else None,
        facts=drives.describe(drive),
        remarks=[*said, *drive.remarks.lines],
        json=json,
        quiet=quiet,
    )
