"""ROS 2 messages without a ROS installation: their types, hashes and bytes for one distribution, and their makers.

Needs rosbags: `pip install "trundle[record]"`. Each name is imported on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names

if TYPE_CHECKING:
    from trundle.messages.codec import DISTROS, Codec, Distro
    from trundle.messages.makers import MessageMaker
    from trundle.messages.qos import Qos

__getattr__ = lazy_names(
    __name__,
    {
        "DISTROS": "trundle.messages.codec",
        "Codec": "trundle.messages.codec",
        "Distro": "trundle.messages.codec",
        "MessageMaker": "trundle.messages.makers",
        "Qos": "trundle.messages.qos",
    },
)

__all__ = ["DISTROS", "Codec", "Distro", "MessageMaker", "Qos"]
