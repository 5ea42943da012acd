"""The configuration of Cyclone DDS: https://cyclonedds.io/docs/cyclonedds/latest/config/config_file_reference.html."""

from __future__ import annotations

from xml.sax.saxutils import quoteattr

from trundle.ros2.transport.domain import Settings

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


def domain_xml(settings: Settings) -> str:
    """The configuration for a domain, and after it what the user's CYCLONEDDS_URI adds."""
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
