"""`Settings`: domain, range and distribution, from options and from the variables that ROS programs read."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

from trundle.errors import InputError, UnknownNameError
from trundle.messages import DISTROS, Distro
from trundle.messages.codec import DEFAULT

Range: TypeAlias = Literal["localhost", "subnet"]
"""How far others are looked for: on this machine, or in its networks."""

NEAREST: Mapping[str, Distro] = {"iron": "jazzy", "rolling": "lyrical"}
"""Distributions that trundle does not know, and whose messages are most like theirs."""

RANGES: tuple[Range, ...] = get_args(Range)

ROS_RANGES = ("LOCALHOST", "OFF", "SUBNET", "SYSTEM_DEFAULT")
"""What ROS_AUTOMATIC_DISCOVERY_RANGE may be: https://docs.ros.org/en/jazzy/Tutorials/Advanced/Improved-Dynamic-Discovery.html."""

LAST_DOMAIN = 232
"""With 250 ports to a domain from 7400 on, those of the next one would pass 65535 (DDSI-RTPS 2.5, section 9.6.2.3)."""

EPHEMERAL_DOMAINS = range(102, 215)
"""On Linux their ports are among those that the kernel gives to outgoing connections (32768 to 60999)."""

VARIABLES = (
    "ROS_DISTRO",
    "ROS_DOMAIN_ID",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_STATIC_PEERS",
    "ROS_LOCALHOST_ONLY",
    "RMW_IMPLEMENTATION",
    "CYCLONEDDS_URI",
)
"""The variables that are read, in the order of reports. For ROS an empty one is not set."""

NOT_DDS = frozenset({"rmw_zenoh_cpp"})
"""Middleware whose programs nothing that speaks DDS can reach."""


@dataclass(frozen=True, slots=True)
class Settings:
    """What the bridge joins, and where each setting comes from.

    Attributes:
        distro: The distribution whose types are spoken.
        domain: The domain, 0 to 232.
        range: How far others are looked for.
        static_peers: Addresses at which others are looked for as well; empty on localhost.
        rmw: The middleware that the environment names ("rmw_fastrtps_cpp"); "" where it names none.
        cyclonedds_uri: More configuration of Cyclone DDS; "" on localhost.
        variables: The variables of the environment that are set, as they were read.
        given: What options decided, and not the environment: of "distro", "domain" and "range".
        notes: What the user should know: variables that are overruled, or cannot work.
    """

    distro: Distro = DEFAULT
    domain: int = 0
    range: Range = "localhost"
    static_peers: tuple[str, ...] = ()
    rmw: str = ""
    cyclonedds_uri: str = ""
    variables: tuple[tuple[str, str], ...] = ()
    given: frozenset[str] = frozenset()
    notes: tuple[str, ...] = ()

    def environment(self) -> Mapping[str, str]:
        """Return the variables with which a ROS program joins the same domain and range; "" is for those to unset."""
        local = self.range == "localhost"
        humble = self.distro == "humble"
        return {
            "ROS_DOMAIN_ID": str(self.domain),
            "ROS_LOCALHOST_ONLY": str(int(local)) if humble else "",
            "ROS_AUTOMATIC_DISCOVERY_RANGE": "" if humble else self.range.upper(),
            "ROS_STATIC_PEERS": ";".join(self.static_peers),
        }


def read_settings(
    *,
    distro: Distro | None = None,
    domain: int | None = None,
    range_: Range | None = None,
    environ: Mapping[str, str] | None = None,
) -> Settings:
    """Read the environment, with options before it.

    Only `range_="subnet"` leaves this machine, whatever the environment says.

    Args:
        distro: The distribution. If None, it is ROS_DISTRO's, or Jazzy.
        domain: The domain. If None, it is ROS_DOMAIN_ID's, or 0.
        range_: How far others are looked for; localhost by default.
        environ: The environment, `os.environ` by default.

    Raises:
        InputError: If a setting cannot be used; the message names the variable.
        UnknownNameError: If there is no such distribution or range.
    """
    source = os.environ if environ is None else environ
    variables = {name: source[name] for name in VARIABLES if source.get(name)}
    if range_ is not None and range_ not in RANGES:
        raise UnknownNameError("range", range_, RANGES)
    notes = [*_notes_on_range(range_, variables)]
    chosen = range_ or "localhost"
    rmw = variables.get("RMW_IMPLEMENTATION", "")
    if rmw in NOT_DDS:
        notes.append(f"RMW_IMPLEMENTATION={rmw}: its programs do not speak DDS; only --transport rclpy reaches them")
    number = _domain(domain, variables)
    named = variables.get("ROS_DISTRO", "")
    if distro is None and named in NEAREST:
        notes.append(f"ROS_DISTRO={named} is not known: treated as {NEAREST[named]}; --distro names another")
    if number in EPHEMERAL_DOMAINS and sys.platform == "linux":
        notes.append(
            f"domain {number}: other connections of this machine may hold its ports; 0 to 101 and 215 to 232 are safe"
        )
    subnet = chosen == "subnet"
    return Settings(
        distro=_distro(distro, variables),
        domain=number,
        range=chosen,
        static_peers=_peers(variables) if subnet else (),
        rmw=rmw,
        cyclonedds_uri=variables.get("CYCLONEDDS_URI", "") if subnet else "",
        variables=tuple(variables.items()),
        given=frozenset(
            name for name, value in (("distro", distro), ("domain", domain), ("range", range_)) if value is not None
        ),
        notes=tuple(notes),
    )


def _distro(option: Distro | None, variables: Mapping[str, str]) -> Distro:
    if option is not None:
        if option not in DISTROS:
            raise UnknownNameError("ROS 2 distribution", option, DISTROS)
        return option
    name = variables.get("ROS_DISTRO", DEFAULT)
    for distro in DISTROS:
        if name == distro or NEAREST.get(name) == distro:
            return distro
    raise InputError(
        f"ROS_DISTRO={name} is not a distribution that trundle knows ({', '.join(DISTROS)}). "
        "Say whose types to speak with --distro."
    )


def _domain(option: int | None, variables: Mapping[str, str]) -> int:
    text, where = (str(option), "--domain ") if option is not None else (variables.get("ROS_DOMAIN_ID", "0"), "")
    number = int(text) if text.strip().isdecimal() else -1
    if not 0 <= number <= LAST_DOMAIN:
        raise InputError(f"{where or 'ROS_DOMAIN_ID='}{text} is not a domain: a number from 0 to {LAST_DOMAIN}")
    return number


def _notes_on_range(option: Range | None, variables: Mapping[str, str]) -> list[str]:
    """Return what the environment asks for and does not get."""
    ros_range, only = variables.get("ROS_AUTOMATIC_DISCOVERY_RANGE", ""), variables.get("ROS_LOCALHOST_ONLY", "")
    if ros_range and ros_range not in ROS_RANGES:
        raise InputError(f"ROS_AUTOMATIC_DISCOVERY_RANGE={ros_range} is none of {', '.join(ROS_RANGES)}")
    if only not in ("", "0", "1"):
        raise InputError(f"ROS_LOCALHOST_ONLY={only} is neither 0 nor 1; ROS takes it for 0")
    if ros_range == "OFF" and option is None:
        raise InputError(
            "ROS_AUTOMATIC_DISCOVERY_RANGE=OFF: no program would find trundle. Unset it, or give --range localhost."
        )
    if option == "subnet":
        asked = "ROS_LOCALHOST_ONLY=1" if only == "1" else f"ROS_AUTOMATIC_DISCOVERY_RANGE={ros_range}"
        if only == "1" or ros_range in ("LOCALHOST", "OFF"):
            return [f"{asked} is overruled by --range subnet"]
        return []
    notes = []
    if ros_range == "SUBNET" or (ros_range == "OFF" and option is not None):
        hint = (
            "give --range subnet to leave this machine" if ros_range == "SUBNET" else "--range localhost overrules it"
        )
        notes.append(f"ROS_AUTOMATIC_DISCOVERY_RANGE={ros_range}: trundle stays on localhost; {hint}")
    notes.extend(
        f"{name} is not used on localhost; give --range subnet to use it"
        for name in ("ROS_STATIC_PEERS", "CYCLONEDDS_URI")
        if name in variables
    )
    return notes


def _peers(variables: Mapping[str, str]) -> tuple[str, ...]:
    """Read the addresses of ROS_STATIC_PEERS, which semicolons separate."""
    peers = tuple(
        part for part in (piece.strip() for piece in variables.get("ROS_STATIC_PEERS", "").split(";")) if part
    )
    for peer in peers:
        if not all(char.isalnum() or char in ".:-_%" for char in peer):
            raise InputError(f"ROS_STATIC_PEERS has {peer!r}, which is not an address; semicolons separate addresses")
    return peers
