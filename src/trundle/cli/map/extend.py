"""`trundle map continue`: a map goes on with another drive."""

from __future__ import annotations

from pathlib import Path

from cyclopts import App

from trundle.cli.map import drives
from trundle.cli.shared import options, sources
from trundle.messages.codec import DEFAULT

app = App(
    name="continue",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle map continue site.posegraph run2.mcap -o site.yaml\n"
        "  trundle map continue site.posegraph hall.mcap yard.mcap -o both.yaml"
    ),
)


@app.default
def extend(
    posegraph_file: Path,
    recording: Path,
    /,
    *more: Path,
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
    """Continue a map with another drive through the same site: it is joined where the robot recognises something.

    Until then the new drive is a part of its own, which is kept in the pose graph and left out of the map. The map
    frame stays. A pose graph is replaced only by one that continues it.

    Args:
        posegraph_file: The .posegraph file that a map was made with.
        recording: As for trundle map from-bag.
        more: Further recordings, in this order.
    """
    from trundle.mapping import Mapper, load_pose_graph
    from trundle.recordings import open_drive

    drives.check_resolution(resolution)
    machine = sources.load_robot(robot) if robot is not None else None
    if origin is not None:
        options.parse_pose("--origin", origin)
    targets = drives.choose_targets(out, posegraph, overwrite=overwrite, source=posegraph_file)
    graph = load_pose_graph(posegraph_file)
    said: list[str] = []
    facts: dict[str, object] = {}
    known = None
    for number, file in enumerate((recording, *more)):
        drive = open_drive(file, robot=machine, scan_topics=scan_topic or (), odometry=odom, distro=distro or DEFAULT)
        mapper = Mapper.from_graph(graph, drive.robot, seed=seed)
        before = f"{file.name}: " if more else ""
        said += [f"{before}{line}" for line in (*drives.feed(mapper, drive, quiet=quiet), *drive.remarks.lines)]
        graph = mapper.graph()
        known = drive.robot if drive.knows_robot else known
        suffix = f" {number + 1}" if more else ""
        facts |= {f"{name}{suffix}": value for name, value in drives.describe(drive).items()}
    return drives.write(
        drives.move(graph, origin),
        targets,
        resolution=resolution,
        robot=known,
        facts=facts,
        remarks=said,
        json=json,
        quiet=quiet,
    )
