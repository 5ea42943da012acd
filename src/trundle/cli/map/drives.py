"""What the verbs that map recordings share: feeding a mapper, and writing the map, its pose graph and a picture."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from trundle.cli.shared import options, output
from trundle.errors import InputError

if TYPE_CHECKING:
    from trundle.mapping import Mapper, PoseGraph
    from trundle.recordings import RecordedDrive
    from trundle.robots import Robot

MapOut = Annotated[
    Path, Parameter(name=["--out", "-o"], help="The map's YAML, with its image beside it; or a folder for map.yaml.")
]
GraphOut = Annotated[
    Path | None,
    Parameter(name="--posegraph", help="The pose graph that is written; default: beside the map, NAME.posegraph."),
]
Resolution = Annotated[float, Parameter(name="--resolution", help="Cell size [m].")]
Origin = Annotated[
    str | None,
    Parameter(
        name="--origin",
        allow_leading_hyphen=True,
        metavar="X,Y[,YAW]",
        help="Where the pose graph's origin, which is where its first drive began, lies in the map [m, m, rad or "
        "90deg]; default: 0,0.",
    ),
]
AnyRobot = Annotated[
    str | None,
    Parameter(
        name="--robot",
        help=f"The robot, whose outline is left out of the scans, and which must fit through the doors: "
        f"{options.ROBOT_CHOICES}; default: the recording's own, or unknown.",
    ),
]
ScanTopics = Annotated[
    list[str] | None,
    Parameter(
        name="--scan-topic",
        negative="",
        metavar="TOPIC",
        help="A bag's topic of scans; repeatable; default: one of each lidar.",
    ),
]
Odom = Annotated[
    str | None,
    Parameter(
        name="--odom",
        metavar="TOPIC|tf|none",
        help="A bag's topic of the odometry; tf for the transforms, none for the scans alone; default: the usual one, "
        "else the transforms, else the scans.",
    ),
]
Overwrite = Annotated[
    bool,
    Parameter(
        name="--overwrite",
        negative="",
        help="Replace a map even if it was edited, and a pose graph that other drives may have made.",
    ),
]

_MOST_FINDINGS = 8


@dataclass(frozen=True, slots=True)
class Targets:
    """What is written.

    Attributes:
        map_file: The map's YAML.
        graph: The pose graph.
        picture: The picture of the drive.
    """

    map_file: Path
    graph: Path
    picture: Path


def choose_targets(out: Path, graph: Path | None, *, overwrite: bool, source: Path | None = None) -> Targets:
    """Return what is to be written, before any work is done.

    Args:
        out: What -o says.
        graph: What --posegraph says.
        overwrite: Replace what is there.
        source: The pose graph that is continued, which may be replaced: all of it is in the new one.

    Raises:
        InputError: If a file is there that is not replaced.
        OutputError: If the folder cannot be written to.
    """
    map_file = options.output_file(out, "map.yaml", (".yaml", ".yml"))
    target = map_file.with_suffix(".posegraph") if graph is None else graph
    target = options.output_file(target, "map.posegraph", (".posegraph",))
    if not overwrite:
        options.check_map_replaceable(map_file)
        if target.exists() and not (source is not None and target.samefile(source)):
            raise InputError(
                f"{target} already exists: continue it with trundle map continue, give another file with --posegraph, "
                "or replace it with --overwrite"
            )
    return Targets(map_file, target, map_file.with_name(f"{map_file.stem}_drive.png"))


def check_resolution(resolution: float) -> None:
    """Refuse cells that no map has.

    Raises:
        InputError: If it is not from 0.005 to 1 m.
    """
    if not 0.005 <= resolution <= 1.0:
        raise InputError(f"--resolution {resolution:g}: give a cell size from 0.005 to 1 m")


def feed(mapper: Mapper, drive: RecordedDrive, *, quiet: bool) -> list[str]:
    """Give a mapper a whole drive; return what there is to say about how it went.

    Raises:
        InputError: If the recording is damaged on the way, or its scans do not suffice without odometry.
    """
    from trundle.record.progress import ProgressBar
    from trundle.recordings.scan_odometry import ScanOdometry

    follower = ScanOdometry(drive.robot) if drive.odometry is None else None
    said: list[str] = []
    with ProgressBar(quiet=quiet, plain=True) as bar, _nothing_left(quiet=quiet):
        for step in drive.steps():
            if step.begins_part:
                mapper.new_part()
            observation = step.observation if follower is None else follower.follow(step.observation)
            if observation is not None:
                mapper.update(observation)
            if step.observation.scans:
                bar.report("mapping", round(1000 * step.share), 1000)
        if follower is not None:
            said.append(follower.check())
        mapper.finish()
    return said


@contextlib.contextmanager
def _nothing_left(*, quiet: bool) -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt:
        output.remark("stopped: nothing was written", quiet=quiet)
        raise


def describe(drive: RecordedDrive) -> dict[str, object]:
    """Return what a recording is, for people and for machines."""
    return {
        "recording": drive.path,
        "robot": drive.robot.name if drive.knows_robot else "unknown",
        "lidars": ", ".join(drive.lidars),
        "odometry": drive.odometry or "none",
        "duration": f"{drive.duration_s:.1f} s, {drive.scans} scans",
    }


def move(graph: PoseGraph, origin: str | None) -> PoseGraph:
    """Return a pose graph where --origin puts it."""
    from trundle.mapping import move_pose_graph

    return graph if origin is None else move_pose_graph(graph, options.parse_pose("--origin", origin))


def write(
    graph: PoseGraph,
    targets: Targets,
    *,
    resolution: float,
    robot: Robot | None,
    facts: dict[str, object],
    remarks: list[str],
    json: bool,
    quiet: bool,
) -> int:
    """Draw the map of a pose graph, check it, write everything, and say what a person should look at.

    Everything is made before anything is written; each file is written whole or not at all.

    Args:
        graph: The graph.
        targets: What is written.
        resolution: Cell size [m].
        robot: The robot that must fit through the doors; None where it is unknown.
        facts: What is printed before.
        remarks: What was left out of recordings, and why.
        json: Print one JSON value.
        quiet: No remarks.

    Returns:
        The exit code: 0, or 1 if the map has errors, or a part is not in it.
    """
    from trundle.files.writing import atomic_path
    from trundle.mapping import draw_map, save_pose_graph
    from trundle.mapping.corrections import find_corrections, joined_nodes
    from trundle.maps.check import check_map
    from trundle.record.map_report_lines import tell_report
    from trundle.record.mapping_picture import choose_corrections, draw_drive, drive_length, tell

    if not len(graph.scan_nodes):
        raise InputError(f"there is no scan to make a map of: {'; '.join(remarks) or 'the pose graph is empty'}")
    grid = draw_map(graph, resolution=resolution)
    picture = draw_drive(grid, graph, title=targets.map_file.name)
    save_pose_graph(graph, targets.graph)
    grid.save(targets.map_file)
    with atomic_path(targets.picture) as temporary:
        picture.save(temporary)
    report = check_map(targets.map_file, robot=robot, start=_first_pose(graph, robot))
    joined = joined_nodes(graph)
    corrections = [one for one in find_corrections(graph) if joined[one.second]]
    named = choose_corrections(graph, corrections)
    apart = sorted({int(part) + 1 for part in graph.parts[~joined]})
    code = 1 if report.has_errors or apart else 0
    rows, cols = grid.shape
    numbers: dict[str, object] = {
        **facts,
        "map": targets.map_file,
        "posegraph": targets.graph,
        "picture": targets.picture,
        "width_m": cols * grid.resolution,
        "height_m": rows * grid.resolution,
        "resolution_m": grid.resolution,
        "origin": grid.origin.as_tuple(),
        "driven_m": drive_length(graph),
        "poses": len(graph.times),
        "scans": len(graph.scan_nodes),
        "loops": len(corrections),
        "parts": len(set(graph.parts.tolist())),
        "parts_not_in_map": apart,
    }
    if json:
        output.print_json({**numbers, "corrections": named, "remarks": remarks, "findings": report.findings})
        return code
    output.print_facts(
        {
            **facts,
            "driven": f"{drive_length(graph):.1f} m, {len(graph.times)} poses, {len(corrections)} loops",
            "size": f"{cols * grid.resolution:.2f} x {rows * grid.resolution:.2f} m ({cols} x {rows} cells of "
            f"{grid.resolution:g} m)",
            "map": targets.map_file,
            "to continue": targets.graph,
            "picture": targets.picture,
        }
    )
    for one in named:
        print(f"loop {tell(graph, one)}")
    if apart:
        _say_apart(graph, apart, targets)
    for line in remarks:
        output.remark(f"trundle: {line}", quiet=quiet)
    for line in tell_report("map check", report, None, most=_MOST_FINDINGS):
        print(line)
    _say_what_to_look_at(targets, bool(named), quiet=quiet)
    return code


def _first_pose(graph: PoseGraph, robot: Robot | None) -> tuple[float, float, float] | None:
    x, y, yaw = graph.poses[0].tolist()
    return None if robot is None else (x, y, yaw)


def _say_apart(graph: PoseGraph, apart: list[int], targets: Targets) -> None:
    names = ", ".join(map(str, apart))
    seen = "part" if len(apart) == 1 else "parts"
    print(
        f"not in the map: {seen} {names} of {len(set(graph.parts.tolist()))}: nothing seen there ties it to part 1 "
        f"yet. It is in {targets.graph}: a drive from one to the other, with trundle map continue, joins it"
    )


def _say_what_to_look_at(targets: Targets, named: bool, *, quiet: bool) -> None:
    loops = "the numbered loops: walls there must be single" if named else "walls that are double or bent"
    output.remark(f"look at {targets.picture}: {loops}; straight corridors must be straight", quiet=quiet)
