"""`trundle ros2 navigate`: trundle's navigator on a robot that is somewhere else in ROS 2."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

from cyclopts import App, Parameter

from trundle.cli.ros2 import network, running
from trundle.cli.shared import nav2, options, output, scenario_options
from trundle.cli.shared.field_options import option_name
from trundle.cli.shared.termination import ends_as_by_ctrl_c
from trundle.errors import InputError
from trundle.geometry import Goal

if TYPE_CHECKING:
    from trundle.messages.codec import Distro
    from trundle.mission import Episode, Scenario
    from trundle.recordings.drive import RecordedDrive

app = App(
    name="navigate",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle ros2 navigate map.yaml --robot turtlebot3_burger --start 0,0,0\n"
        "  trundle ros2 navigate map.yaml --robot robot.yaml --start 0,0,0 --goal 4,2 --record\n"
        "  trundle ros2 navigate map.yaml --robot nova_carter --localizer tf --browser\n"
        "  trundle ros2 navigate --localizer slam --robot robot.yaml --save-map map.yaml --browser\n"
        "  trundle ros2 navigate map.yaml --bag drive.mcap --start 0,0,0"
    ),
)

_SIMULATED = ("backend", "lidar_errors", "odometry", "start_error", "map_errors", "isaac_options", "agent", "lidar")
"""Options of `trundle run` that say how a robot is simulated."""


@Parameter(name="*")
class NavigateOptions(
    scenario_options.adapted_options(
        {
            "start": "Where the robot stands [m, m, rad or 90deg], map frame; default: it waits for a pose on "
            "/initialpose, or of the page.",
            "goals": "Where it drives, and then ends; repeat it for several goals in order; default: it waits for "
            "goals, until Ctrl-C.",
            "localizer": "What locates the robot: amcl, slam, odometry, tf for map → odom of others, or a plug-in: its "
            "name, module:name or file.py:name; default: amcl.",
        },
        hidden=(*_SIMULATED, "agent_options"),
    )
):
    """The options of a mission, of a robot that is not simulated."""


_NO_SIMULATION = "restart", "box", "speed"
"""What a page cannot do with a robot that is somewhere else."""


@app.default
def navigate(
    source: str | None = None,
    /,
    *,
    given: NavigateOptions = NavigateOptions(),  # noqa: B008 - it is frozen
    profile: Annotated[
        str,
        Parameter(
            name="--profile",
            metavar="carter_navigation|turtlebot3|plain|FILE",
            help="Names of the robot's topics and frames: of NVIDIA's carter_navigation, of TurtleBot3, or ROS's usual "
            "names; or the YAML file of your own profile.",
        ),
    ] = "plain",
    bag: Annotated[
        Path | None,
        Parameter(
            name="--bag",
            metavar="FILE",
            help="Play the scans and the odometry of a recording instead of driving a robot: a rosbag2 of anyone, or a "
            "CARMEN log. The localizer follows it, and nothing is commanded; it ends with the recording.",
        ),
    ] = None,
    speed: Annotated[
        str | None,
        Parameter(
            name="--speed",
            allow_leading_hyphen=True,
            metavar="FACTOR|max",
            help="With --bag: recorded seconds per second, 0.1 to 50; default: max.",
        ),
    ] = None,
    static_frames: network.StaticFrames = "auto",
    at: network.NetworkOptions = network.DEFAULTS,
    namespace: network.Namespace = "",
    remap: network.Remaps = None,
    record: running.Record = False,
    out: running.RecordOut = None,
    save_map: Annotated[
        Path | None,
        Parameter(
            name="--save-map",
            metavar="YAML",
            help="With --localizer slam: write the map there at the end, its image beside it.",
        ),
    ] = None,
    overwrite: options.OverwriteFile = False,
    page: running.Page = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Drive a robot that is somewhere else in ROS 2: a real one, one in Gazebo or Isaac Sim, or another trundle's.

    It reads the robot's scans, odometry, transforms and clock, and publishes its commands. The robot stands wherever
    these are silent, jump or disagree, and until it is located: by --start, by a pose on /initialpose, or by map → odom
    (--localizer tf). With --goal it drives there and ends. With --localizer slam it needs no map: it makes one as it
    drives, from where it stands. With --bag it plays a recording in place of a robot.

    Exit code 0: it has arrived, or without --goal it was ended; 1: it has not arrived, or the recording breaks off or
    the robot is lost at its end; 3: a plug-in raised. With --json it prints two lines: what is offered, as soon as it
    is, and how it ended.

    Args:
        source: The YAML of a map or of a scenario, a world by name, or a world's file; left out with slam.
    """
    from trundle.mission.steering.goal_directives import MOST_GOALS
    from trundle.ros2.names import Names
    from trundle.ros2.profile import Profile
    from trundle.ros2.remote.bag_bridge import BagBridge
    from trundle.ros2.remote.bag_robot import read_truth
    from trundle.ros2.remote.bridge import RemoteBridge
    from trundle.ros2.remote.setting import RemoteOptions

    network.check_extra()
    _refuse_simulated(given)
    settings, names = at.read(), Names(namespace=namespace, remaps=remap or ())
    target = running.recording_target(out, record=record, overwrite=overwrite)
    map_file = _map_target(save_map, overwrite=overwrite)
    names_of = Profile.load(profile)
    told = nav2.Nav2Report()
    scenario, locates = _make_scenario(given, source, told, names_of.robot)
    told.tell(quiet=quiet)
    how = RemoteOptions(
        localizer="tf" if locates == "tf" else None,
        start=options.parse_pose("--start", given.start) if given.start else None,
        goals=tuple(Goal.of(options.parse_goal("--goal", text)) for text in given.goals or ()),
        static_frames=static_frames,
    )
    if locates == "odometry" and how.start is None:
        raise InputError("--localizer odometry needs --start X,Y,YAW: nothing else says where the robot is")
    if len(how.goals) > MOST_GOALS:
        raise InputError(f"--goal is given {len(how.goals)} times; a drive takes at most {MOST_GOALS} goals")
    if map_file is not None and scenario.known_map:
        raise InputError("--save-map is for a map that is made: give --localizer slam, and no map")
    recorded = None if bag is None else _open_bag(bag, given, scenario, settings.distro)
    if recorded is None and speed is not None:
        raise InputError("--speed is for --bag: a robot drives in its own time")
    for line in () if recorded is None else recorded.remarks.lines:
        output.remark(f"{bag}: {line}", quiet=quiet)
    factor = float("inf") if speed is None else options.parse_speed(speed)
    lacks = _NO_SIMULATION if recorded is None else _NO_SIMULATION[:2]
    if locates != "amcl":
        lacks = (*lacks, "find")
    with ends_as_by_ctrl_c(), ExitStack() as opened:
        transport = at.open(settings, names)
        opened.callback(transport.close)
        types = running.make_types(transport)
        kept = running.open_recording(target, scenario, types, transport, "navigate") if record else None
        if kept is not None:
            opened.enter_context(kept)
        driver, observers = opened.enter_context(
            running.open_page(scenario, source or "", factor, shows=page, quiet=quiet or json, lacks=lacks)
        )
        facts = {"role": "navigate", "profile": profile, "localizer": locates, **told.facts}
        bridge: RemoteBridge | BagBridge
        if recorded is None:
            bridge = RemoteBridge(
                *(scenario, transport, types, names, how),
                profile=names_of,
                record=kept,
                driver=driver,
                observers=observers,
            )
        else:
            facts["bag"] = recorded.path
            bridge = BagBridge(
                *(scenario, recorded, transport, types, names, how),
                profile=names_of,
                truth=read_truth(recorded, settings.distro),
                record=kept,
                speed=factor,
                driver=driver,
                observers=observers,
            )
        opened.enter_context(bridge)
        stops = bridge.guard.counts if isinstance(bridge, RemoteBridge) else None
        episode = running.run(bridge, facts, kept, json=json, quiet=quiet, stops=stops)
    made = _write_map(episode, map_file)
    if isinstance(bridge, BagBridge):
        code = running.report(episode, bridge.wire, kept, json=json, more={**bridge.summary.as_dict(), **made})
        return code or int(not bridge.summary.is_whole)
    arrived = None if bridge.drive is None else bridge.drive.arrived
    code = running.report(episode, bridge.wire, kept, json=json, stops=stops, arrived=arrived, more=made)
    return code if arrived is None else int(not arrived)


def _open_bag(bag: Path, given: scenario_options.ScenarioOptions, scenario: Scenario, distro: Distro) -> RecordedDrive:
    """Open the recording of --bag; its robot is the one that is given, else the recording's own.

    Raises:
        InputError: If it is none, or other options do not fit it.
    """
    from trundle.recordings.opening import open_drive

    if given.goals:
        raise InputError("--goal is for a robot that drives: with --bag a recording is played")
    if scenario.localizer is None:
        raise InputError("--localizer tf takes map → odom from others; with --bag give amcl, slam or odometry")
    return open_drive(bag, robot=scenario.robot if given.robot else None, distro=distro)


def _make_scenario(
    given: scenario_options.ScenarioOptions, source: str | None, told: nav2.Nav2Report, robot: str | None
) -> tuple[Scenario, str]:
    """Make the scenario of the options, and say what locates the robot.

    Raises:
        InputError: If the options do not fit.
    """
    by_tf = given.localizer == "tf"
    changes: dict[str, object] = {"localizer": None if by_tf else given.localizer}
    if source is None:
        if given.localizer in (None, "amcl"):
            raise InputError(
                "give the map: trundle ros2 navigate map.yaml …; without one, --localizer slam makes it as it drives"
            )
        # The fields of a scenario need a place; nothing of it is made for a robot that knows no map.
        changes["known_map"] = True
    sensed = {"lidar": True}  # whether the robot has lidars is seen later, where it is driven
    scenario = _with(given, changes).make(source or "lot", told, robot=robot, instead=sensed)
    if source is None:
        scenario = scenario.model_copy(update={"name": Path(scenario.robot).stem})
    if not by_tf and scenario.localizer is None:
        changes["localizer"] = "amcl"
        scenario = _with(given, changes).make(source or "lot", nav2.Nav2Report(), robot=robot, instead=sensed)
    locates = "tf" if by_tf or scenario.localizer is None else scenario.localizer.name
    if locates == "slam" and scenario.known_map:
        raise InputError(f"--localizer slam makes a map of its own: leave {source} out, or give --no-map with it")
    return scenario, locates


def _with(given: scenario_options.ScenarioOptions, changes: dict[str, object]) -> scenario_options.ScenarioOptions:
    return replace(cast("Any", given), **changes)


def _map_target(file: Path | None, *, overwrite: bool) -> Path | None:
    if file is None:
        return None
    target = options.output_file(file, "map.yaml", (".yaml", ".yml"))
    if not overwrite:
        options.check_map_replaceable(target, "--save-map")
    return target


def _write_map(episode: Episode | None, target: Path | None) -> dict[str, object]:
    """Write the map that the localizer has made; return what there is to say of it."""
    own = None if episode is None else episode.own_map
    if own is None:
        return {} if target is None else {"map": None}
    if target is not None:
        own.grid.save(target)
    rows, cols = own.grid.shape
    return {"map": target, "map_size": f"{cols} x {rows} cells of {own.grid.resolution:g} m"}


def _refuse_simulated(given: scenario_options.ScenarioOptions) -> None:
    """Refuse options that say how a robot is simulated: this one is not."""
    defaults = scenario_options.DEFAULTS
    for name in _SIMULATED:
        if getattr(given, name) != getattr(defaults, name):
            raise InputError(
                f"{option_name(name)} is for simulated robots; trundle ros2 navigate drives one that is somewhere else"
            )
