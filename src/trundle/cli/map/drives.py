"""What the verbs that map recordings share: options, feeding a mapper, and writing map, pose graph and picture."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from trundle.cli.shared import options, output, sources
from trundle.errors import InputError
from trundle.messages.codec import DEFAULT

if TYPE_CHECKING:
    from trundle.mapping import Mapper, PoseGraph
    from trundle.recordings import RecordedDrive
    from trundle.robots import Robot

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


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class MapOptions:
    """Options of the map that is drawn of a pose graph, and of what is printed."""

    out: Annotated[
        Path,
        Parameter(name=["--out", "-o"], help="The map's YAML, with its image beside it; or a folder for map.yaml."),
    ] = Path("map.yaml")
    posegraph: Annotated[
        Path | None,
        Parameter(name="--posegraph", help="The pose graph that is written; default: beside the map, NAME.posegraph."),
    ] = None
    resolution: Annotated[float, Parameter(name="--resolution", help="Cell size [m].")] = 0.05
    origin: Annotated[
        str | None,
        Parameter(
            name="--origin",
            allow_leading_hyphen=True,
            metavar="X,Y[,YAW]",
            help="Where the pose graph's origin, which is where its first drive began, lies in the map [m, m, rad or "
            "90deg]; default: 0,0.",
        ),
    ] = None
    robot: Annotated[
        str | None,
        Parameter(
            name="--robot",
            help=f"The robot, whose outline is left out of the scans, and which must fit through the doors: "
            f"{options.ROBOT_CHOICES}; default: the recording's own, or unknown.",
        ),
    ] = None
    overwrite: Annotated[
        bool,
        Parameter(
            name="--overwrite",
            negative="",
            help="Replace a map even if it was edited, and a pose graph that other drives may have made.",
        ),
    ] = False
    json: options.Json = False
    quiet: options.Quiet = False

    def load_robot(self) -> Robot | None:
        """Load the robot, if one is given."""
        return None if self.robot is None else sources.load_robot(self.robot)

    def check(self, source: Path | None = None) -> Targets:
        """Check all options, and return what is to be written, before any work is done.

        Args:
            source: The pose graph that is continued, which may be replaced: all of it is in the new one.

        Raises:
            InputError: If an option is wrong, or a file is there that is not replaced.
            OutputError: If the folder cannot be written to.
        """
        if not 0.005 <= self.resolution <= 1.0:
            raise InputError(f"--resolution {self.resolution:g}: give a cell size from 0.005 to 1 m")
        if self.origin is not None:
            from trundle.mapping.merging import check_origin

            check_origin(options.parse_pose("--origin", self.origin))
        map_file = options.output_file(self.out, "map.yaml", (".yaml", ".yml"))
        graph = map_file.with_suffix(".posegraph") if self.posegraph is None else self.posegraph
        graph = options.output_file(graph, "map.posegraph", (".posegraph",))
        if not self.overwrite:
            options.check_map_replaceable(map_file)
            if graph.exists() and not (source is not None and graph.samefile(source)):
                raise InputError(
                    f"{graph} already exists: continue it with trundle map continue, give another file with "
                    "--posegraph, or replace it with --overwrite"
                )
        return Targets(map_file, graph, map_file.with_name(f"{map_file.stem}_drive.png"))


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class DriveOptions:
    """Options of how a recorded drive is read and mapped."""

    scan_topic: Annotated[
        list[str] | None,
        Parameter(
            name="--scan-topic",
            negative="",
            metavar="TOPIC",
            help="A bag's topic of scans; repeatable; default: one of each lidar.",
        ),
    ] = None
    odom: Annotated[
        str | None,
        Parameter(
            name="--odom",
            metavar="TOPIC|tf|none",
            help="A bag's topic of the odometry; tf for the transforms, none for the scans alone; default: the usual "
            "one, else the transforms, else the scans.",
        ),
    ] = None
    distro: options.Distro = None
    seed: options.Seed = 0

    def open(self, recording: Path, robot: Robot | None) -> RecordedDrive:
        """Open a recording; `robot` is the one of the command line.

        Raises:
            InputError: If it is no recording of a drive that can be mapped.
        """
        from trundle.recordings import open_drive

        distro = self.distro or DEFAULT
        return open_drive(recording, robot=robot, scan_topics=self.scan_topic or (), odometry=self.odom, distro=distro)


MAP_DEFAULTS = MapOptions()
DRIVE_DEFAULTS = DriveOptions()


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


def write(
    graph: PoseGraph,
    targets: Targets,
    given: MapOptions,
    *,
    robot: Robot | None,
    facts: dict[str, object],
    remarks: list[str],
    is_new: bool = True,
) -> int:
    """Draw the map of a pose graph, check it, write everything, and say what a person should look at.

    Everything is made before anything is written; each file is written whole or not at all. Of a map that is too large
    to draw, a new pose graph is kept.

    Args:
        graph: The graph, which is put where --origin says.
        targets: What is written.
        given: The options of the map.
        robot: The robot that must fit through the doors; None where it is unknown.
        facts: What is printed before.
        remarks: What was left out of recordings, and why.
        is_new: Whether the graph is in no file yet.

    Returns:
        The exit code: 0, or 1 if the map has errors, or a part is not in it.
    """
    from trundle.files.writing import atomic_path
    from trundle.mapping import draw_map, move_pose_graph, save_pose_graph
    from trundle.mapping.parts import find_corrections, joined_nodes
    from trundle.maps.check import check_map
    from trundle.record.map_report_lines import tell_report
    from trundle.record.mapping_picture import choose_corrections, draw_drive, drive_length, tell

    if not len(graph.scan_nodes):
        raise InputError(f"there is no scan to make a map of: {'; '.join(remarks) or 'the pose graph is empty'}")
    if given.origin is not None:
        graph = move_pose_graph(graph, options.parse_pose("--origin", given.origin))
    try:
        grid = draw_map(graph, resolution=given.resolution, robot=robot)
    except InputError as error:
        if not is_new:
            raise
        save_pose_graph(graph, targets.graph)
        raise InputError(f"{error}; trundle map from-graph {targets.graph} draws what was mapped") from None
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
    if given.json:
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
        output.remark(f"trundle: {line}", quiet=given.quiet)
    for line in tell_report("map check", report, None, most=_MOST_FINDINGS):
        print(line)
    _say_what_to_look_at(targets, bool(named), quiet=given.quiet)
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
