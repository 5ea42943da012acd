"""`trundle map continue`: a map goes on with another drive."""

from __future__ import annotations

from pathlib import Path

from cyclopts import App

from trundle.cli.map import drives

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
    of_map: drives.MapOptions = drives.MAP_DEFAULTS,
    of_drive: drives.DriveOptions = drives.DRIVE_DEFAULTS,
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

    machine = of_map.load_robot()
    targets = of_map.check(source=posegraph_file)
    graph = load_pose_graph(posegraph_file)
    said: list[str] = []
    facts: dict[str, object] = {}
    known = None
    for number, file in enumerate((recording, *more)):
        drive = of_drive.open(file, machine)
        mapper = Mapper.from_graph(graph, drive.robot, seed=of_drive.seed)
        before = f"{file.name}: " if more else ""
        said += [f"{before}{line}" for line in (*drives.feed(mapper, drive, quiet=of_map.quiet), *drive.remarks.lines)]
        graph = mapper.graph()
        known = drive.robot if drive.knows_robot else known
        suffix = f" {number + 1}" if more else ""
        facts |= {f"{name}{suffix}": value for name, value in drives.describe(drive).items()}
    return drives.write(graph, targets, of_map, robot=known, facts=facts, remarks=said)
