"""Quality of service in DDS's policies, and back."""

# Cyclone DDS has no wheel for some Pythons and machines.
# pyright: reportMissingImports=false

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from trundle.messages import Qos

if TYPE_CHECKING:
    from cyclonedds.core import Qos as DdsQos

MAX_BLOCKING_NS = 10_000_000
"""How long a write may wait for readers that do not keep up."""

SPARE = 16
"""A reader holds four times the depth and this many more, so that what a flood overwrites can be counted."""


def writer_qos(qos: Qos, type_hash: str) -> DdsQos:
    """The policies of a writer."""
    from cyclonedds.core import Policy
    from cyclonedds.core import Qos as DdsQos

    history = Policy.History.KeepLast(qos.depth)
    latched = qos.durability == "transient_local"
    more = [Policy.DurabilityService(0, history, -1, -1, -1)] if latched else []
    return DdsQos(*_common(qos, type_hash), history, Policy.WriterDataLifecycle(autodispose=False), *more)


def reader_qos(qos: Qos, type_hash: str, *, kept: int) -> DdsQos:
    """The policies of a reader that holds `kept` messages."""
    from cyclonedds.core import Policy
    from cyclonedds.core import Qos as DdsQos

    return DdsQos(*_common(qos, type_hash), Policy.History.KeepLast(kept))


def kept_by_reader(qos: Qos) -> int:
    """How many messages a reader holds until they are taken."""
    return 4 * qos.depth + SPARE


def user_data(qos: DdsQos | None) -> dict[str, str]:
    """What ROS writes into the user data of an endpoint or a participant: "key=value;key=value;"."""
    from cyclonedds.core import Policy

    found: Any = qos[Policy.Userdata] if qos is not None and Policy.Userdata in qos else None
    text = bytes(found.data).decode("ascii", "replace") if found is not None else ""
    pairs = (part.partition("=") for part in text.split(";") if "=" in part)
    return {key: value for key, _, value in pairs}


def read_qos(qos: DdsQos | None) -> Qos:
    """The quality of service of an endpoint, as discovery tells it."""
    from cyclonedds.core import Policy

    def policy(kind: Any) -> Any:
        return qos[kind] if qos is not None and kind in qos else None

    history = policy(Policy.History)
    reliability: Literal["reliable", "best_effort"] = "best_effort"
    if isinstance(policy(Policy.Reliability), Policy.Reliability.Reliable):
        reliability = "reliable"
    latched = policy(Policy.Durability) not in (None, Policy.Durability.Volatile)
    return Qos(
        depth=history.depth if isinstance(history, Policy.History.KeepLast) else 0,
        reliability=reliability,
        durability="transient_local" if latched else "volatile",
    )


def _common(qos: Qos, type_hash: str) -> list[Any]:
    from cyclonedds.core import Policy

    reliable = qos.reliability == "reliable"
    latched = qos.durability == "transient_local"
    return [
        Policy.Reliability.Reliable(MAX_BLOCKING_NS) if reliable else Policy.Reliability.BestEffort,
        Policy.Durability.TransientLocal if latched else Policy.Durability.Volatile,
        Policy.DataRepresentation(use_cdrv0_representation=True, use_xcdrv2_representation=False),
        Policy.Userdata(f"typehash={type_hash};".encode()),
    ]
