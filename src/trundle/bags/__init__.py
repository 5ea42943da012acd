"""Recordings of runs as rosbag2 MCAP files, and runs from the recordings of any robot.

Needs rosbags and mcap: `pip install "trundle[record]"`. Each name is imported on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.extras import check_extra
from trundle.lazy import lazy_names

if TYPE_CHECKING:
    from trundle.bags.from_bag import RunFromBag, read_run
    from trundle.bags.info import BagInfo, read_info
    from trundle.bags.recorder import Recorder
    from trundle.bags.recovery import Recovered, recover

_find = lazy_names(
    __name__,
    {
        "BagInfo": "trundle.bags.info",
        "Recorder": "trundle.bags.recorder",
        "Recovered": "trundle.bags.recovery",
        "RunFromBag": "trundle.bags.from_bag",
        "read_info": "trundle.bags.info",
        "read_run": "trundle.bags.from_bag",
        "recover": "trundle.bags.recovery",
    },
)


def __getattr__(name: str) -> object:
    if name in __all__:
        check_extra("record", "a recording")
    return _find(name)


__all__ = ["BagInfo", "Recorder", "Recovered", "RunFromBag", "read_info", "read_run", "recover"]
