"""Observers that record: run folders, pictures, videos, and a progress bar. Each name is imported on first use."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names

if TYPE_CHECKING:
    from trundle.record.overlay import MoverTrails, draw_paths, draw_plan, draw_run
    from trundle.record.own_map import draw_own_map
    from trundle.record.run_folder import RunFolder, save_png

__getattr__ = lazy_names(
    __name__,
    {
        "MoverTrails": "trundle.record.overlay",
        "RunFolder": "trundle.record.run_folder",
        "draw_own_map": "trundle.record.own_map",
        "draw_paths": "trundle.record.overlay",
        "draw_plan": "trundle.record.overlay",
        "draw_run": "trundle.record.overlay",
        "save_png": "trundle.record.run_folder",
    },
)

__all__ = ["MoverTrails", "RunFolder", "draw_own_map", "draw_paths", "draw_plan", "draw_run", "save_png"]
