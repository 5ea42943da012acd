"""Pictures and windows in 3D. Each name, and with it the engine, is imported on first use."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trundle.viewer.cameras import Camera
    from trundle.viewer.offscreen import Picture, render

_HOMES = {
    "Camera": "trundle.viewer.cameras",
    "Picture": "trundle.viewer.offscreen",
    "render": "trundle.viewer.offscreen",
}

__all__ = ["Camera", "Picture", "render"]


def __getattr__(name: str) -> object:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'trundle.viewer' has no attribute {name!r}")
    return getattr(importlib.import_module(home), name)
