"""What `serve` and `navigate` share: recording, the page, what is printed at the start and at the end."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, TypeAlias

from cyclopts import Parameter

from trundle.cli.shared import browser, options, output
from trundle.errors import InputError
from trundle.extras import check_extra
from trundle.values import first_names

if TYPE_CHECKING:
    from trundle.messages.qos import Qos
    from trundle.mission import Episode, Mission, Observer, Scenario
    from trundle.ros2.record import WireRecord
    from trundle.ros2.runs import NetworkRuns
    from trundle.ros2.transport.transport import Transport
    from trundle.ros2.types import Types
    from trundle.ros2.wire import Wire
    from trundle.serve.steerer import Steerer

FILE = "wire.mcap"
Record: TypeAlias = Annotated[
    bool,
    Parameter(name="--record", negative="", help=f"Also write {FILE}, a rosbag2 of all topics, written and received."),
]
RecordOut: TypeAlias = Annotated[
    Path | None, Parameter(name=["--out", "-o"], help="File or folder of --record; default: a new folder under runs.")
]
Page: TypeAlias = Annotated[
    bool, Parameter(name="--browser", negative="", help="Also show it in the browser, where it can be steered.")
]

_FAILED = "the simulator failed"
"""How a session's message begins where its simulator raised an error."""


def recording_target(out: Path | None, *, record: bool, overwrite: bool) -> Path | None:
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


def open_recording(
    target: Path | None, scenario: Scenario, types: Types, transport: Transport, role: str
) -> WireRecord:
    """Open the recording of a bridge, in a new folder if no file is given."""
    from trundle.files.writing import new_folder
    from trundle.ros2.record import WireRecord

    facts = {"role": role, "node": transport.node, "transport": transport.name, "rmw": transport.rmw}
    path = new_folder("runs", scenario.title) / FILE if target is None else target
    return WireRecord(path, transport.distro, types, facts=facts, overwrite=True)


@contextmanager
def open_page(
    scenario: Scenario, source: str, speed: float, *, shows: bool, quiet: bool, lacks: Sequence[str] = ()
) -> Iterator[tuple[Steerer | None, Callable[[Mission, int], Sequence[Observer]] | None]]:
    """Yield what drives the runs and what shows them in the browser; both are None if no page is wanted.

    Args:
        scenario: What is driven.
        source: What it was made of.
        speed: How fast it passes at first.
        shows: Whether a page is wanted.
        quiet: Without remarks.
        lacks: What cannot be done with what is driven: "restart", "box", "speed", "find".
    """
    if not shows:
        yield None, None
        return
    from trundle.serve.run_feed import Watch
    from trundle.serve.steerer import Steerer

    with browser.serving(scenario, source=source) as page:
        page.hub.controls = steerer = Steerer(speed=speed, restarts="restart" not in lacks)
        page.hub.lacks = tuple(lacks)

        def observers(mission: Mission, number: int) -> Sequence[Observer]:
            watch = Watch(page.hub, number, None, world=lambda: mission.sim.world, steering=steerer.steering)
            return [watch, watch.recorded]

        browser.announce(page, quiet=quiet)
        yield steerer, observers


def make_types(transport: Transport) -> Types:
    """Make the messages of a transport's distribution."""
    from trundle.messages.codec import Codec
    from trundle.ros2.types import Types

    return Types(Codec(transport.distro), transport)


def run(
    bridge: NetworkRuns,
    settings: dict[str, object],
    record: WireRecord | None,
    *,
    json: bool,
    quiet: bool,
    stops: Mapping[str, int] | None = None,
) -> Episode | None:
    """Print what is offered, and drive to the end; None where Ctrl-C came before a run began.

    Raises:
        BaseException: What a plug-in raised; how it ended is printed then.
    """
    try:
        announce(bridge.wire, settings, record, json=json, quiet=quiet)
        return bridge.run()
    except KeyboardInterrupt:  # before the run began, or after it ended
        return None
    except BaseException:
        session = bridge.context.session
        if session is not None:
            report(session.finish(), bridge.wire, record, json=json, stops=stops)
        raise


def announce(wire: Wire, settings: dict[str, object], record: WireRecord | None, *, json: bool, quiet: bool) -> None:
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


def report(
    episode: Episode | None,
    wire: Wire,
    record: WireRecord | None,
    *,
    json: bool,
    stops: Mapping[str, int] | None = None,
    arrived: bool | None = None,
    more: Mapping[str, object] | None = None,
) -> int:
    """Print how it ended; returns the exit code.

    Args:
        episode: The last run; None where none was finished.
        wire: The connection to the network.
        record: What was recorded.
        json: Whether it is printed as JSON.
        stops: How often the robot had to stand, for each kind of reason; None where nothing watches that.
        arrived: Whether the robot has arrived at its goals; None where it had none.
        more: What else there is to say; those that are None are for JSON alone.
    """
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
        **({} if stops is None else {"stops": dict(stops), "arrived": arrived}),
        **(more or {}),
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
    shown |= {name: value for name, value in (more or {}).items() if value is not None}
    if stops:
        shown["stood"] = ", ".join(f"{kind} ({count})" for kind, count in stops.items())
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
