"""What `trundle ros2 check` finds on a network: pure functions of a `Graph`, each of which makes `Finding`s."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from trundle.messages.codec import DISTROS, Codec, Distro
from trundle.messages.qos import Qos
from trundle.ros2.transport.transport import Endpoint, Graph

Status = Literal["ok", "note", "problem"]

CLOCK_TOPIC = "/clock"
_HIDDEN = ("/parameter_events", "/rosout")
"""Topics of every node, about which there is nothing to say."""

_TOOLS = ("/_ros2cli", "/_ros2_daemon", "/launch_ros", "/transform_listener_impl")
"""Beginnings of the names of nodes that need no simulated time."""

_NEEDED = {
    "sensor_msgs/msg/LaserScan": "a scan",
    "sensor_msgs/msg/PointCloud2": "a cloud",
    "nav_msgs/msg/Odometry": "odometry",
    "nav_msgs/msg/OccupancyGrid": "a map",
    "tf2_msgs/msg/TFMessage": "transforms",
}
"""Types without which a robot does not navigate; a subscription to another one often just waits."""

_COMMANDS = ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")


@dataclass(frozen=True, slots=True)
class Finding:
    """One line of the check.

    Attributes:
        about: What was looked at: "domain", "clock", or a topic's name.
        status: "ok", "note" for what may be meant to be so, "problem" for what will not work.
        detail: What was found.
        advice: What to do; empty where there is nothing to do.
    """

    about: str
    status: Status
    detail: str
    advice: str = ""


@dataclass(frozen=True, slots=True)
class ClockSeen:
    """What came on /clock while the check listened.

    Attributes:
        count: Messages.
        first_s, last_s: Simulated time [s] of the first and the last one.
        seconds: Real time [s] between these two.
        went_back: Whether a stamp was smaller than the one before it.
        sources: How many publishers they came from, as far as that is known.
        unreadable: Messages that were no times.
    """

    count: int
    first_s: float
    last_s: float
    seconds: float
    went_back: bool = False
    sources: int = 1
    unreadable: int = 0


def find_nodes(graph: Graph) -> Iterator[Finding]:
    """Find who is there."""
    others = _other_nodes(graph)
    foreign = [one for one in graph.endpoints if not one.ours]
    if others:
        yield Finding("nodes", "ok", f"{len(others)}: {_list(others, 12)}")
    elif foreign:
        yield Finding("nodes", "ok", "endpoints without a node's name: programs that speak DDS alone")
    else:
        yield Finding(
            "nodes",
            "note",
            "no other node is seen",
            "Start them with the same ROS_DOMAIN_ID. On another machine: --range subnet here, "
            "ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET there, and a firewall that lets UDP 7400 and up pass. In a "
            "container: --net=host --ipc=host",
        )


def find_clock(graph: Graph, seen: ClockSeen) -> Iterator[Finding]:
    """Find whether there is one clock that moves, and who follows it."""
    sources = [one for one in graph.publishers(CLOCK_TOPIC) if not one.ours]
    waiting = sorted({one.node for one in graph.subscriptions(CLOCK_TOPIC) if not one.ours and one.node})
    if not sources:
        if waiting:
            yield Finding(
                "clock",
                "problem",
                f"nobody publishes /clock, and {_list(waiting)} wait for it: they have use_sim_time",
                "Start the simulator (trundle ros2 serve publishes /clock), or start them with use_sim_time:=false",
            )
        else:
            yield Finding("clock", "ok", "nobody publishes /clock, and nobody waits for it: real time")
        return
    yield _judge_clock(sources, seen)
    makers = {one.node for one in sources}
    without = [node for node in _other_nodes(graph) if node not in waiting and node not in makers]
    if waiting:
        yield Finding("sim time", "ok", f"followed by {_list(waiting)}")
    if without:
        yield Finding(
            "sim time",
            "note",
            f"not followed by {_list(without)}, as far as is seen: they have no subscription to /clock",
            "Nodes that use stamps or timers need it: start them with --ros-args -p use_sim_time:=true",
        )


def _judge_clock(sources: Sequence[Endpoint], seen: ClockSeen) -> Finding:
    names = _list(sorted({one.node or one.source for one in sources}))
    if seen.sources > 1 or (seen.went_back and len(sources) > 1):
        return Finding(
            "clock",
            "problem",
            f"/clock comes from {max(seen.sources, 2)} of the {len(sources)} publishers of {names}; time jumps between "
            "them, and transforms and stamps of one are in the past or the future of the other",
            "Two simulators are on this domain: end all but one (trundle ros2 serve, Gazebo, Isaac Sim), or give each "
            "its own domain: --domain, and ROS_DOMAIN_ID of its nodes",
        )
    if seen.unreadable:
        return Finding(
            "clock",
            "problem",
            f"{seen.unreadable} messages on /clock of {names} are not a rosgraph_msgs/msg/Clock",
            "Find out which program sends them: ros2 topic info --verbose /clock",
        )
    if seen.went_back:
        return Finding(
            "clock",
            "note",
            f"/clock of {names} went back to {seen.last_s:.2f} s: the simulation was reset",
            "Nodes that keep stamps (tf buffers, AMCL) should be restarted, unless they handle such jumps",
        )
    if seen.count < 2 or seen.last_s <= seen.first_s:
        at = f"at {seen.last_s:.2f} s" if seen.count else "no message came"
        return Finding(
            "clock",
            "problem",
            f"/clock of {names} does not move ({at})",
            "The simulation is paused or hangs: continue it in its window or page, or with simulation_interfaces' "
            "SetSimulationState",
        )
    silent = len(sources) - 1
    if silent:  # as ros_gz_bridge without Gazebo, which nav2_bringup starts in any case
        names += f" (of which {silent} {'is' if silent == 1 else 'are'} silent)"
    factor = (seen.last_s - seen.first_s) / max(seen.seconds, 1e-9)
    rate = (seen.count - 1) / max(seen.seconds, 1e-9)
    return Finding("clock", "ok", f"/clock of {names}: {rate:.0f} Hz, {factor:.2f} x real time")


def find_unmatched(graph: Graph) -> Iterator[Finding]:
    """Find topics that are read and not published, or published and not read."""
    unheard: list[str] = []
    waiting: list[str] = []
    for topic, types in graph.topics().items():
        if topic in _HIDDEN or topic == CLOCK_TOPIC:
            continue
        writers, readers = graph.publishers(topic), graph.subscriptions(topic)
        if not writers and any(one.type_name in _NEEDED for one in readers):
            yield _nobody_publishes(graph, topic, readers)
        elif not writers:
            waiting.append(topic)
        elif not readers and any(kind in _COMMANDS for kind in types):
            yield Finding(
                topic,
                "problem",
                f"{_nodes(writers)} publish {_types(writers)}, and nobody reads it: no robot gets these commands",
                f"Start the robot's side (trundle ros2 serve --role simulator), or remap its topic to {topic}",
            )
        elif not readers:
            unheard.append(topic)
    if waiting:
        yield Finding("unpublished", "note", f"read, and not published by anybody: {_list(waiting, 20)}")
    if unheard:
        yield Finding("unread", "note", f"published, and not read by anybody: {_list(unheard, 20)}")


def _nobody_publishes(graph: Graph, topic: str, readers: Sequence[Endpoint]) -> Finding:
    kind = next(one.type_name for one in readers if one.type_name in _NEEDED)
    similar = sorted({one.topic for one in graph.endpoints if one.kind == "publisher" and one.type_name == kind})
    advice = f"Start what publishes {_NEEDED[kind]} there"
    if similar:
        advice = f"Of this type there are {_list(similar)}: remap one (--remap {similar[0].lstrip('/')}:={topic})"
    elif topic == "/map":
        advice = "Nav2's map_server, or trundle ros2 serve --role navigator, publishes it"
    return Finding(topic, "problem", f"{_nodes(readers)} wait for {kind}, and nobody publishes it", advice)


def find_commands(graph: Graph) -> Iterator[Finding]:
    """Find topics of commands that have several sources."""
    for topic in graph.topics():
        writers = [one for one in graph.publishers(topic) if one.type_name in _COMMANDS]
        if topic.endswith("cmd_vel") and len(writers) > 1 and graph.subscriptions(topic):
            yield Finding(
                topic,
                "note",
                f"commands come from several publishers: {_nodes(writers)}; the robot gets them mixed",
                "Put a multiplexer (twist_mux) between them, or end all but one",
            )


def find_qos(graph: Graph) -> Iterator[Finding]:
    """Find publishers and subscriptions of a topic whose QoS does not fit together."""
    for topic in graph.topics():
        for reader in graph.subscriptions(topic):
            for writer in graph.publishers(topic):
                misfits = dict(_misfits(writer.qos, reader.qos))
                if misfits and writer.type_name == reader.type_name:
                    yield Finding(
                        topic,
                        "problem",
                        f"{_node(reader)} gets nothing from {_node(writer)}: {' and '.join(misfits)}",
                        f"Let the reader ask for {' and '.join(misfits.values())}",
                    )


def _misfits(offered: Qos, wanted: Qos) -> Iterator[tuple[str, str]]:
    """Yield what does not fit together, each with what the reader should ask for."""
    if offered.reliability == "best_effort" and wanted.reliability == "reliable":
        yield (
            "it asks for reliable, and best effort is offered",
            "best effort (RViz: Topic > Reliability Policy; in code: qos_profile_sensor_data)",
        )
    if offered.durability == "volatile" and wanted.durability == "transient_local":
        yield "it asks for transient local, and volatile is offered", "volatile (RViz: Topic > Durability Policy)"


def find_types(graph: Graph, distro: Distro) -> Iterator[Finding]:
    """Find topics whose ends have different types, and types that are those of another distribution."""
    for topic, types in graph.topics().items():
        writers = {one.type_name for one in graph.publishers(topic)}
        readers = [one for one in graph.subscriptions(topic) if one.type_name not in writers]
        # A robot that takes both types of commands has two subscriptions.
        taken = {one.node for one in graph.subscriptions(topic) if one.type_name in writers}
        left_out = [one for one in readers if one.node not in taken]
        if writers and left_out:
            stamped = set(types) == set(_COMMANDS)
            yield Finding(
                topic,
                "problem",
                f"{_nodes(left_out)} read {_types(left_out)}, and {', '.join(sorted(writers))} is published",
                "From Kilted on, Nav2 sends TwistStamped: set enable_stamped_cmd_vel, or stamped in the driver"
                if stamped
                else "One of the two has the wrong name: remap it",
            )
    yield from _find_hashes(graph, distro)


def _find_hashes(graph: Graph, distro: Distro) -> Iterator[Finding]:
    codecs: dict[Distro, Codec] = {}

    def hash_in(distro: Distro, type_name: str) -> str:
        if distro not in codecs:
            codecs[distro] = Codec(distro)
        return codecs[distro].type_hash(type_name) if type_name in codecs[distro] else ""

    strange: dict[str, set[str]] = {}
    silent: set[str] = set()
    for one in graph.endpoints:
        if one.ours or one.topic in _HIDDEN:
            continue
        if not one.type_hash:
            silent.add(one.node or one.source)
            continue
        expected = hash_in(distro, one.type_name)
        if expected and expected != one.type_hash:
            fitting = [other for other in DISTROS if hash_in(other, one.type_name) == one.type_hash]
            strange.setdefault(", ".join(fitting) or "no distribution that is known", set()).add(one.topic)
    for names, topics in strange.items():
        known = not names.startswith("no ")
        yield Finding(
            "types",
            "problem",
            f"{_list(sorted(topics))}: the other side has the types of {names}, and here they are {distro}'s",
            f"Give --distro {names.partition(',')[0]}" if known else "Its messages cannot be read safely",
        )
    if silent and distro != "humble":
        yield Finding(
            "types",
            "note",
            f"{_list(sorted(silent))}: no type hashes, as on Humble",
            "If that is a ROS of Humble, give --distro humble",
        )


def find_unanswered(graph: Graph) -> Iterator[Finding]:
    """Find services and actions that somebody asks for and nobody serves."""
    served = {(one.kind.split()[0], one.name) for one in graph.offers if one.kind.endswith("server")}
    for one in graph.offers:
        what = one.kind.split()[0]
        if one.kind.endswith("client") and not one.ours and (what, one.name) not in served:
            yield Finding(
                one.name,
                "problem",
                f"{one.node or 'a client'} wants the {what} {one.type_name}, and nobody serves it: it waits",
                "trundle ros2 serve --role navigator --transport rclpy serves Nav2's; for others start their node",
            )


CHECKS: tuple[Callable[[Graph], Iterator[Finding]], ...] = (find_unmatched, find_commands, find_qos, find_unanswered)
"""The checks that need nothing but the graph."""


def _other_nodes(graph: Graph) -> list[str]:
    ours = {one.node for one in graph.endpoints if one.ours}
    return [node for node in graph.nodes if node not in ours and not node.startswith(_TOOLS)]


def _node(endpoint: Endpoint) -> str:
    return endpoint.node or endpoint.source or "a program without a node"


def _nodes(endpoints: Sequence[Endpoint]) -> str:
    return _list(sorted({_node(one) for one in endpoints}))


def _types(endpoints: Sequence[Endpoint]) -> str:
    return ", ".join(sorted({one.type_name for one in endpoints}))


def _list(names: Sequence[str], most: int = 6) -> str:
    """Join names with commas, and count those that are too many."""
    shown = ", ".join(names[:most])
    return f"{shown} and {len(names) - most} more" if len(names) > most else shown
