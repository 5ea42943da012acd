"""`trundle ros2 serve`: a robot, its lidars, clock and map on the network of ROS 2."""

from __future__ import annotations

from contextlib import ExitStack
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import App, Parameter

from trundle.cli.ros2 import network, running
from trundle.cli.shared import isaac, nav2, options, scenario_options
from trundle.cli.shared.termination import ends_as_by_ctrl_c
from trundle.errors import InputError, TrundleError
from trundle.geometry import Goal

if TYPE_CHECKING:
    from trundle.mission import SetGoal, SetGoals, TaskEnd
    from trundle.ros2.wire import Wire

app = App(
    name="serve",
    version_flags=[],
    help_epilogue=(
        "Examples:\n"
        "  trundle ros2 serve warehouse --profile turtlebot3\n"
        "  trundle ros2 serve carter_warehouse_navigation.yaml --profile carter_navigation\n"
        "  trundle ros2 serve map.yaml --role navigator --transport rclpy --record\n"
        "  trundle ros2 serve office --namespace robot1 --remap scan:=lidar --speed 2 --browser"
    ),
)


@Parameter(name="*")
class ServeOptions(
    scenario_options.adapted_options(
        {
            "goals": "With --role navigator: where the robot drives first; repeat it for several goals in order; "
            "default: it waits for goals.",
        }
    )
):
    """The options of a mission, which waits for goals."""


@app.default
def serve(
    source: str = "warehouse",
    /,
    *,
    given: ServeOptions = ServeOptions(),  # noqa: B008 - it is frozen
    role: Annotated[
        Literal["simulator", "navigator"],
        Parameter(
            name="--role",
            help="simulator: other programs drive the robot by /cmd_vel; navigator: trundle drives, and takes goals as "
            "Nav2 does.",
        ),
    ] = "simulator",
    profile: Annotated[
        str,
        Parameter(
            name="--profile",
            metavar="carter_navigation|turtlebot3|plain|FILE",
            help="Names of topics, frames and sensors, and the robot: of NVIDIA's carter_navigation, of TurtleBot3's "
            "tb3_simulation_launch.py, or ROS's usual names; or the YAML file of your own profile.",
        ),
    ] = "plain",
    at: network.NetworkOptions = network.DEFAULTS,
    namespace: network.Namespace = "",
    remap: network.Remaps = None,
    speed: Annotated[
        str,
        Parameter(
            name="--speed",
            allow_leading_hyphen=True,
            metavar="FACTOR|max",
            help="Simulated seconds per second, 0.1 to 50, or max; /clock follows it.",
        ),
    ] = "1",
    static_frames: network.StaticFrames = "auto",
    record: running.Record = False,
    out: running.RecordOut = None,
    overwrite: options.OverwriteFile = False,
    page: running.Page = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> int:
    """Put a robot, its lidars, clock and map on the network of ROS 2; Ctrl-C ends it.

    Needs no ROS installation for topics. Services and actions go through the rclpy of a sourced ROS. Prints what is
    published, read and served. Only programs on this machine see it, unless --range subnet is given.

    With --role navigator and --goal the robot drives there first, and then waits for other goals.

    Exit code 0: it was ended, by Ctrl-C, SIGTERM, the page or a time limit; 1: the simulator failed; 3: a plug-in
    raised. With --json it prints two lines: what is offered, as soon as it is, and how it ended.

    Args:
        source: A world by name, the YAML of a map or of a scenario, or a world's file.
    """
    from trundle.ros2.bridge import Bridge
    from trundle.ros2.names import Names
    from trundle.ros2.profile import Profile

    network.check_extra()
    drive = _read_drive(given, role)
    factor = options.parse_speed(speed)
    settings, names = at.read(), Names(namespace=namespace, remaps=remap or ())
    target = running.recording_target(out, record=record, overwrite=overwrite)
    names_of = Profile.load(profile)
    told = nav2.Nav2Report()
    scenario = given.make(source, told, robot=names_of.robot, instead={"lidar": True})
    told.tell(quiet=quiet)
    with ends_as_by_ctrl_c(), ExitStack() as opened:
        opened.enter_context(isaac.start_for(scenario))
        transport = at.open(settings, names)
        opened.callback(transport.close)
        types = running.make_types(transport)
        bag = opened.enter_context(running.open_recording(target, scenario, types, transport, role)) if record else None
        driver, observers = opened.enter_context(
            running.open_page(scenario, source, factor, shows=page, quiet=quiet or json)
        )
        bridge = Bridge(
            scenario,
            transport,
            types,
            names,
            role=role,
            profile=names_of,
            speed=factor,
            record=bag,
            driver=driver,
            observers=observers,
            static_frames=static_frames,
        )
        opened.enter_context(bridge)
        if drive is not None:
            bridge.context.driver.steering.put(drive, by="--goal", watcher=_DriveReport(bridge.wire))
        settings_of_run = {"role": role, "profile": profile, "speed": factor, **told.facts}
        episode = running.run(bridge, settings_of_run, bag, json=json, quiet=quiet)
    return running.report(episode, bridge.wire, bag, json=json)


class _DriveReport:
    """Says what becomes of the drive to --goal."""

    def __init__(self, wire: Wire) -> None:
        self._wire = wire

    def begin(self, time: float) -> None:
        """Do nothing: the robot drives."""

    def refuse(self, error: TrundleError) -> None:
        """Say why it does not."""
        self._wire.warn("--goal: refused", f"--goal is refused: {error}")

    def end(self, end: TaskEnd) -> None:
        """Say how the drive has ended."""
        has_arrived = end.result == "succeeded"
        how = "the robot has arrived" if has_arrived else f"the drive has ended: {end.message or end.result}"
        self._wire.warnings.note(f"--goal: {how}")


def _read_drive(given: scenario_options.ScenarioOptions, role: str) -> SetGoal | SetGoals | None:
    """Return the drive to --goal; None without that.

    Raises:
        InputError: If trundle does not drive, or a goal cannot be read.
    """
    from trundle.mission import SetGoal, SetGoals

    if not given.goals:
        return None
    if role != "navigator":
        raise InputError("--goal is for --role navigator: with --role simulator other programs drive the robot")
    goals = tuple(Goal.of(options.parse_goal("--goal", text)) for text in given.goals)
    return SetGoal(goals[0]) if len(goals) == 1 else SetGoals(goals, through=given.through)
