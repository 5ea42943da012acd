"""Cyclone's domains: one for each number in a process, with its configuration, shared by those that join it.

Configuration: https://cyclonedds.io/docs/cyclonedds/latest/config/config_file_reference.html.
"""

# Cyclone DDS has no wheel for some Pythons and machines.
# pyright: reportMissingImports=false

from __future__ import annotations

import threading
from typing import TYPE_CHECKING
from xml.sax.saxutils import quoteattr

from trundle.errors import InputError
from trundle.ros2.transport.dds.library import delete
from trundle.ros2.transport.domain import Settings

if TYPE_CHECKING:
    from cyclonedds.domain import Domain

LOOPBACK = "127.0.0.1"

_GENERAL = """
<General>
  <Interfaces><NetworkInterface {interface}/></Interfaces>
  <AllowMulticast>{multicast}</AllowMulticast>
  <MaxMessageSize>65500B</MaxMessageSize>
</General>
"""
"""Multicast finds others and carries no data, as in rmw_cyclonedds; large datagrams make large messages cheap."""

_DISCOVERY = """
<Discovery>
  <ParticipantIndex>auto</ParticipantIndex>
  <MaxAutoParticipantIndex>119</MaxAutoParticipantIndex>
  <LeaseDuration>5 s</LeaseDuration>
  <Peers addLocalhost="{localhost}">{peers}</Peers>
</Discovery>
"""
"""120 participants of a machine have ports in a domain. Others forget us five seconds after we were killed."""

_COMPATIBILITY = "<Compatibility><IgnoreTypeInformation>1.15</IgnoreTypeInformation></Compatibility>"
"""1.15 is eProsima's vendor id. Without this, Kilted's Fast DDS matches no type that has sequences."""

_WRITING = "<Internal><Watermarks><WhcAdaptive>false</WhcAdaptive><WhcHigh>1 GB</WhcHigh></Watermarks></Internal>"
"""A writer does not wait for slow readers: its history, of limited depth, replaces what they have not fetched."""

_joined: dict[int, tuple[Domain, str, int]] = {}
"""The domain of each number, its configuration, and how many use it."""

_lock = threading.Lock()


def domain_xml(settings: Settings) -> str:
    """Return the configuration for a domain, and after it what the user's CYCLONEDDS_URI adds."""
    local = settings.range == "localhost"
    peers = ("localhost",) if local else settings.static_peers
    parts = (
        _GENERAL.format(
            interface=f'address="{LOOPBACK}" multicast="true"' if local else 'autodetermine="true"', multicast="spdp"
        ),
        _DISCOVERY.format(
            localhost="false" if local else "true",
            peers="".join(f"<Peer address={quoteattr(peer)}/>" for peer in peers),
        ),
        _COMPATIBILITY,
        _WRITING,
    )
    ours = f'<CycloneDDS><Domain Id="any">{"".join(parts)}</Domain></CycloneDDS>'
    return f"{ours},{settings.cyclonedds_uri}" if settings.cyclonedds_uri else ours


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
