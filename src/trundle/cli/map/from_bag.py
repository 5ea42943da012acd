"""`trundle map from-bag`: a map from a recorded drive."""

from __future__ import annotations

from pathlib import Path

from cyclopts import App

from trundle.cli.map import drives

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
    of_map: drives.MapOptions = drives.MAP_DEFAULTS,
    of_drive: drives.DriveOptions = drives.DRIVE_DEFAULTS,
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

    machine = of_map.load_robot()
    targets = of_map.check()
    drive = of_drive.open(recording, machine)
    mapper = Mapper(drive.robot, seed=of_drive.seed)
    said = drives.feed(mapper, drive, quiet=of_map.quiet)
    return drives.write(
        mapper.graph(),
        targets,
        of_map,
        robot=drive.robot if drive.knows_robot else None,
        facts=drives.describe(drive),
        remarks=[*said, *drive.remarks.lines],
    )
