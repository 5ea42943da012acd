"""The ROS 2 distributions whose messages are known."""

from __future__ import annotations

from typing import Literal, TypeAlias, get_args

Distro: TypeAlias = Literal["humble", "jazzy", "kilted", "lyrical"]
"""A distribution of ROS 2."""

DISTROS: tuple[Distro, ...] = get_args(Distro)
"""All of them, oldest first."""

DEFAULT: Distro = "jazzy"

STAMPED_COMMANDS = frozenset[Distro]({"kilted", "lyrical"})
"""Those in which Nav2 sends geometry_msgs/TwistStamped on /cmd_vel by default, and no longer Twist."""

OLD_BAGS = frozenset[Distro]({"humble"})
"""Those whose rosbag2 writes QoS settings as numbers, and metadata of version 5."""
