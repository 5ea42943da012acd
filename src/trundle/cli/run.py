"""`trundle run`: drive a robot to its goal, and record it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import App, Parameter

from trundle.cli.shared import isaac, missions, options, settings, sources
from trundle.errors import InputError, UnknownNameError

if TYPE_CHECKING:
    from trundle.mission import Scenario

app = App(
    name="run",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle run map.yaml --robot nova_carter --start -6,-1,3.14 --goal 5,3\n"
        "  trundle run warehouse --seed 7 --set aisle_width=1.4\n"
        "  trundle run map.yaml --set height=0.4 --set unknown=free\n"
        "  trundle run map.yaml --keepout zones.yaml --speed-mask limits.yaml\n"
        "  trundle run scene.usd --exclude /World/Robot --exclude ceiling\n"
        "  trundle run scenario.yaml --backend kinematic --json\n"
        "  python.sh -m trundle run map.yaml --backend isaac --environment warehouse_with_forklifts"
    ),
)


@app.default
def run(
    source: str,
    /,
    *,
    robot: Annotated[str | None, Parameter(help="A robot by name, or the path of its YAML.")] = None,
    start: options.Start = None,
    goal: options.Goals = None,
    planner: Annotated[str | None, Parameter(help="A planner by name.")] = None,
    planner_options: options.PlannerOptions = None,
    controller: Annotated[str | None, Parameter(help="A controller by name.")] = None,
    controller_options: options.ControllerOptions = None,
    smoother: options.SmootherName = None,
    smoother_options: options.SmootherOptions = None,
    backend: Annotated[
        str | None, Parameter(help="The simulator: mujoco, kinematic, isaac or a plug-in's name.")
    ] = None,
    seed: Annotated[int | None, Parameter(help="For everything random; same seed, same run.")] = None,
    world_options: options.Settings = None,
    exclude: options.Exclude = None,
    floor_z: options.FloorZ = None,
    paths: options.Paths = None,
    compat: options.Compat = None,
    keepout: options.Keepout = None,
    speed_mask: options.SpeedMaskFile = None,
    time_limit: float | None = None,
    video: bool = True,
    view: Annotated[bool, Parameter(negative="")] = False,
    out: Annotated[Path | None, Parameter(name=["--out", "-o"])] = None,
    overwrite: options.Overwrite = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
    costmap: settings.CostmapOptions = None,
    navigation: settings.RunOptions = None,
    isaac_options: isaac.IsaacOptions | None = None,
) -> int:
    """Drive a robot through a map, a generated world or a scenario to its goal.

    Writes a folder with episode.json, trajectory.npz, paths.npz, scenario.yaml (which repeats the run), overlay.png and
    video.mp4.
    Exit code 1 says that the robot did not get there.

    Args:
        source: The YAML of a scenario or of a ROS map (it has an image: key), a world by name, or a world's file. With
            --backend isaac also an environment of Isaac Sim whose file is at hand.
        time_limit: Simulated time after which the run is stopped [s].
        video: Write video.mp4.
        view: Watch it in a window while it drives, where there is a screen.
        out: Folder to write into, which must not hold a run; left out: a new one under runs.
    """
    from trundle.mission import Scenario

    given = {
        "robot": robot,
        "start": options.parse_pose("--start", start).as_tuple() if start else None,
        "backend": backend,
        "seed": seed,
        "compat": compat,
        "keepout": None if keepout is None else str(keepout),
        "speed_mask": None if speed_mask is None else str(speed_mask),
        "floor_z": floor_z,
        "time_limit_s": time_limit,
    }
    changes: dict[str, object] = {key: value for key, value in given.items() if value is not None}
    changes |= settings.given(costmap) | settings.given(navigation)
    if goal:
        goals = [options.parse_goal("--goal", text) for text in goal]
        changes |= {"goal": goals[0], "goals": None} if len(goals) == 1 else {"goal": None, "goals": goals}
    source = isaac.world_of(source, backend, isaac_options)
    base = _read(source, sources.read_settings(source, world_options, exclude, paths), changes)
    chosen = {
        "planner": settings.choose("planner", planner, planner_options, base.planner),
        "controller": settings.choose("controller", controller, controller_options, base.controller),
        "smoother": settings.choose("smoother", smoother, smoother_options, base.smoother),
    }
    scenario = isaac.adapt(Scenario.make(**{**base.model_dump(), **chosen}), isaac_options)
    return missions.drive(scenario, out=out, overwrite=overwrite, video=video, view=view, json=json, quiet=quiet)


def _read(source: str, world_options: dict[str, bool | int | float | str], changes: dict[str, object]) -> Scenario:
    """Make a scenario of the first argument, with what the options change."""
    from trundle.mission import Scenario
    from trundle.mission.choices import MapOptions
    from trundle.worlds import world_names
    from trundle.worlds.options import check_options

    if source in world_names():
        return Scenario.make(world={"name": source, "options": world_options}, **changes)
    if not sources.looks_like_file(source):
        raise UnknownNameError("world", source, world_names())
    if not sources.is_yaml(source) and not source.lower().endswith(".map"):
        return Scenario.make(world={"name": source, "options": world_options}, **changes)
    if sources.is_map(Path(source)):
        if world_options:
            check_options(source, "a map", world_options, list(MapOptions.model_fields))
            changes = {"map_options": world_options, **changes}
        return Scenario.make(map=source, **changes)
    if world_options:
        raise InputError(f"--set and --exclude are for worlds, by name or file; {source} is a scenario")
    return Scenario.make(**{**Scenario.load(source).model_dump(), **changes})
