"""What the bridge offers on the network, as a table and as JSON."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from trundle.cli.shared import output

if TYPE_CHECKING:
    from trundle.messages.qos import Qos
    from trundle.ros2.transport.transport import Transport
    from trundle.ros2.wire import Wire


def describe(wire: Wire, settings: Mapping[str, object]) -> dict[str, object]:
    """Everything that is published, read and served, with the node, the domain and what is off.

    Args:
        wire: The bridge's.
        settings: What else is to be said first: the role, the profile …
    """
    transport = wire.transport
    return {
        **settings,
        **_place(transport),
        "publishes": _topics((one.topic, one.type_name, one.qos) for one in wire.outlets),
        "reads": _topics((one.topic, one.type_name, one.qos) for one in wire.inlets),
        "services": _named(wire.services),
        "actions": _named(wire.actions),
        "not_served": sorted(wire.missing),
        "notes": notes(transport),
    }


def show(offer: Mapping[str, object], wire: Wire) -> None:
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
        ("publishes", [(one.topic, one.type_name, _quality(one.qos)) for one in wire.outlets]),
        ("reads", [(one.topic, one.type_name, _quality(one.qos)) for one in wire.inlets]),
        ("services", [(name, kind, None) for name, kind in wire.services]),
        ("actions", [(name, kind, None) for name, kind in wire.actions]),
    ):
        if rows:
            print()
            output.print_table((title, "type", "qos" if rows[0][2] else ""), [_filled(row) for row in sorted(rows)])
    if wire.missing:
        print(f"\nnot served: {len(wire.missing)} services and actions, which --json lists")
    print(end="", flush=True)


def notes(transport: Transport) -> list[str]:
    """What the user should know of the network: what is off, what is bound where, which variables are overruled."""
    return [*transport.settings.notes, *transport.notes]


def _place(transport: Transport) -> dict[str, object]:
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


def _topics(rows: Iterable[tuple[str, str, Qos]]) -> list[dict[str, object]]:
    return [
        {"topic": topic, "type": kind, "reliability": qos.reliability, "durability": qos.durability, "depth": qos.depth}
        for topic, kind, qos in sorted(rows, key=lambda row: row[:2])
    ]


def _named(rows: Iterable[tuple[str, str]]) -> list[dict[str, str]]:
    return [{"name": name, "type": kind} for name, kind in sorted(rows)]


def _quality(qos: Qos) -> str:
    latched = ", transient local" if qos.durability == "transient_local" else ""
    return f"{qos.reliability.replace('_', ' ')}{latched}"


def _filled(row: tuple[str, str, str | None]) -> tuple[str, str, str]:
    return row[0], row[1], row[2] or ""
