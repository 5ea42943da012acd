"""Recordings of runs as rosbag2 MCAP files, and runs from the recordings of any robot.

Needs rosbags and mcap: `pip install "trundle[record]"`. Each name is imported on first use.
"""

from __future__ import annotations

import importlib.util
from typing import TYPE_CHECKING

from trundle.errors import MissingExtraError
from trundle.lazy import lazy_names
from trundle.messages.codec import INSTALL

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


def check_extra(purpose: str = "a recording") -> None:
    """Check that the libraries of recordings are installed.

    Raises:
        MissingExtraError: If one is not; the message gives the install command.
    """
    for package in ("mcap", "rosbags", "zstandard"):
        if importlib.util.find_spec(package) is None:
            raise MissingExtraError(purpose, package, INSTALL)
