"""Cyclone's domains: one for each number in a process, with its own threads, shared by those that join it."""

# Cyclone DDS has no wheel for some Pythons and machines.
# pyright: reportMissingImports=false

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from trundle.errors import InputError
from trundle.ros2.transport.dds.domain_xml import domain_xml
from trundle.ros2.transport.dds.library import delete
from trundle.ros2.transport.domain import Settings

if TYPE_CHECKING:
    from cyclonedds.domain import Domain

_joined: dict[int, tuple[Domain, str, int]] = {}
"""Of each number: the domain, its configuration, and how many use it."""

_lock = threading.Lock()


def join(settings: Settings) -> None:
    """Open a domain, or use the one that is open.

    Raises:
        InputError: If it is open with another range, or its configuration cannot be used.
    """
    from cyclonedds.core import DDSException
    from cyclonedds.domain import Domain

    xml = domain_xml(settings)
    with _lock:
        if settings.domain in _joined:
            domain, other, users = _joined[settings.domain]
            if other != xml:
                raise InputError(
                    f"domain {settings.domain} is open in this process with another range or configuration"
                )
        else:
            try:
                domain, users = Domain(settings.domain, xml), 0
            except DDSException as error:
                more = ", or CYCLONEDDS_URI has a fault" if settings.cyclonedds_uri else ""
                raise InputError(
                    f"Cyclone DDS cannot open domain {settings.domain} with range {settings.range}{more}: {error}"
                ) from error
        _joined[settings.domain] = domain, xml, users + 1


def leave(number: int) -> None:
    """Leave a domain; the last one that leaves ends its threads."""
    with _lock:
        domain, xml, users = _joined[number]
        if users > 1:
            _joined[number] = domain, xml, users - 1
            return
        del _joined[number]
    delete(domain)
