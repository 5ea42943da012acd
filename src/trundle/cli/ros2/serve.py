"""`trundle ros2 serve`: a robot, its lidars, clock and map on the network of ROS 2."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

from cyclopts import App, Parameter

from trundle.cli.ros2 import network
from trundle.cli.shared import browser, isaac, nav2, options, output, scenario_options
from trundle.cli.shared.termination import ends_as_by_ctrl_c
from trundle.errors import InputError
from trundle.extras import check_extra
from trundle.values import first_names

if TYPE_CHECKING:
    from trundle.messages.qos import Qos
    from trundle.mission import Episode, Mission, Observer, Scenario
    from trundle.ros2.record import WireRecord
    from trundle.ros2.transport.transport import Transport
    from trundle.ros2.types import Types
    from trundle.ros2.wire import Wire
    from trundle.serve.steerer import Steerer

FILE = "wire.mcap"
_FAILED = "the simulator failed"
"""How a session's message begins where its simulator raised an error."""

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


@app.default
def serve(
    source: str = "warehouse",
    /,
    *,
    given: scenario_options.ScenarioOptions = scenario_options.DEFAULTS,
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
    record: Annotated[
        bool,
        Parameter(
            name="--record", negative="", help=f"Also write {FILE}, a rosbag2 of all topics, written and received."
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
    """Put a robot, its lidars, clock and map on the network of ROS 2; Ctrl-C ends it.

    Needs no ROS installation for topics. Services and actions go through the rclpy of a sourced ROS. Prints what is
    published, read and served. Only programs on this machine see it, unless --range subnet is given.

    Exit code 0: it was ended, by Ctrl-C, SIGTERM, the page or a time limit; 1: the simulator failed; 3: a plug-in
    raised. With --json it prints two lines: what is offered, as soon as it is, and how it ended.

    Args:
        source: A world by name, the YAML of a map or of a scenario, or a world's file.
    """
    from trundle.ros2.bridge import Bridge
    from trundle.ros2.names import Names
    from trundle.ros2.profile import Profile

    network.check_extra()
    factor = options.parse_speed(speed)
    settings, names = at.read(), Names(namespace=namespace, remaps=remap or ())
    target = _target(out, record=record, overwrite=overwrite)
    names_of = Profile.load(profile)
    told = nav2.Nav2Report()
    scenario = given.make(source, told, robot=names_of.robot)
    told.tell(quiet=quiet)
    with ends_as_by_ctrl_c(), ExitStack() as opened:
        opened.enter_context(isaac.start_for(scenario))
        transport = at.open(settings, names)
        opened.callback(transport.close)
        types = _types(transport)
        bag = opened.enter_context(_recording(target, scenario, types, transport, role)) if record else None
        driver, observers = opened.enter_context(_page(scenario, source, factor, shows=page, quiet=quiet or json))
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
        settings_of_run = {"role": role, "profile": profile, "speed": factor, **told.facts}
        try:
            _announce(bridge.wire, settings_of_run, bag, json=json, quiet=quiet)
            episode = bridge.run()
        except KeyboardInterrupt:  # before the run began, or after it ended
            episode = None
        except BaseException:
            session = bridge.context.session
            if session is not None:
                _report(session.finish(), bridge.wire, bag, json=json)
            raise
    return _report(episode, bridge.wire, bag, json=json)


def _target(out: Path | None, *, record: bool, overwrite: bool) -> Path | None:
    """Return the file that `--out` names for the recording; None stands for a new folder."""
    if not record:
        if out is not None:
            raise InputError(f"--out {out} is for a recording: give --record with it")
        return None
    check_extra("record", "--record")
    from trundle.bags.recorder import check_free

    if out is None:
        return None
    target = options.output_file(out, FILE, (".mcap",))
    if not overwrite:
        check_free(target)
    return target


def _recording(target: Path | None, scenario: Scenario, types: Types, transport: Transport, role: str) -> WireRecord:
    from trundle.files.writing import new_folder
    from trundle.ros2.record import WireRecord

    facts = {"role": role, "node": transport.node, "transport": transport.name, "rmw": transport.rmw}
    path = new_folder("runs", scenario.title) / FILE if target is None else target
    return WireRecord(path, transport.distro, types, facts=facts, overwrite=True)


@contextmanager
def _page(
    scenario: Scenario, source: str, speed: float, *, shows: bool, quiet: bool
) -> Iterator[tuple[Steerer | None, Callable[[Mission, int], Sequence[Observer]] | None]]:
    """Yield what drives the runs and what shows them in the browser; both are None if no page is wanted."""
    if not shows:
        yield None, None
        return
    from trundle.serve.steerer import Steerer
    from trundle.serve.watch import Watch

    with browser.serving(scenario, source=source) as page:
        page.hub.controls = steerer = Steerer(speed=speed)

        def observers(mission: Mission, number: int) -> Sequence[Observer]:
            watch = Watch(page.hub, number, None, world=lambda: mission.sim.world, steering=steerer.steering)
            return [watch, watch.recorded]

        browser.announce(page, quiet=quiet)
        yield steerer, observers


def _types(transport: Transport) -> Types:
    from trundle.messages.codec import Codec
    from trundle.ros2.types import Types

    return Types(Codec(transport.distro), transport)


def _announce(wire: Wire, settings: dict[str, object], record: WireRecord | None, *, json: bool, quiet: bool) -> None:
    """Print what is offered, and what is not."""
    recording = None if record is None else record.path
    offer = describe_offer(wire, {**settings, "recording": recording})
    if json:
        output.print_json_line(offer)
        return
    _print_offer(offer, wire)
    for note in _notes(wire.transport):
        output.remark(note, quiet=quiet)
    if recording is not None:
        output.remark(f"Recording what goes over the wire into {recording}", quiet=quiet)
    output.remark("Ctrl-C ends it", quiet=quiet)


def _report(episode: Episode | None, wire: Wire, record: WireRecord | None, *, json: bool) -> int:
    """Print how it ended; returns the exit code."""
    code = 1 if episode is not None and episode.message.startswith(_FAILED) else 0
    metrics = None if episode is None else episode.metrics
    facts: dict[str, object] = {
        "outcome": "aborted" if episode is None else episode.outcome.value,
        "message": "stopped by Ctrl-C" if episode is None else episode.message,
        "time_s": 0.0 if metrics is None else metrics.time_s,
        "distance_m": 0.0 if metrics is None else metrics.distance_m,
        "real_time_factor": 0.0 if metrics is None else metrics.real_time_factor,
        "contacts": [] if metrics is None else list(metrics.contacts),
        "warnings": wire.warnings.counts,
        "recording": None if record is None else record.path,
        "messages": None if record is None else record.messages,
        "recording_error": (record.error or None) if record is not None else None,
    }
    if json:
        output.print_json_line(facts)
        return code
    shown = {"ended": facts["message"] or facts["outcome"]}
    if metrics is not None:
        shown |= {
            "simulated time": f"{metrics.time_s:.1f} s, {metrics.real_time_factor:.2f} x real time",
            "distance": f"{metrics.distance_m:.2f} m",
            "contacts": first_names(metrics.contacts) or "none",
        }
    if wire.warnings.counts:
        shown["dropped"] = wire.warnings.summary()
    if record is not None:
        shown["recording"] = f"{record.path}, {record.messages} messages"
    print()
    output.print_facts(shown)
    return code


def describe_offer(wire: Wire, settings: Mapping[str, object]) -> dict[str, object]:
    """Describe what is published, read and served, with the node, the domain and what is off.

    Args:
        wire: The bridge's connection to the network.
        settings: Further facts, which come first: the role, the profile, …
    """
    transport = wire.transport
    return {
        **settings,
        **_describe_node(transport),
        "publishes": _describe_topics((one.topic, one.type_name, one.qos) for one in wire.outlets),
        "reads": _describe_topics((one.topic, one.type_name, one.qos) for one in wire.inlets),
        "services": _describe_services(wire.services),
        "actions": _describe_services(wire.actions),
        "not_served": sorted(wire.missing),
        "notes": _notes(transport),
    }


def _print_offer(offer: Mapping[str, object], wire: Wire) -> None:
    """Print a description for people."""
    transport = wire.transport
    settings = transport.settings
    output.print_facts(
        {
            "role": f"{offer['role']}, profile {offer['profile']}",
            "node": transport.node,
            "domain": f"{settings.domain}, distribution {transport.distro}, {settings.range}",
            "transport": f"{transport.name} ({transport.rmw})",
        }
    )
    for title, rows in (
        ("publishes", [(one.topic, one.type_name, _describe_qos(one.qos)) for one in wire.outlets]),
        ("reads", [(one.topic, one.type_name, _describe_qos(one.qos)) for one in wire.inlets]),
        ("services", [(name, kind, None) for name, kind in wire.services]),
        ("actions", [(name, kind, None) for name, kind in wire.actions]),
    ):
        if rows:
            print()
            output.print_table((title, "type", "qos" if rows[0][2] else ""), [_filled(row) for row in sorted(rows)])
    if wire.missing:
        print(f"\nnot served: {len(wire.missing)} services and actions, which --json lists")
    print(end="", flush=True)


def _notes(transport: Transport) -> list[str]:
    """Return what the user should know of the network: what is off, and which variables are overruled."""
    return [*transport.settings.notes, *transport.notes]


def _describe_node(transport: Transport) -> dict[str, object]:
    settings = transport.settings
    return {
        "node": transport.node,
        "domain": settings.domain,
        "distro": transport.distro,
        "range": settings.range,
        "transport": transport.name,
        "rmw": transport.rmw,
        "variables": dict(settings.variables),
    }


def _describe_topics(rows: Iterable[tuple[str, str, Qos]]) -> list[dict[str, object]]:
    return [
        {"topic": topic, "type": kind, "reliability": qos.reliability, "durability": qos.durability, "depth": qos.depth}
        for topic, kind, qos in sorted(rows, key=lambda row: row[:2])
    ]


def _describe_services(rows: Iterable[tuple[str, str]]) -> list[dict[str, str]]:
    return [{"name": name, "type": kind} for name, kind in sorted(rows)]


def _describe_qos(qos: Qos) -> str:
    latched = ", transient local" if qos.durability == "transient_local" else ""
    return f"{qos.reliability.replace('_', ' ')}{latched}"


def _filled(row: tuple[str, str, str | None]) -> tuple[str, str, str]:
    return row[0], row[1], row[2] or ""
