"""`report_folder`: the report of a run's folder, made again or for the first time."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from trundle.errors import InputError, TrundleError
from trundle.files.opening import is_file, open_file, read_up_to
from trundle.maps import OccupancyGrid
from trundle.mission.episode import Episode
from trundle.mission.run_files import read_record
from trundle.mission.scenario import Scenario
from trundle.page.encoding import unpack_json
from trundle.page.report import REPORT, report_scene, write_report
from trundle.page.run_rows import run_of
from trundle.robots import Robot
from trundle.worlds import World

_MOST_BYTES = 100_000_000
_STAND_IN = "nova_carter"
_BEFORE, _AFTER = '<script type="application/json" id="boot">', "</script>"


def report_folder(folder: str | os.PathLike[str], out: str | os.PathLike[str] | None = None) -> Path:
    """Write the report of a run from its folder.

    What the run's own report holds, such as scans, is kept where there is one. Without one it is made of the run's
    other files: the world and the robot are made again from scenario.yaml; where that is not possible, the map and a
    robot that stands for it are drawn, and a note says so.

    Args:
        folder: The run's folder.
        out: The file; None means `report.html` in the folder.

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
    """Run and scene of a run's report; none where there is none, or it is damaged or of another run."""
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
    """The scenario of a run, or why there is none."""
    if not is_file(place / "scenario.yaml"):
        return None, "the folder has no scenario.yaml"
    try:
        return Scenario.load(place), ""
    except InputError as error:
        return None, str(error)


def _surroundings(place: Path, record: Mapping[str, Any]) -> tuple[World | None, Robot, OccupancyGrid | None, str]:
    """World, robot and map of a run, and what could not be had of them."""
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
