"""`write_report`: the report of a run as one HTML file, with its replay on top."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from trundle.errors import TrundleError
from trundle.files.writing import write_text
from trundle.maps import OccupancyGrid
from trundle.page.encoding import pack_json
from trundle.page.html import render
from trundle.page.scene import scene_of
from trundle.robots import Robot
from trundle.worlds import World

REPORT = "report.html"

_MOST_SCENE_BYTES = 8_000_000
"""Of a report's scene before it is compressed: meshes beyond are drawn as boxes."""

_FIGURES = (
    ("time_s", "time", "{:.1f} s"),
    ("distance_m", "distance", "{:.2f} m"),
    ("path_length_m", "planned", "{:.2f} m"),
    ("spl", "SPL", "{:.3f}"),
    ("min_clearance_m", "smallest clearance", "{:.3f} m"),
    ("mean_cross_track_error_m", "mean cross-track error", "{:.3f} m"),
    ("max_cross_track_error_m", "largest cross-track error", "{:.3f} m"),
    ("smoothness_rad_per_m", "turning per distance", "{:.2f} rad/m"),
    ("planning_ms", "planning", "{:.1f} ms"),
    ("replans", "replans", "{:d}"),
    ("recoveries", "steps of recovery", "{:d}"),
    ("monitor_stops", "stops by the collision monitor", "{:d}"),
    ("position_error_m", "error of the estimate", "{:.3f} m"),
    ("real_time_factor", "real-time factor", "{:.0f}"),
)


def write_report(
    file: str | os.PathLike[str],
    *,
    run: Mapping[str, Any],
    scene: Mapping[str, Any],
    record: Mapping[str, Any],
    settings: Mapping[str, Any] | None,
    folder: str | os.PathLike[str],
) -> None:
    """Write the report of a run.

    Args:
        file: The HTML file.
        run: What `RunData.run_dict` gives.
        scene: What `report_scene` gives.
        record: The content of the run's episode.json.
        settings: The scenario as plain values, if the run has one: then the report has the command that repeats it.
        folder: The run's folder.

    Raises:
        OutputError: If it cannot be written.
    """
    shown = {name: value for name, value in run.items() if name not in ("info", "contacts")}
    boot = {
        "mode": "report",
        "scene": pack_json(scene),
        "run": run["info"],
        "episode": pack_json(shown),
        "verdict": {
            "outcome": record["outcome"],
            "message": record["message"],
            "figures": _figures(record),
        },
        "contacts": run["contacts"],
        "settings": settings,
        "versions": record.get("versions"),
        "command": None if settings is None else repeat_command(folder),
        "folder": os.fspath(folder),
    }
    write_page(file, boot)


def write_page(file: str | os.PathLike[str], boot: Mapping[str, Any]) -> None:
    """Write what `write_report` has put together.

    Raises:
        OutputError: If it cannot be written.
    """
    name = (boot["run"] or {}).get("name") or "run"
    write_text(file, render(boot, title=f"{name}: {boot['verdict']['outcome'].replace('_', ' ')}"))


def repeat_command(folder: str | os.PathLike[str]) -> str:
    """The command that repeats a run from its folder."""
    return f"trundle run {shlex.quote(os.fspath(Path(folder) / 'scenario.yaml'))}"


def report_scene(world: World | None, robot: Robot, grid: OccupancyGrid | None) -> dict[str, Any]:
    """The scene of a report; of a world that is too large, its map alone, with a note."""
    try:
        return scene_of(world, robot, grid, most_bytes=_MOST_SCENE_BYTES)
    except TrundleError as error:
        return scene_of(None, robot, grid) | {"note": str(error)}


def _figures(record: Mapping[str, Any]) -> list[list[str]]:
    """Label and text of every figure that the record has."""
    found = [
        [label, form.format(value)]
        for name, label, form in _FIGURES
        if isinstance(value := record.get(name), int | float) and not (name == "position_error_m" and value == 0.0)
    ]
    if goals := record.get("goals"):
        found.insert(0, ["goals reached", f"{record.get('goals_reached', 0)} of {len(goals)}"])
    if isinstance(complete := record.get("search_complete"), bool):
        found.append(["search for a path", "complete: there is none" if complete else "not complete: none found"])
    for name, label in (
        ("standing_contacts", "run into while standing by"),
        ("unseen_contacts", "touched, but seen by no lidar"),
    ):
        if names := record.get(name):
            found.append([label, ", ".join(str(one) for one in names)])
    return found
