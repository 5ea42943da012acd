"""Observers that record: run folders, pictures, videos, and a progress bar. Each name is imported on first use."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from trundle.record.overlay import draw_paths, draw_plan, draw_run
    from trundle.record.run_folder import RunFolder, save_png

_HOMES = {
    "RunFolder": "trundle.record.run_folder",
    "draw_paths": "trundle.record.overlay",
    "draw_plan": "trundle.record.overlay",
    "draw_run": "trundle.record.overlay",
    "save_png": "trundle.record.run_folder",
}

__all__ = ["RunFolder", "draw_paths", "draw_plan", "draw_run", "save_png"]


def __getattr__(name: str) -> object:
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'trundle.record' has no attribute {name!r}")
    return getattr(importlib.import_module(home), name)
