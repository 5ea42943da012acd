"""The page: a world, a run and its steps as plain values for a browser, and the HTML that shows them.

Each name, and with it the engine, is imported on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names

if TYPE_CHECKING:
    from trundle.page.events import Events
    from trundle.page.folder_report import report_folder
    from trundle.page.frames import frame_of
    from trundle.page.html import csp, render
    from trundle.page.maps import costmap_png, grid_png
    from trundle.page.rows import COLUMNS, info_of, row_of
    from trundle.page.run_data import RunData
    from trundle.page.run_lines import RunLines
    from trundle.page.scene import scene_of

__getattr__ = lazy_names(
    __name__,
    {
        "COLUMNS": "trundle.page.rows",
        "Events": "trundle.page.events",
        "RunData": "trundle.page.run_data",
        "RunLines": "trundle.page.run_lines",
        "costmap_png": "trundle.page.maps",
        "csp": "trundle.page.html",
        "frame_of": "trundle.page.frames",
        "grid_png": "trundle.page.maps",
        "info_of": "trundle.page.rows",
        "render": "trundle.page.html",
        "report_folder": "trundle.page.folder_report",
        "row_of": "trundle.page.rows",
        "scene_of": "trundle.page.scene",
    },
)

__all__ = [
    "COLUMNS",
    "Events",
    "RunData",
    "RunLines",
    "costmap_png",
    "csp",
    "frame_of",
    "grid_png",
    "info_of",
    "render",
    "report_folder",
    "row_of",
    "scene_of",
]
