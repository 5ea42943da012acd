"""`trundle export`: write a world, a robot or a scenario as a file for another program."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from cyclopts import App, Parameter

from trundle.cli.shared import isaac, nav2, options, output, scenario_options, sources
from trundle.cli.shared.sources import check_given
from trundle.errors import InputError, UnknownNameError
from trundle.files.kinds import MAP, ROBOT, SCENARIO, WORLD

if TYPE_CHECKING:
    from trundle.export import Kind, Scene
    from trundle.messages.codec import Distro
    from trundle.mission import Setting
    from trundle.robots import Robot
    from trundle.worlds import World

app = App(
    name="export",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle export office --seed 3 --to sdf -o office.sdf\n"
        "  trundle export warehouse --robot nova_carter --to mjcf -o scene.xml\n"
        "  trundle export nova_carter --to urdf -o nova_carter.urdf\n"
        "  trundle export scenario.yaml --to usd --profile isaac -o scene.usd\n"
        "  trundle export scenario.yaml --to isaac-script -o drive.py\n"
        "  trundle export scenario.yaml --to nav2 --distro jazzy -o nav2"
    ),
)

NAV2 = "nav2"
"""The format of a folder for Nav2."""

_USES: dict[str, tuple[tuple[str, str], ...]] = {
    "robot": (("world", "mjcf"), ("world", "map")),
    "resolution": (("world", "map"),),
    "z_min": (("world", "map"),),
    "z_max": (("world", "map"),),
    "profile": (("world", "usd"), ("robot", "usd"), ("scenario", "usd")),
    "environment": (("scenario", "isaac-script"),),
    "robot_usd": (("scenario", "isaac-script"),),
}
"""The source kinds and formats that each option applies to."""


@app.default
def export(
    source: str,
    /,
    *,
    to: Annotated[str | None, Parameter(metavar="FORMAT")] = None,
    out: options.Out = None,
    robot: Annotated[
        str | None,
        Parameter(
            help="For a world as mjcf: a robot to include. For a map: the robot that gives the height band. For nav2: "
            f"the robot that Nav2 drives. One of {options.ROBOT_CHOICES}."
        ),
    ] = None,
    resolution: float | None = None,
    z_min: options.Height = None,
    z_max: options.Height = None,
    profile: isaac.Profile = None,
    environment: isaac.ScriptEnvironment = None,
    robot_usd: isaac.ScriptRobot = None,
    distro: options.Distro = None,
    nav2_params: nav2.Nav2Params = None,
    seed: options.Seed = 0,
    settings: options.Settings = None,
    exclude: options.Exclude = None,
    floor_z: options.FloorZ = None,
    paths: options.Paths = None,
    overwrite: options.OverwriteMap = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Write a world, a robot or a scenario as a file for another program; worlds load back as the same solids.

    As nav2, a scenario, a map or a world becomes a folder: Nav2's parameters, the map with its masks, a launch file,
    and a list of what Nav2 does differently or does not have.

    Args:
        source: A world by name or its file, a robot by name or its YAML or URDF, or the YAML of a scenario.
        to: The format by name: mjcf, sdf, usd, glb or map for a world; mjcf, urdf or usd for a robot; mjcf, usd or
            isaac-script for a scenario; nav2 for a scenario, a map or a world; default: by the suffix of --out.
        out: The file, or nav2's folder; default: the source's name, in the current folder.
        resolution: Cell size of a map [m]; default: 0.05.
        z_min: Lower end of a map's height band [m]; default: 0.10, or the robot's.
        z_max: Upper end of a map's height band [m]; default: 0.62, or the robot's.
        floor_z: Height of the floor in the world's file [m], which is written at z = 0; default: unchanged,
            but for a map or with a robot the floor under most of the world.
    """
    from trundle.export import export_robot, export_scene, export_world
    from trundle.maps.check.check import DEFAULT_ROBOT
    from trundle.robots import Robot
    from trundle.worlds import World
    from trundle.worlds.floors import lower_world

    given = {
        "resolution": resolution,
        "z_min": z_min,
        "z_max": z_max,
        "profile": profile,
        "environment": environment,
        "robot_usd": robot_usd,
    }
    given = {name: value for name, value in given.items() if value is not None}
    if to == NAV2:
        _check_uses(given, "scenario", NAV2)
        chosen = scenario_options.ScenarioOptions(
            robot=robot,
            seed=seed or None,
            world_options=settings,
            exclude=exclude,
            floor_z=floor_z,
            paths=paths,
            nav2_params=nav2_params,
        )
        return _export_nav2(source, chosen, out, distro, overwrite=overwrite, json=json, quiet=quiet)
    if distro is not None or nav2_params is not None:
        raise InputError("--distro and --nav2-params are for --to nav2")
    check_given(source, WORLD, ROBOT, SCENARIO, MAP)
    target, form = choose_file(source, to, out)
    if form == "map" and not overwrite:
        options.check_map_replaceable(target)
    if robot is not None:
        given["robot"] = robot
    kept = sources.read_settings(source, settings, exclude, paths)
    thing = load_source(source, form, seed=seed, settings=kept, floor_z=floor_z)
    facts: dict[str, object]
    if isinstance(thing, Robot):
        _check_uses(given, "robot", form)
        export_robot(thing, target, to=form, **given)
        facts = {"robot": thing.name}
    elif isinstance(thing, World):
        _check_uses(given, "world", form)
        chosen = _world_options(form, given)
        if form == "map" or robot is not None:
            machine = Robot.load(robot or DEFAULT_ROBOT)
            thing = sources.stand_on_floor(thing, source, machine, None, floor_z)
        elif floor_z is not None:
            thing = lower_world(thing, floor_z)
        export_world(thing, target, to=form, **chosen)
        facts = {"world": thing.name, "solids": len(thing.solids)}
    else:
        _check_uses(given, "scenario", form)
        scene, own = _make_scene(thing, form)
        export_scene(scene, target, to=form, **{**own, **given})
        facts = {"scenario": scene.name, "robot": scene.robot.name, "world": scene.world.name}
    facts |= {"format": form, "file": target, "bytes": target.stat().st_size}
    if json:
        output.print_json(facts)
    else:
        output.print_facts(facts)
    return 0


def _export_nav2(
    source: str,
    given: scenario_options.ScenarioOptions,
    out: Path | None,
    distro: Distro | None,
    *,
    overwrite: bool,
    json: bool,
    quiet: bool,
) -> int:
    """Write a scenario, a map or a world with a robot as a folder for Nav2; see `export_nav2` for the errors."""
    from trundle.messages.codec import DEFAULT
    from trundle.nav2 import describe_remarks, export_nav2
    from trundle.nav2.export import KEEPOUT, LAUNCH, MAP, REMARKS, SPEED

    told = nav2.Nav2Report()
    scenario = given.make(source, told)
    told.tell(quiet=quiet)
    folder = Path(f"{Path(source).stem}_nav2") if out is None else out
    if folder.suffix and not folder.is_dir():
        raise InputError(f"--out {folder}: give a folder for Nav2's files")
    if not overwrite:
        written = {MAP: scenario.known_map, KEEPOUT: scenario.keepout, SPEED: scenario.speed_mask}
        for name in (name for name, made in written.items() if made):
            options.check_map_replaceable(folder / name)
    done = export_nav2(scenario, folder, distro=distro or DEFAULT)
    facts: dict[str, object] = {"robot": scenario.robot, "format": NAV2, "folder": done.folder, "files": done.files}
    if quiet:
        output.remark(f"{folder / REMARKS}: {len(done.remarks)} settings", quiet=False)
    elif done.remarks:
        head = f"What Nav2 does differently, or does not have ({REMARKS}):"
        output.remark("\n  ".join([head, *describe_remarks(done.remarks)]), quiet=False)
    if json:
        output.print_json({**facts, "remarks": done.remarks, **told.facts})
        return 0
    output.print_facts({**facts, "files": ", ".join(done.files)})
    output.remark(f"To drive with it: ros2 launch {folder / LAUNCH}", quiet=quiet)
    return 0


def choose_file(source: str, to: str | None, out: Path | None) -> tuple[Path, str]:
    """Return the output file, whose folder is created, and the name of the format.

    Raises:
        UnknownNameError: If there is no such format; the nearest is offered.
        InputError: If neither determines the format, or the file's suffix belongs to another format.
        OutputError: If its folder cannot be written to.
    """
    from trundle.export import FORMATS, format_of

    if to is None:
        if out is None:
            raise InputError(f"give --to FORMAT ({', '.join(sorted([*FORMATS, NAV2]))}), or a file with -o")
        to = format_of(out)
    if to not in FORMATS:
        raise UnknownNameError("format", to, [*FORMATS, NAV2])
    suffixes = FORMATS[to].suffixes
    name = Path(source).stem + suffixes[0]
    return options.output_file(Path(name) if out is None else out, name, suffixes), to


def load_source(
    source: str,
    form: str,
    *,
    seed: int,
    settings: dict[str, bool | int | float | str],
    floor_z: float | None = None,
) -> World | Robot | Setting:
    """Load the source: a robot by name, YAML or URDF, a scenario by its YAML, else a world.

    An MJCF file is a world, and a URDF file a robot, unless the format supports only the other.

    Raises:
        UnknownNameError: If it is none of these; the nearest of the names is offered.
        InputError: If it cannot be used.
    """
    from trundle.export import FORMATS
    from trundle.robots import Robot, robot_names
    from trundle.worlds import world_names

    suffix = Path(source).suffix.lower()
    kind: Kind = "world"
    if sources.is_yaml(source) and not sources.is_map(Path(source)):
        kind = "scenario" if sources.is_scenario(Path(source)) else "robot"
    elif (
        source in robot_names()
        or (source.lower().endswith((".urdf", ".urdf.xacro")) and FORMATS[form].robot is not None)
        or (suffix in (".xml", ".mjcf") and FORMATS[form].world is None)
    ):
        kind = "robot"
    if kind != "world" and settings:
        raise InputError(f"--set and --exclude are for worlds, and this is a {kind}")
    if kind == "robot" and floor_z is not None:
        raise InputError("--floor-z is for worlds and scenarios, and this is a robot")
    if kind == "robot":
        return Robot.load(source)
    if kind == "scenario":
        from trundle.mission import Scenario

        scenario = Scenario.load(source)
        if floor_z is not None:
            scenario = Scenario.make(**{**scenario.model_dump(), "floor_z": floor_z})
        return scenario.prepare()
    if source not in world_names() and not sources.looks_like_file(source):
        raise UnknownNameError("world or robot", source, [*world_names(), *robot_names()])
    return sources.load_world(source, seed=seed, settings=settings)


def _check_uses(given: dict[str, Any], kind: str, form: str) -> None:
    for name in given:
        if (kind, form) not in _USES[name]:
            uses = " or ".join(f"a {thing} --to {known}" for thing, known in _USES[name])
            raise InputError(f"--{name.replace('_', '-')} is for {uses}, and this is a {kind} --to {form}")


def _world_options(form: str, given: dict[str, Any]) -> dict[str, Any]:
    """Return the options of a world's format: a robot's name becomes the robot, or for a map its height band."""
    from trundle.robots import Robot

    found = dict(given)
    robot = Robot.load(found.pop("robot")) if "robot" in found else None
    if form != "map":
        return found if robot is None else {**found, "robot": robot}
    low, high = (0.10, 0.62) if robot is None else robot.z_range
    found["z_range"] = (found.pop("z_min", low), found.pop("z_max", high))
    return found


def _make_scene(setting: Setting, form: str) -> tuple[Scene, dict[str, Any]]:
    """Build the scene of a scenario, with the path to its goals if the format has one, and its options.

    Raises:
        PlanningError: If there is no path.
    """
    from trundle.export import Scene
    from trundle.geometry import Pose2D
    from trundle.path import Path as Plan

    scenario = setting.scenario
    if form != "isaac-script":
        return Scene(scenario.title, setting.world, setting.robot, setting.start), {}
    paths: list[Plan] = []
    pose: Pose2D = setting.start
    for goal in setting.goals:
        setting.navigator.set_goal(goal)
        paths.append(setting.navigator.plan(pose))
        pose = paths[-1].goal
    mask = setting.navigator.speed_mask
    return Scene(scenario.title, setting.world, setting.robot, setting.start, tuple(paths), mask), isaac.script_options(
        scenario
    )
