"""`trundle map check`: find mistakes in a map, where they are, and how to fix them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import options, output, sources
from trundle.cli.shared.sources import check_given
from trundle.errors import InputError
from trundle.files.kinds import MAP
from trundle.record.map_report_lines import MOST_LINES, tell_report

if TYPE_CHECKING:
    from trundle.maps import OccupancyGrid
    from trundle.maps.check import MapReport

app = App(
    name="check",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle map check map.yaml\n"
        "  trundle map check map.yaml --world warehouse --seed 7 --robot nova_carter -o report.png\n"
        "  trundle map check map.yaml --world warehouse --fix right.yaml --json"
    ),
)


@app.default
def check(
    map_file: Path,
    /,
    *,
    world: Annotated[str | None, Parameter(name="--world")] = None,
    robot: Annotated[
        str | None,
        Parameter(name="--robot", help=f"A robot that must fit through the doors: {options.ROBOT_CHOICES}."),
    ] = None,
    start: Annotated[str | None, Parameter(name="--start", allow_leading_hyphen=True, metavar="X,Y[,YAW]")] = None,
    goal: Annotated[
        list[str] | None, Parameter(name="--goal", allow_leading_hyphen=True, negative="", metavar="X,Y[,YAW]")
    ] = None,
    fix: Annotated[Path | None, Parameter(name="--fix")] = None,
    overwrite: options.OverwriteMap = False,
    out: options.Out = None,
    z_min: options.Height = None,
    z_max: options.Height = None,
    seed: options.Seed = 0,
    settings: options.Settings = None,
    exclude: options.Exclude = None,
    floor_z: options.FloorZ = None,
    paths: options.Paths = None,
    compat: options.Compat = None,
    max_cells: options.MaxCells = None,
    everything: Annotated[bool, Parameter(name="--all", negative="")] = False,
    json: options.Json = False,
) -> int:
    """Find mistakes in a map: its file, its position, its free space, and a robot's paths through it.

    Exits with 1 if there is an error among the findings, and with 2 if the file is missing or not
    text. A map that is flipped, rotated, shifted or half a cell off shows only against a world.
    --fix replaces the map that is checked, or one that has changed since trundle wrote it, only with --overwrite.

    Args:
        map_file: The YAML of a ROS map.
        world: The world that the map shows, by name or file.
        start: Where the robot starts [m, m, rad or 90deg], map frame.
        goal: Goal of the robot; repeatable.
        fix: Write the map with all certain fixes applied to this YAML, or to map.yaml in this folder.
        out: A picture of the map with its findings, or a folder for check.png.
        z_min: Lower end of the world's height band in the map [m]; default: the robot's, or 0.1.
        z_max: Upper end of the height band [m]; default: the robot's, or 0.62.
        everything: Print every finding instead of a summary by kind of at most 15 lines.
    """
    from trundle.maps.check import check_map
    from trundle.maps.check.check import DEFAULT_ROBOT, DEFAULT_Z_RANGE
    from trundle.maps.ros_writer import choose_mode
    from trundle.robots import Robot

    check_given(map_file, MAP)
    first = options.parse_pose("--start", start) if start else None
    goals = [options.parse_pose("--goal", text) for text in goal or []]
    machine = sources.load_robot(robot, paths) if robot is not None else None
    given = sources.read_settings(world, settings, exclude, paths, robot=robot)
    place = sources.load_place(world, seed=seed, settings=given) if world is not None or given else None
    if place is not None:
        place = sources.stand_on_floor(place, world, machine or Robot.load(DEFAULT_ROBOT), first, floor_z)
    elif floor_z is not None:
        raise InputError("--floor-z is the height of the floor in a world: give --world as well")
    target = options.output_file(fix, "map.yaml", (".yaml", ".yml")) if fix is not None else None
    if target is not None and not overwrite:
        _check_fix(map_file, target)
    picture = options.output_file(out, "check.png", (".png",)) if out is not None else None
    robot_area = _covered(machine.footprint) if machine is not None else None
    low, high = machine.z_range if machine is not None else DEFAULT_Z_RANGE
    heights = (low if z_min is None else z_min, high if z_max is None else z_max)
    report = check_map(
        map_file,
        world=place,
        robot=machine,
        start=first,
        goals=goals,
        z_range=heights,
        compat=compat,
        max_cells=max_cells,
    )
    if target is not None and report.corrected is not None:
        report.corrected.save(target, mode=choose_mode(report.corrected))
    if picture is not None and report.grid is not None:
        _draw(report.grid, report, picture, map_file.name, robot_area)
    fixed = target if report.corrected is not None else None
    drawn = picture if report.grid is not None else None
    if json:
        output.print_json(
            {
                "map": map_file,
                "findings": report.findings,
                "unverified": report.unverified,
                "ambiguous": report.ambiguous,
                "remarks": report.remarks,
                "can_fix": report.corrected_kinds,
                "fixed": fixed,
                "picture": drawn,
            }
        )
    else:
        written = _written_lines(report, (target, fixed), (picture, drawn))
        most = None if everything else MOST_LINES - len(written)
        for line in [*tell_report(str(map_file), report, robot_area, most=most), *written]:
            print(line)
    return 1 if report.has_errors else 0


def _check_fix(map_file: Path, target: Path) -> None:
    """Refuse to write the fixed map in place of the one that is checked, or of one that was edited.

    Raises:
        InputError: If it would be.
    """
    if target.exists() and target.samefile(map_file):
        raise InputError(
            f"--fix {target}: this is the map that is checked; give another file, or replace it with --overwrite"
        )
    options.check_map_replaceable(target, "--fix")


def _written_lines(
    report: MapReport, fix: tuple[Path | None, Path | None], picture: tuple[Path | None, Path | None]
) -> list[str]:
    """Return lines that say which of the requested files were written."""
    lines: list[str] = []
    for (asked, written), what in ((fix, "fixed"), (picture, "picture")):
        if written is not None:
            done = f" ({', '.join(report.corrected_kinds)})" if what == "fixed" else ""
            lines.append(f"{what}: {written}{done}")
        elif asked is not None:
            why = "there is no certain fix" if what == "fixed" else "the map cannot be read"
            lines.append(f"{what}: not written: {why}")
    return lines


def _draw(grid: OccupancyGrid, report: MapReport, target: Path, title: str, robot_area: float | None) -> None:
    from trundle.files.writing import atomic_path
    from trundle.record.map_report import draw_report

    image = draw_report(grid, report, title=title, robot_area=robot_area)
    with atomic_path(target) as temporary:
        image.save(temporary)


def _covered(corners: tuple[tuple[float, float], ...]) -> float:
    """Return the area of a footprint [m²], by the shoelace formula."""
    following = (*corners[1:], corners[0])
    return abs(sum(x * b - a * y for (x, y), (a, b) in zip(corners, following, strict=True))) / 2.0
