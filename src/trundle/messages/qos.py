"""`Qos`: the quality of service that a topic is offered with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

_NUMBERS = {
    "keep_last": 1,
    "reliable": 1,
    "best_effort": 2,
    "transient_local": 1,
    "volatile": 2,
    "automatic": 1,
}
"""What rmw's enumerations number these."""


@dataclass(frozen=True, slots=True)
class Qos:
    """The quality of service of a publisher; deadlines and lifespans are infinite.

    Attributes:
        depth: How many messages are kept.
        reliability: Whether lost messages are sent again.
        durability: Whether a late subscriber gets the last message ("transient_local").
    """

    depth: int = 10
    reliability: Literal["reliable", "best_effort"] = "reliable"
    durability: Literal["volatile", "transient_local"] = "volatile"

    def profile(self, *, numbers: bool = False) -> Mapping[str, object]:
        """Return the profile as rosbag2 stores it.

        Args:
            numbers: Write its settings as numbers, as before ROS 2 Iron.
        """

        def setting(name: str) -> int | str:
            return _NUMBERS[name] if numbers else name

        endless = {"sec": 9223372036, "nsec": 854775807}
        return {
            "history": setting("keep_last"),
            "depth": self.depth,
            "reliability": setting(self.reliability),
            "durability": setting(self.durability),
            "deadline": dict(endless),
            "lifespan": dict(endless),
            "liveliness": setting("automatic"),
            "liveliness_lease_duration": dict(endless),
            "avoid_ros_namespace_conventions": False,
        }


LATCHED = Qos(1, durability="transient_local")
"""Maps and static transforms: whoever comes late gets the last one."""

SENSOR = Qos(5, "best_effort")
"""Scans: rmw's sensor data profile."""

CLOCK = Qos(1, "best_effort")
"""/clock, as rclcpp's time source subscribes to it."""

TRANSFORMS = Qos(100)
"""/tf, as tf2_ros offers it."""
