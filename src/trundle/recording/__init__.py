"""Recordings of runs as rosbag2 MCAP files, and runs from the recordings of any robot.

Needs rosbags and mcap: `pip install "trundle[record]"`. Each name is imported on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names

if TYPE_CHECKING:
    from trundle.recording.from_bag import RunFromBag, read_run
    from trundle.recording.info import BagInfo, read_info
    from trundle.recording.recorder import Recorder
    from trundle.recording.recovery import Recovered, recover

__getattr__ = lazy_names(
    __name__,
    {
        "BagInfo": "trundle.recording.info",
        "Recorder": "trundle.recording.recorder",
        "Recovered": "trundle.recording.recovery",
        "RunFromBag": "trundle.recording.from_bag",
        "read_info": "trundle.recording.info",
        "read_run": "trundle.recording.from_bag",
        "recover": "trundle.recording.recovery",
    },
)

__all__ = ["BagInfo", "Recorder", "Recovered", "RunFromBag", "read_info", "read_run", "recover"]
