"""`trundle plan`: one path on a map, and its picture."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import field_options, nav2, options, output, sources
from trundle.cli.shared.scenario_options import PARAMETERS
from trundle.cli.shared.sources import check_given
from trundle.errors import BlockedPoseError, InputError, OutputError, OutsideMapError, PlanningError, UnknownNameError
from trundle.files.kinds import MAP, ROBOT

if TYPE_CHECKING:
    from trundle.geometry import Goal, Pose2D
    from trundle.navigation import Navigator
    from trundle.path import Path
    from trundle.planning.comparison import PlannerRow

app = App(
    name="plan",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle plan map.yaml --start -6,-1,3.14 --goal 5,3 -o overlay.png\n"
        "  trundle plan map.yaml --planner manhattan_astar --seed 3 --json\n"
        "  trundle plan map.yaml --goal 9,3 --unknown costly --partial --planner-option goal_tolerance=0.5\n"
        "  trundle plan map.yaml --smoother constrained\n"
        "  trundle plan map.yaml --nav2-params nav2_params.yaml --goal 5,3\n"
        "  trundle plan map.yaml --start -13,0 --goal 13,0 --compare"
    ),
)


@app.default
def plan(
    map_file: FilePath,
    /,
    *,
    start: Annotated[str | None, PARAMETERS["start"]] = None,
    goal: Annotated[
        str | None,
        Parameter(
            allow_leading_hyphen=True,
            metavar="X,Y[,YAW]",
            help="Goal of the path; default: picked from the free space by seed.",
        ),
    ] = None,
    robot: options.RobotName = "nova_carter",
    planner: Annotated[str | None, PARAMETERS["planner"]] = None,
    planner_options: Annotated[list[str] | None, PARAMETERS["planner_options"]] = None,
    partial: options.Flag = False,
    deadline: float | None = None,
    smoother: Annotated[str | None, PARAMETERS["smoother"]] = None,
    smoother_options: Annotated[list[str] | None, PARAMETERS["smoother_options"]] = None,
    controller: Annotated[str | None, PARAMETERS["controller"]] = None,
    controller_options: Annotated[list[str] | None, PARAMETERS["controller_options"]] = None,
    compare: options.Flag = False,
    seed: options.Seed = 0,
    compat: options.Compat = None,
    max_cells: options.MaxCells = None,
    keepout: Annotated[FilePath | None, PARAMETERS["keepout"]] = None,
    speed_mask: Annotated[FilePath | None, PARAMETERS["speed_mask"]] = None,
    backend: options.Backend = "mujoco",
    nav2_params: nav2.Nav2Params = None,
    out: options.Out = None,
    json: options.Json = False,
    quiet: options.Quiet = False,
    costmap: field_options.CostmapOptions = None,
    navigation: field_options.RunOptions = None,
) -> int:
    """Plan a path on a map; print its length, cost and time, and draw it.

    The picture shows the map, its inflation, the zones of the masks, the path, and the robot's footprint at both ends;
    for a smoothed path also the path before smoothing.

    Args:
        map_file: The YAML of a ROS map.
        partial: If the goal cannot be reached, plan to the nearest reachable place; the same as --planner-option
            allow_partial=true.
        deadline: Give up after this time [s]; the same as --planner-option deadline_s=….
        compare: Plan with every available planner: a table, and all their paths in one picture. The times are
            medians of repeated plans on one map.
        backend: Accepted and checked as in trundle run; planning starts no simulator. The same holds for the
            controller and its options, and those of navigation.
        out: The picture, or a folder for overlay.png; default: overlay.png in the current folder. If it cannot be
            written, the rest is still printed.
    """
    from trundle.costmap import CostmapSettings
    from trundle.geometry import Pose2D
    from trundle.maps import KeepoutMask, OccupancyGrid, SpeedMask
    from trundle.mission import RunSettings, Scenario
    from trundle.navigation import Navigator
    from trundle.planning import PathCheck
    from trundle.record.overlay import draw_plan
    from trundle.record.run_folder import save_png
    from trundle.robots import Robot
    from trundle.sim import simulator_names

    if backend not in simulator_names():
        raise UnknownNameError("backend", backend, simulator_names())
    for text, kind in ((map_file, MAP), (robot, ROBOT), (keepout, MAP), (speed_mask, MAP)):
        if text is not None:
            check_given(text, kind)
    sources.warn_of_units(map_file)
    first = options.parse_pose("--start", start) if start else None
    last = options.parse_goal("--goal", goal) if goal else None
    target = _find_target(out)
    code = 2 if out is not None and target is None else 0
    shorthands = ["allow_partial=true"] * partial + ([] if deadline is None else [f"deadline_s={deadline}"])
    told = nav2.Nav2Report()
    place = Scenario.make(map=str(map_file), robot=robot, keepout=_text(keepout), speed_mask=_text(speed_mask))
    given = field_options.given(costmap) | field_options.given(navigation)
    base = place.model_copy(update=given)
    if nav2_params is not None:
        found = nav2.translate(nav2_params, place, given, told)
        base = Scenario.make(**{**place.model_dump(), **found, "known_map": True})
        told.tell(quiet=quiet)
    chosen = field_options.choose("planner", planner, [*(planner_options or ()), *shorthands], base.planner)
    if compare and (planner_options or shorthands):
        raise InputError("--compare runs every planner with its default options: leave planner options out")
    smoothing = field_options.choose("smoother", smoother, smoother_options, base.smoother)
    navigator = Navigator(
        OccupancyGrid.load(map_file, compat=compat, max_cells=max_cells),
        base.assumed_robot(Robot.load(robot)),
        planner=chosen,
        controller=field_options.choose("controller", controller, controller_options, base.controller),
        smoother=smoothing,
        costmap=base.part(CostmapSettings),
        settings=base.part(RunSettings),
        keepout=None if base.keepout is None else KeepoutMask.load(base.keepout, compat=compat, max_cells=max_cells),
        speed_mask=None
        if base.speed_mask is None
        else SpeedMask.load(base.speed_mask, compat=compat, max_cells=max_cells),
    )
    if first is None and base.start is not None:
        first = Pose2D.of(base.start)
    begin, end = sources.pick_ends(navigator.costmap, first, last, seed=seed)
    if compare:
        return _compare(navigator, begin, end, target, json=json, facts=told.facts) or code
    navigator.set_goal(end)
    try:
        path = navigator.plan(begin)
    except (OutsideMapError, BlockedPoseError):
        raise  # bad input
    except PlanningError as error:
        output.remark(f"trundle: {error}", quiet=False)
        if json:
            output.print_error(error)
        return 1
    before = navigator.planned if smoothing is not None else None
    if target is not None:
        picture = draw_plan(navigator.costmap, path, navigator.robot, speed_mask=navigator.speed_mask, before=before)
        save_png(picture, target)
    hit = PathCheck(path).first_hit(navigator.costmap)
    if hit is not None:
        x, y, _ = hit.pose
        output.remark(
            f"trundle: the path of planner {chosen.name!r} collides at ({x:.2f}, {y:.2f}); it cannot be driven",
            quiet=False,
        )
        code = code or 1
    facts = {
        "status": path.status,
        "touches": None if hit is None else hit.pose,
        "remaining_m": path.remaining_m,
        "length_m": path.length,
        "cost": path.cost,
        "planning_ms": 1000.0 * navigator.planning_time_s,
        "planner": chosen.name,
        "found_by": path.planner,
        "smoother": None if smoothing is None else smoothing.name,
        "replans": path.replans,
        "start_snapped_m": path.start_snapped_m,
        "goal_snapped_m": path.goal_snapped_m,
        "overlay": target,
    }
    if json:
        output.print_json({**facts, "map": map_file, "robot": navigator.robot.name, "poses": path.poses, **told.facts})
        return code
    output.print_facts(
        {
            "from": "x {:.3f}, y {:.3f}, yaw {:.3f}".format(*path.start.as_tuple()),
            "to": "x {:.3f}, y {:.3f}, yaw {:.3f}".format(*path.goal.as_tuple()),
            **({} if path.status == "found" else {"remaining": f"{path.remaining_m:.3f} m to the goal"}),
            **_moved(path),
            "length": f"{path.length:.3f} m",
            "cost": path.cost,
            "time": f"{facts['planning_ms']:.1f} ms",
            "planner": f"{path.planner}, replanned {path.replans} times",
            "overlay": target or "not written",
        }
    )
    return code


def _text(path: FilePath | None) -> str | None:
    return None if path is None else str(path)


def _find_target(out: FilePath | None) -> FilePath | None:
    """Return the picture's path. If it cannot be written, say so and return None: the plan is useful without it."""
    try:
        return options.output_file(out or FilePath("overlay.png"), "overlay.png", (".png",))
    except OutputError as error:
        output.remark(f"trundle: {error}", quiet=False)
        return None


def _moved(path: Path) -> dict[str, str]:
    """Return which ends were moved to where the robot fits."""
    ends = {"start": path.start_snapped_m, "goal": path.goal_snapped_m}
    moved = [
        f"the {end} by {distance:.3f} m to where the robot fits" for end, distance in ends.items() if distance > 0.0
    ]
    return {"moved": ", ".join(moved)} if moved else {}


def _compare(
    navigator: Navigator,
    begin: Pose2D,
    end: Goal,
    target: FilePath | None,
    *,
    json: bool,
    facts: Mapping[str, object],
) -> int:
    """Plan with every planner, print a table and draw all paths, with the zones of the masks.

    If the navigator smooths, these paths are smoothed as well. Without a target nothing is drawn.

    Returns:
        The exit code: 0 where at least one planner found a path, 2 where all say that an end is at fault.
    """
    from trundle.planning import planner_names
    from trundle.planning.comparison import compare_planners
    from trundle.record.overlay import draw_paths
    from trundle.record.run_folder import save_png

    found = compare_planners(planner_names(), navigator.costmap, begin, end, smoother=navigator.smoother)
    if found.paths and target is not None:
        picture = draw_paths(navigator.costmap, navigator.robot, found.paths, speed_mask=navigator.speed_mask)
        save_png(picture, target)
    _print_rows(found.rows, target if found.paths else None, json=json, facts=facts)
    if found.paths:
        return 0
    return 2 if all(isinstance(error, OutsideMapError | BlockedPoseError) for error in found.errors) else 1


def _print_rows(rows: list[PlannerRow], target: FilePath | None, *, json: bool, facts: Mapping[str, object]) -> None:
    if json:
        output.print_json({"planners": rows, "overlay": target, **facts})
        return
    output.print_table(
        ("planner", "length m", "turning rad", "clearance m", "ms", ""),
        [
            (
                row["planner"],
                row["length_m"],
                row["turning_rad"],
                row["clearance_m"],
                row["planning_ms"],
                "collides" if row["clearance_m"] == 0.0 else row["message"],
            )
            for row in rows
        ],
    )
    if target is not None:
        print(f"overlay  {target}")
