"""`trundle ros2 navigate`: trundle's navigator on a robot that is somewhere else in ROS 2."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

from cyclopts import App, Parameter

from trundle.cli.ros2 import network, running
from trundle.cli.shared import nav2, options, scenario_options
from trundle.cli.shared.field_options import option_name
from trundle.cli.shared.termination import ends_as_by_ctrl_c
from trundle.errors import InputError
from trundle.geometry import Goal

if TYPE_CHECKING:
    from trundle.mission import Episode, Scenario

app = App(
    name="navigate",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle ros2 navigate map.yaml --robot turtlebot3_burger --start 0,0,0\n"
        "  trundle ros2 navigate map.yaml --robot robot.yaml --start 0,0,0 --goal 4,2 --record\n"
        "  trundle ros2 navigate map.yaml --robot nova_carter --localizer tf --browser\n"
        "  trundle ros2 navigate --localizer slam --robot robot.yaml --save-map map.yaml --browser"
    ),
)

_SIMULATED = ("backend", "lidar_errors", "odometry", "start_error", "map_errors", "isaac_options", "agent", "lidar")
"""Options of `trundle run` that say how a robot is simulated."""


@app.default
def navigate(
    source: str | None = None,
    /,
    *,
    given: scenario_options.ScenarioOptions = scenario_options.DEFAULTS,
    profile: Annotated[
        str,
        Parameter(
            name="--profile",
            metavar="carter_navigation|turtlebot3|plain|FILE",
            help="Names of the robot's topics and frames: of NVIDIA's carter_navigation, of TurtleBot3, or ROS's usual "
            "names; or the YAML file of your own profile.",
        ),
    ] = "plain",
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
    (--localizer tf). With --goal it drives there and ends.

    Exit code 0: it has arrived, or without --goal it was ended; 1: it has not arrived; 3: a plug-in raised. With --json
    it prints two lines: what is offered, as soon as it is, and how it ended.

    Args:
        source: The YAML of a map or of a scenario, a world by name, or a world's file.
    """
    from trundle.ros2.names import Names
    from trundle.ros2.profile import Profile
    from trundle.ros2.remote.bridge import RemoteBridge, RemoteOptions

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
    if map_file is not None and scenario.known_map:
        raise InputError("--save-map is for a map that is made: give --localizer slam, and no map")
    with ends_as_by_ctrl_c(), ExitStack() as opened:
        transport = at.open(settings, names)
        opened.callback(transport.close)
        types = running.make_types(transport)
        kept = running.open_recording(target, scenario, types, transport, "navigate") if record else None
        if kept is not None:
            opened.enter_context(kept)
        driver, observers = opened.enter_context(
            running.open_page(scenario, source or "", float("inf"), shows=page, quiet=quiet or json, restarts=False)
        )
        facts = {"role": "navigate", "profile": profile, "localizer": locates, **told.facts}
        bridge = RemoteBridge(
            *(scenario, transport, types, names, how),
            profile=names_of,
            record=kept,
            driver=driver,
            observers=observers,
        )
        opened.enter_context(bridge)
        stops = bridge.guard.counts
        episode = running.run(bridge, facts, kept, json=json, quiet=quiet, stops=stops)
    arrived = None if bridge.drive is None else bridge.drive.arrived
    made = _write_map(episode, map_file)
    code = running.report(episode, bridge.wire, kept, json=json, stops=stops, arrived=arrived, more=made)
    return code if arrived is None else int(not arrived)


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
        changes |= {"known_map": True, "lidar": True}
    elif given.known_map:  # --no-map
        changes["lidar"] = True
    scenario = _with(given, changes).make(source or "lot", told, robot=robot)
    if source is None:
        scenario = scenario.model_copy(update={"name": Path(scenario.robot).stem})
    if not by_tf and scenario.localizer is None:
        scenario = _with(given, {**changes, "localizer": "amcl"}).make(source or "lot", nav2.Nav2Report(), robot=robot)
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
