"""Which topics of a bag hold what: by type, and by name where several have the same type."""

from __future__ import annotations

from collections.abc import Sequence

from trundle.errors import InputError
from trundle.recording.bag_reader import BagTopic

TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
MAPS = ("nav_msgs/msg/OccupancyGrid",)
ODOMETRY = ("nav_msgs/msg/Odometry",)
PATHS = ("nav_msgs/msg/Path",)
SCANS = ("sensor_msgs/msg/LaserScan",)
COMMANDS = ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")
GOALS = ("geometry_msgs/msg/PoseStamped",)
MARKERS = ("visualization_msgs/msg/MarkerArray",)

TRUTH = "/ground_truth/odom"
"""Topic of the true pose in trundle's recordings."""

ASKED = "/cmd_vel_nav"
"""Topic of what the controller asks for, before the collision monitor; Nav2's name."""

MOVERS = "/movers"
"""Topic of the movers in trundle's recordings."""


def of_types(topics: Sequence[BagTopic], types: Sequence[str]) -> list[BagTopic]:
    """The topics of these types that have messages."""
    return [topic for topic in topics if topic.type_name in types and topic.count]


def choose(
    topics: Sequence[BagTopic],
    types: Sequence[str],
    names: Sequence[str],
    *,
    given: str | None = None,
    option: str = "",
    without: Sequence[str] = (),
) -> BagTopic | None:
    """The topic of these types whose name fits best; None where there is none.

    Args:
        topics: All topics of a bag.
        types: Types of its messages.
        names: Its usual names, the most usual one first: the name itself, then the last part of a name (/robot1/map),
            then a part of it.
        given: The name that the user gave, which decides.
        option: The user's option, for messages.
        without: Parts of names that it does not have.

    Raises:
        InputError: If the bag has no topic of the given name and these types.
    """
    found = of_types(topics, types)
    if given is not None:
        chosen = next((topic for topic in found if topic.name == given), None)
        if chosen is None:
            there = ", ".join(topic.name for topic in found) or "none"
            raise InputError(f"{option} {given}: the bag has no such topic of type {types[0]}; there are: {there}")
        return chosen
    found = [topic for topic in found if not any(part in topic.name for part in without)]
    for fits in (
        lambda topic, name: topic.name == f"/{name}",
        lambda topic, name: topic.name.endswith(f"/{name}"),
        lambda topic, name: name in topic.name,
    ):
        for name in names:
            fitting = [topic for topic in found if fits(topic, name)]
            if fitting:
                return max(fitting, key=lambda topic: topic.count)
    return max(found, key=lambda topic: topic.count, default=None)
