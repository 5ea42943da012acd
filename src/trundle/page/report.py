"""The report of a run as one HTML file, with its replay on top: written as the run ends, or from its folder."""

from __future__ import annotations

import json
import os
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from trundle.costmap import Costmap
from trundle.errors import InputError, TrundleError
from trundle.files.opening import is_file, open_file, read_up_to
from trundle.files.writing import write_text
from trundle.geometry import FloatArray
from trundle.maps import OccupancyGrid
from trundle.mission.episode import Episode
from trundle.mission.metrics import CLEARANCE_CAP, distances_to_polyline
from trundle.mission.run_files import read_record
from trundle.mission.scenario import Scenario
from trundle.observation import LOCALIZATION_STATES
from trundle.page.encoding import finite, pack_json, rounded, unpack_json
from trundle.page.html import render
from trundle.page.run_data import dropped_boxes
from trundle.page.run_lines import goal_of, path_of
from trundle.page.scene import scene_of
from trundle.robots import Robot
from trundle.sim.clearance import map_world
from trundle.worlds import World

REPORT = "report.html"

_MOST_SCENE_BYTES = 8_000_000
"""Size of a report's scene at most, before it is compressed: meshes beyond are drawn as boxes."""

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
    ("localization_error_m", "mean error of the estimate", "{:.3f} m"),
    ("localization_error_p95_m", "error of the estimate, 95 % of the run", "{:.3f} m"),
    ("lost_s", "not localized", "{:.1f} s"),
    ("real_time_factor", "real-time factor", "{:.0f}"),
)

_LOCATED = ("position_error_m", "localization_error_m", "localization_error_p95_m", "lost_s")
"""Figures that are 0 in a run without a localizer."""
_MOST_BYTES = 100_000_000
_STAND_IN = "nova_carter"
_BEFORE, _AFTER = '<script type="application/json" id="boot">', "</script>"
_RESOLUTION_M = 0.05  # edge of the cells of the true map, on which clearances are measured


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
    """Return the command that repeats a run from its folder."""
    return f"trundle run {shlex.quote(os.fspath(Path(folder) / 'scenario.yaml'))}"


def report_scene(world: World | None, robot: Robot, grid: OccupancyGrid | None) -> dict[str, Any]:
    """Return the scene of a report; of a world that is too large, its map alone, with a note."""
    try:
        return scene_of(world, robot, grid, most_bytes=_MOST_SCENE_BYTES)
    except TrundleError as error:
        return scene_of(None, robot, grid) | {"note": str(error)}


def _figures(record: Mapping[str, Any]) -> list[list[str]]:
    """Return label and text of every figure that the record has."""
    found = [
        [label, form.format(value)]
        for name, label, form in _FIGURES
        if isinstance(value := record.get(name), int | float) and not (name in _LOCATED and value == 0.0)
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


def report_folder(folder: str | os.PathLike[str], out: str | os.PathLike[str] | None = None) -> Path:
    """Write the report of a run from its folder.

    What the run's own report holds, such as scans, is kept where there is one. Without one it is made of the run's
    other files: the world and the robot are made again from scenario.yaml; where that is not possible, the map and a
    robot that stands for it are drawn, and a note says so.

    Args:
        folder: The run's folder.
        out: The file. By default, it is `report.html` in the folder.

    Returns:
        The file.

    Raises:
        InputError: If the folder does not hold a run that has ended, or a file of it is damaged; the message names it.
        OutputError: If the report cannot be written.
    """
    place = Path(folder)
    record = read_record(place)
    scenario, _ = _scenario_of(place)
    kept = _read_report(place / REPORT, record)
    if kept is None:
        episode = Episode.load(place)
        world, robot, grid, note = _surroundings(place, record)
        run, scene = run_of(episode, robot, world, grid), report_scene(world, robot, grid)
        scene["note"] = "; ".join(part for part in (scene["note"], note) if part)
    else:
        run, scene = kept
    target = place / REPORT if out is None else Path(out)
    settings = None if scenario is None else scenario.plain()
    write_report(target, run=run, scene=scene, record=record, settings=settings, folder=place)
    return target


def _read_report(file: Path, record: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]] | None:
    """Return run and scene of a run's report, or None if there is no report, or it is damaged or another run's."""
    if not is_file(file):
        return None
    try:
        with open_file(file) as stream:
            text = read_up_to(stream, _MOST_BYTES).decode("utf-8")
        boot = json.loads(text.partition(_BEFORE)[2].partition(_AFTER)[0])
        verdict = boot["verdict"]
        if (verdict["outcome"], verdict["message"]) != (record["outcome"], record["message"]):
            return None
        scene = unpack_json(boot["scene"], most_bytes=_MOST_BYTES)
        run = unpack_json(boot["episode"], most_bytes=_MOST_BYTES)
        return {**run, "info": boot["run"], "contacts": boot["contacts"]}, scene
    except (OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError, TrundleError):
        return None


def _scenario_of(place: Path) -> tuple[Scenario | None, str]:
    """Return the scenario of a run, or the reason why there is none."""
    if not is_file(place / "scenario.yaml"):
        return None, "the folder has no scenario.yaml"
    try:
        return Scenario.load(place), ""
    except InputError as error:
        return None, str(error)


def _surroundings(place: Path, record: Mapping[str, Any]) -> tuple[World | None, Robot, OccupancyGrid | None, str]:
    """Return world, robot and map of a run, and a note of which of them could not be loaded."""
    scenario, problem = _scenario_of(place)
    if scenario is not None:
        try:
            setting = scenario.prepare()
            return setting.world, setting.robot, setting.grid, ""
        except TrundleError as error:
            problem = str(error)
    notes = [f"the world cannot be drawn: {problem}"]
    grid = None
    if is_file(place / "map.yaml"):
        try:
            grid = OccupancyGrid.load(place / "map.yaml")
        except InputError as error:
            notes.append(str(error))
    try:
        robot = Robot.load(str(record.get("robot", "")) if scenario is None else scenario.robot)
    except InputError:
        robot = Robot.load(_STAND_IN)
        notes.append(f"{_STAND_IN} is drawn for the robot {record.get('robot')!r}, whose file is not known")
    return None, robot, grid, "; ".join(notes)


def run_of(episode: Episode, robot: Robot, world: World | None, grid: OccupancyGrid | None) -> dict[str, Any]:
    """Return what `RunData.run_dict` does, without what only an observer sees: scans, movers and wall times."""
    driven, time = episode.trajectory, episode.trajectory.time
    return {
        "info": {
            "name": episode.name,
            "robot": episode.robot,
            "planner": episode.planner,
            "controller": episode.controller,
            "seed": episode.seed,
            "start": rounded(episode.start.as_tuple()),
            "goals": [goal_of(goal) for goal in episode.goals],
            "dt": float(time[1] - time[0]) if len(time) > 1 else 0.05,
            "time_limit_s": finite(episode.time_limit_s),
            "localizer": "none" if (driven.estimates == driven.poses).all() else "recorded",
        },
        "rows": _rows(episode, robot, _clearances(episode, robot, world, grid)),
        "paths": [
            path_of(episode.paths[index], float(time[first]))
            for index in range(len(episode.paths))
            if (first := _first(episode.trajectory.path == index)) is not None
        ],
        "events": _events(episode),
        "frames": [],
        "costmaps": [],
        "contacts": [],
        "solids": dropped_boxes(episode),
    }


def _rows(episode: Episode, robot: Robot, clearances: FloatArray | None) -> list[list[Any]]:
    driven = episode.trajectory
    spent = np.diff(driven.time, prepend=driven.time[0])
    across = driven.w * robot.drive.track_width / 2.0
    left, right = (np.cumsum((driven.v + side * across) * spent) / robot.drive.wheel_radius for side in (-1.0, 1.0))
    off = np.full(len(driven), np.nan)
    for index, path in enumerate(episode.paths):
        follows = driven.path == index
        if follows.any():
            off[follows] = distances_to_polyline(driven.poses[follows, :2], path.poses[:, :2])
    apart = np.abs(driven.estimates - driven.poses).max(axis=1) > 0.0
    states = [LOCALIZATION_STATES[code] if apart.any() else None for code in driven.localization]
    sent = np.c_[driven.commanded_v, driven.commanded_w]
    numbers = np.c_[driven.time, driven.poses, driven.v, driven.w, sent, sent].round(4).tolist()
    last = len(driven) - 1
    return [
        [
            *numbers[row],
            None if clearances is None else finite(float(clearances[row])),
            finite(float(off[row])),
            int(driven.goal[row]),
            episode.outcome.value if row == last else "driving",
            None,
            None,
            round(float(left[row]), 3),
            round(float(right[row]), 3),
            *(rounded(driven.estimates[row].tolist()) if apart[row] else (None, None, None)),
            states[row],
        ]
        for row in range(len(driven))
    ]


def _clearances(episode: Episode, robot: Robot, world: World | None, grid: OccupancyGrid | None) -> FloatArray | None:
    """Return the distance [m] from the footprint to solids at each row, to within a cell; None if nothing is known."""
    poses = episode.trajectory.poses
    if world is not None and world.solids:
        margin = CLEARANCE_CAP + robot.circumscribed_radius
        true_map = map_world(world, robot, poses[:, :2], resolution=_RESOLUTION_M, margin=margin)
    elif grid is not None:
        true_map = Costmap.from_grid(grid, robot)
    else:
        return None
    return true_map.clearance(poses, CLEARANCE_CAP)


def _events(episode: Episode) -> list[dict[str, Any]]:
    driven = episode.trajectory
    found = [(0.0, "start", f"{episode.robot} at ({episode.start.x:.2f}, {episode.start.y:.2f})")]
    for index, path in enumerate(episode.paths):
        if (row := _first(driven.path == index)) is not None:
            found.append((float(driven.time[row]), "replan" if index else "plan", f"path of {path.length:.2f} m"))
    changes = np.flatnonzero(np.diff(driven.goal)) + 1
    found += [(float(driven.time[row]), "goal", f"goal {int(driven.goal[row])} reached") for row in changes]
    changes = np.flatnonzero(np.diff(driven.localization, prepend=0))
    found += [(float(driven.time[row]), "locate", LOCALIZATION_STATES[driven.localization[row]]) for row in changes]
    found += [(ran.begin_s, "recovery", f"{ran.behavior}: {ran.reason}") for ran in episode.behaviors]
    ended = f"{episode.outcome.value.replace('_', ' ')}: {episode.message}"
    found = [*sorted(found, key=lambda one: one[0]), (float(driven.time[-1]), "end", ended)]
    return [{"t": round(time, 4), "kind": kind, "text": text} for time, kind, text in found]


def _first(rows: Any) -> int | None:
    """Return the index of the first row that is true, or None if there is none."""
    return int(rows.argmax()) if rows.any() else None
