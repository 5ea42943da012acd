"""Looks at a network of ROS 2 for `trundle ros2 check`: the setting of this machine, and who is there."""

from __future__ import annotations

import time as clock
from collections.abc import Iterator

from trundle.errors import InputError
from trundle.messages.codec import Codec
from trundle.messages.qos import Qos
from trundle.messages.readers import read_stamp
from trundle.ros2 import findings
from trundle.ros2.findings import CLOCK_TOPIC, ClockSeen, Finding
from trundle.ros2.transport.domain import Settings
from trundle.ros2.transport.opening import why_not
from trundle.ros2.transport.transport import Transport

_CLOCK_TYPE = "rosgraph_msgs/msg/Clock"
_EVERY_CLOCK = Qos(100, "best_effort")
"""It is as deep as this for several clocks whose messages come at once."""

_LOOK_S = 0.1


def check_setup(settings: Settings, python: str | None = None) -> Iterator[Finding]:
    """Report the environment, and which transports can be used.

    Args:
        settings: The settings, as they were read.
        python: The Python of the sourced ROS. If None, it is looked for.
    """
    variables = ", ".join(f"{name}={value}" for name, value in settings.variables)
    yield Finding("domain", "ok", f"{settings.domain} ({_source(settings, 'domain', 'ROS_DOMAIN_ID')})")
    yield Finding("distribution", "ok", f"{settings.distro} ({_source(settings, 'distro', 'ROS_DISTRO')})")
    yield Finding("range", "ok", settings.range)
    yield Finding("environment", "ok", variables or "no variable of ROS is set")
    for note in settings.notes:
        yield Finding("environment", "note", note)
    no_dds, no_rclpy = why_not("dds"), why_not("rclpy", python=python)
    yield Finding("rclpy", "note" if no_rclpy else "ok", no_rclpy or "topics, services and actions")
    yield Finding("dds", "note" if no_dds else "ok", no_dds or "topics alone, without a ROS installation")


def _source(settings: Settings, name: str, variable: str) -> str:
    if name in settings.given:
        return f"--{name}"
    return f"from {variable}" if variable in dict(settings.variables) else "the default"


def check_network(transport: Transport, *, wait_s: float) -> Iterator[Finding]:
    """Report who is on the network, and what does not fit together.

    Args:
        transport: A node that publishes nothing.
        wait_s: How long to listen [s].
    """
    yield Finding("transport", "ok", f"{transport.name} ({transport.rmw}), node {transport.node}")
    for note in transport.notes:
        yield Finding("transport", "note", note)
    seen = watch_clock(transport, wait_s)
    if transport.lost:
        yield Finding("transport", "problem", transport.lost)
        return
    graph = transport.graph()
    yield from findings.find_nodes(graph)
    yield from findings.find_clock(graph, seen)
    yield from findings.find_types(graph, transport.distro)
    for check in findings.CHECKS:
        yield from check(graph)


def watch_clock(transport: Transport, wait_s: float) -> ClockSeen:
    """Listen to /clock for a while."""
    codec = Codec(transport.distro)
    subscription = transport.subscription(CLOCK_TOPIC, _CLOCK_TYPE, _EVERY_CLOCK)
    count, first_s, last_s, went_back = 0, 0.0, 0.0, False
    sources: set[str] = set()
    unreadable = 0
    began = came_first = came_last = clock.monotonic()
    while (left := began + wait_s - clock.monotonic()) > 0.0 and not transport.lost:
        transport.wait(min(left, _LOOK_S))
        for sample in subscription.take():
            try:
                now_s = read_stamp(codec.decode(_CLOCK_TYPE, sample.data).clock)
            except InputError:
                unreadable += 1
                continue
            came_last = clock.monotonic()
            sources.add(sample.source)
            if not count:
                first_s, came_first = now_s, came_last
            went_back |= count > 0 and now_s < last_s
            count, last_s = count + 1, now_s
    return ClockSeen(count, first_s, last_s, came_last - came_first, went_back, len(sources), unreadable)
