"""ROS's names, message types and quality of service in DDS, and back.

Names: https://design.ros2.org/articles/topic_and_service_names.html.
"""

# Cyclone DDS has no wheel for some Pythons and machines.
# pyright: reportMissingImports=false

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any, Literal

from trundle.errors import InputError
from trundle.messages import Codec, Qos

if TYPE_CHECKING:
    from cyclonedds.core import Qos as DdsQos
    from cyclonedds.idl import IdlStruct
    from rosbags.interfaces.typing import FieldDesc

DISCOVERY_TOPIC = "ros_discovery_info"

_TOPIC = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")
_TYPE = re.compile(r"([a-z][a-z0-9_]*)/(msg|srv|action)/([A-Z][A-Za-z0-9_]*)")
_DDS_TYPE = re.compile(r"([A-Za-z0-9_]+)::(msg|srv|action)::dds_::([A-Za-z0-9_]+)_")


def dds_topic(topic: str) -> str:
    """Return the name in DDS: rt/scan of /scan.

    Raises:
        InputError: If it is not the full name of a topic.
    """
    if not _TOPIC.fullmatch(topic) or "__" in topic:
        raise InputError(
            f"{topic!r} is not the full name of a topic: parts of letters, digits and underscores, each after a slash"
        )
    return f"rt{topic}"


def dds_type(type_name: str) -> str:
    """Return the name in DDS: sensor_msgs::msg::dds_::LaserScan_ of sensor_msgs/msg/LaserScan.

    Raises:
        InputError: If it is not the name of a type.
    """
    parts = _TYPE.fullmatch(type_name)
    if not parts:
        raise InputError(f"{type_name!r} is not the name of a type, such as sensor_msgs/msg/LaserScan")
    return f"{parts[1]}::{parts[2]}::dds_::{parts[3]}_"


def ros_topic(dds_name: str) -> str:
    """Return the name in ROS: /scan of rt/scan; "" for what is no topic of ROS."""
    return dds_name[2:] if dds_name.startswith("rt/") else ""


def ros_type(dds_name: str) -> str:
    """Return the name in ROS: sensor_msgs/msg/LaserScan of sensor_msgs::msg::dds_::LaserScan_; others as they are."""
    parts = _DDS_TYPE.fullmatch(dds_name)
    return f"{parts[1]}/{parts[2]}/{parts[3]}" if parts else dds_name


_BASES: dict[str, Any] = {
    "bool": bool,
    "byte": "byte",
    "char": "uint8",
    "float32": "float32",
    "float64": "float64",
    "int8": "int8",
    "int16": "int16",
    "int32": "int32",
    "int64": "int64",
    "uint8": "uint8",
    "uint16": "uint16",
    "uint32": "uint32",
    "uint64": "uint64",
}
"""ROS's `char` is an unsigned byte; names are those of `cyclonedds.idl.types`."""


class IdlTypes:
    """Makes Cyclone's types, each once."""

    def __init__(self, codec: Codec) -> None:
        self._codec = codec
        self._made: dict[str, type[IdlStruct]] = {}

    def struct(self, type_name: str) -> type[IdlStruct]:
        """Return the type of a message.

        Raises:
            UnknownNameError: If the distribution has no such type.
        """
        if type_name not in self._made:
            from cyclonedds.idl import make_idl_struct

            dds_name = dds_type(type_name)
            fields = {name: self._field(field) for name, field in self._codec.fields(type_name).items()}
            self._made[type_name] = make_idl_struct(dds_name.rpartition("::")[2], dds_name, fields)
        return self._made[type_name]

    def _field(self, field: FieldDesc) -> Any:
        from cyclonedds.idl import types
        from rosbags.interfaces import Nodetype

        if field[0] == Nodetype.NAME:
            return self.struct(field[1])
        if field[0] == Nodetype.BASE:
            name, length = field[1]
            if name == "string":
                return types.bounded_str[length] if length else str
            return _BASES[name] if isinstance(_BASES[name], type) else getattr(types, _BASES[name])
        element, length = self._field(field[1][0]), field[1][1]
        if field[0] == Nodetype.ARRAY:
            return types.array[element, length]
        return types.sequence[element, length] if length else types.sequence[element]


MAX_BLOCKING_NS = 10_000_000
"""How long a write may wait for readers that do not keep up."""

SPARE = 16
"""A reader holds four times the depth and this many more, so that what a flood overwrites can be counted."""


def writer_qos(qos: Qos, type_hash: str) -> DdsQos:
    """Return the policies of a writer."""
    from cyclonedds.core import Policy
    from cyclonedds.core import Qos as DdsQos

    history = Policy.History.KeepLast(qos.depth)
    latched = qos.durability == "transient_local"
    more = [Policy.DurabilityService(0, history, -1, -1, -1)] if latched else []
    return DdsQos(*_common(qos, type_hash), history, Policy.WriterDataLifecycle(autodispose=False), *more)


def reader_qos(qos: Qos, type_hash: str, *, kept: int) -> DdsQos:
    """Return the policies of a reader that holds `kept` messages, and none that its participant wrote."""
    from cyclonedds.core import Policy
    from cyclonedds.core import Qos as DdsQos

    return DdsQos(*_common(qos, type_hash), Policy.History.KeepLast(kept), Policy.IgnoreLocal.Participant)


def kept_by_reader(qos: Qos) -> int:
    """Return how many messages a reader holds until they are taken."""
    return 4 * qos.depth + SPARE


def user_data(qos: DdsQos | None) -> dict[str, str]:
    """Return what ROS writes into the user data of an endpoint or a participant: "key=value;key=value;"."""
    from cyclonedds.core import Policy

    found: Any = qos[Policy.Userdata] if qos is not None and Policy.Userdata in qos else None
    text = bytes(found.data).decode("ascii", "replace") if found is not None else ""
    pairs = (part.partition("=") for part in text.split(";") if "=" in part)
    return {key: value for key, _, value in pairs}


def read_qos(qos: DdsQos | None) -> Qos:
    """Read the quality of service of an endpoint, as discovery tells it."""
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
