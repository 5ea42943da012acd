"""Whether the libraries of the extra `record` are installed."""

from __future__ import annotations

import importlib.util

from trundle.errors import MissingExtraError
from trundle.messages.codec import INSTALL


def check_extra(purpose: str = "a recording") -> None:
    """Check that the libraries of recordings are installed.

    Raises:
        MissingExtraError: If one is not; the message gives the install command.
    """
    for package in ("mcap", "rosbags", "zstandard"):
        if importlib.util.find_spec(package) is None:
            raise MissingExtraError(purpose, package, INSTALL)
