"""The page: a world, a run and its steps as plain values for a browser, and the HTML that shows them.

Each name, and with it the engine, is imported on first use.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names

if TYPE_CHECKING:
    from trundle.page.encoding import costmap_png, grid_png
    from trundle.page.frames import frame_of
    from trundle.page.html import csp, render
    from trundle.page.report import report_folder
    from trundle.page.run_data import RunData
    from trundle.page.run_lines import COLUMNS, Events, RunLines, info_of, row_of
    from trundle.page.scene import scene_of

__getattr__ = lazy_names(
    __name__,
    {
        "COLUMNS": "trundle.page.run_lines",
        "Events": "trundle.page.run_lines",
        "RunData": "trundle.page.run_data",
        "RunLines": "trundle.page.run_lines",
        "costmap_png": "trundle.page.encoding",
        "csp": "trundle.page.html",
        "frame_of": "trundle.page.frames",
        "grid_png": "trundle.page.encoding",
        "info_of": "trundle.page.run_lines",
        "render": "trundle.page.html",
        "report_folder": "trundle.page.report",
        "row_of": "trundle.page.run_lines",
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
