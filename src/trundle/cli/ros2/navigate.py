"""`trundle ros2 navigate`: trundle's navigator on a robot that is somewhere else in ROS 2."""

from __future__ import annotations

from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Literal, cast

from cyclopts import App, Parameter

from trundle.cli.ros2 import network, running
from trundle.cli.shared import nav2, options, scenario_options
from trundle.cli.shared.field_options import option_name
from trundle.cli.shared.termination import ends_as_by_ctrl_c
from trundle.errors import InputError
from trundle.geometry import Goal

app = App(
    name="navigate",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle ros2 navigate map.yaml --robot turtlebot3_burger --start 0,0,0\n"
        "  trundle ros2 navigate map.yaml --robot robot.yaml --start 0,0,0 --goal 4,2 --record\n"
        "  trundle ros2 navigate map.yaml --robot nova_carter --localizer tf --browser"
    ),
)

_SIMULATED = ("backend", "lidar_errors", "odometry", "start_error", "map_errors", "isaac_options", "agent", "lidar")
"""Options of `trundle run` that say how a robot is simulated."""


@app.default
def navigate(
    source: str,
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
    static_frames: Annotated[
        Literal["auto", "always", "never"],
        Parameter(
            name="--static-frames",
            help="Publish where the lidars are on the robot: where nobody else does (auto), always, or never.",
        ),
    ] = "auto",
    at: network.NetworkOptions = network.DEFAULTS,
    namespace: Annotated[str, Parameter(name="--namespace", help="Namespace of all relative names: robot1.")] = "",
    remap: Annotated[
        list[str] | None,
        Parameter(
            name="--remap",
            negative="",
            metavar="FROM:=TO",
            help="Rename a topic, service or action as ROS does: scan:=front/scan; __node:=NAME renames the node; "
            "repeatable.",
        ),
    ] = None,
    record: Annotated[
        bool,
        Parameter(
            name="--record",
            negative="",
            help=f"Also write {running.FILE}, a rosbag2 of all topics, written and received.",
        ),
    ] = False,
    out: Annotated[
        Path | None,
        Parameter(name=["--out", "-o"], help="File or folder of --record; default: a new folder under runs."),
    ] = None,
    overwrite: options.OverwriteFile = False,
    page: Annotated[
        bool, Parameter(name="--browser", negative="", help="Also show it in the browser, where it can be steered.")
    ] = False,
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
    names_of = Profile.load(profile)
    told = nav2.Nav2Report()
    by_tf = given.localizer == "tf"
    scenario = _with_localizer(given, None if by_tf else given.localizer).make(source, told, robot=names_of.robot)
    if not by_tf and scenario.localizer is None:
        scenario = _with_localizer(given, "amcl").make(source, nav2.Nav2Report(), robot=names_of.robot)
    told.tell(quiet=quiet)
    how = RemoteOptions(
        localizer="tf" if by_tf else None,
        start=options.parse_pose("--start", given.start) if given.start else None,
        goals=tuple(Goal.of(options.parse_goal("--goal", text)) for text in given.goals or ()),
        static_frames=static_frames,
    )
    if by_tf and how.start is not None:
        raise InputError("--start is for a localizer; with --localizer tf the robot is where map → odom puts it")
    if given.localizer == "odometry" and how.start is None:
        raise InputError("--localizer odometry needs --start X,Y,YAW: nothing else says where the robot is")
    with ends_as_by_ctrl_c(), ExitStack() as opened:
        transport = at.open(settings, names)
        opened.callback(transport.close)
        types = running.make_types(transport)
        bag = (
            opened.enter_context(running.open_recording(target, scenario, types, transport, "navigate"))
            if record
            else None
        )
        driver, observers = opened.enter_context(
            running.open_page(scenario, source, float("inf"), shows=page, quiet=quiet or json, restarts=False)
        )
        bridge = RemoteBridge(
            scenario,
            transport,
            types,
            names,
            how,
            profile=names_of,
            record=bag,
            driver=driver,
            observers=observers,
        )
        opened.enter_context(bridge)
        locates = "tf" if by_tf or scenario.localizer is None else scenario.localizer.name
        facts = {"role": "navigate", "profile": profile, "localizer": locates, **told.facts}
        try:
            running.announce(bridge.wire, facts, bag, json=json, quiet=quiet)
            episode = bridge.run()
        except KeyboardInterrupt:  # before the run began, or after it ended
            episode = None
        except BaseException:
            session = bridge.context.session
            if session is not None:
                running.report(session.finish(), bridge.wire, bag, json=json, stops=bridge.guard.counts)
            raise
    arrived = None if bridge.drive is None else bridge.drive.arrived
    code = running.report(episode, bridge.wire, bag, json=json, stops=bridge.guard.counts, arrived=arrived)
    return code if arrived is None else int(not arrived)


def _with_localizer(given: scenario_options.ScenarioOptions, localizer: str | None) -> scenario_options.ScenarioOptions:
    return replace(cast("Any", given), localizer=localizer)


def _refuse_simulated(given: scenario_options.ScenarioOptions) -> None:
    """Refuse options that say how a robot is simulated: this one is not."""
    defaults = scenario_options.DEFAULTS
    for name in _SIMULATED:
        if getattr(given, name) != getattr(defaults, name):
            raise InputError(
                f"{option_name(name)} is for simulated robots; trundle ros2 navigate drives one that is somewhere else"
            )
