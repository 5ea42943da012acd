"""ROS's names in DDS, and back: https://design.ros2.org/articles/topic_and_service_names.html."""

from __future__ import annotations

import re

from trundle.errors import InputError

DISCOVERY_TOPIC = "ros_discovery_info"

_TOPIC = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")
_TYPE = re.compile(r"([a-z][a-z0-9_]*)/(msg|srv|action)/([A-Z][A-Za-z0-9_]*)")
_DDS_TYPE = re.compile(r"([A-Za-z0-9_]+)::(msg|srv|action)::dds_::([A-Za-z0-9_]+)_")


def dds_topic(topic: str) -> str:
    """The name in DDS: rt/scan of /scan.

    Raises:
        InputError: If it is not the full name of a topic.
    """
    if not _TOPIC.fullmatch(topic) or "__" in topic:
        raise InputError(
            f"{topic!r} is not the full name of a topic: parts of letters, digits and underscores, each after a slash"
        )
    return f"rt{topic}"


def dds_type(type_name: str) -> str:
    """The name in DDS: sensor_msgs::msg::dds_::LaserScan_ of sensor_msgs/msg/LaserScan.

    Raises:
        InputError: If it is not the name of a type.
    """
    parts = _TYPE.fullmatch(type_name)
    if not parts:
        raise InputError(f"{type_name!r} is not the name of a type, such as sensor_msgs/msg/LaserScan")
    return f"{parts[1]}::{parts[2]}::dds_::{parts[3]}_"


def ros_topic(dds_name: str) -> str:
    """The name in ROS: /scan of rt/scan; "" for what is no topic of ROS."""
    return dds_name[2:] if dds_name.startswith("rt/") else ""


def ros_type(dds_name: str) -> str:
    """The name in ROS: sensor_msgs/msg/LaserScan of sensor_msgs::msg::dds_::LaserScan_; others as they are."""
    parts = _DDS_TYPE.fullmatch(dds_name)
    return f"{parts[1]}/{parts[2]}/{parts[3]}" if parts else dds_name
