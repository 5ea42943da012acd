"""Pictures and windows in 3D. Each name, and with it the engine, is imported on first use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names

if TYPE_CHECKING:
    from trundle.viewer.cameras import Camera
    from trundle.viewer.scene import Picture, render

__getattr__ = lazy_names(
    __name__,
    {
        "Camera": "trundle.viewer.cameras",
        "Picture": "trundle.viewer.scene",
        "render": "trundle.viewer.scene",
    },
)

__all__ = ["Camera", "Picture", "render"]
