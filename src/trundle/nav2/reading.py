"""`read_nav2_params`: Nav2's parameter file as the settings of a scenario."""

from __future__ import annotations

import os
from collections.abc import Collection
from dataclasses import dataclass
from typing import cast

import numpy as np

from trundle.control import MonitorSettings
from trundle.errors import InputError, ScenarioError
from trundle.geometry import FloatArray
from trundle.mission import Scenario
from trundle.mission.fields import AssumedLimits
from trundle.nav2.amcl import read_localizer, read_start
from trundle.nav2.controllers import read_checkers, read_controller
from trundle.nav2.costmaps import read_costmaps
from trundle.nav2.filters import read_filters
from trundle.nav2.monitor import read_monitor
from trundle.nav2.notes import Notes, Remark, reason_for
from trundle.nav2.outline import DECIMALS as _DECIMALS
from trundle.nav2.parameters import NodeParameters, ParameterFile
from trundle.nav2.planners import read_planner, read_smoother, reads_unknown
from trundle.nav2.servers import read_limits, read_recovery
from trundle.robots import Limits, Robot


@dataclass(frozen=True, slots=True, eq=False)
class Nav2Settings:
    """What a parameter file says, in trundle's terms.

    Attributes:
        settings: Fields of a scenario with their values, for `Scenario.make(**settings)`.
        remarks: Every parameter that means something else in trundle, or has no counterpart.
    """

    settings: dict[str, object]
    remarks: tuple[Remark, ...]


def read_nav2_params(
    path: str | os.PathLike[str], robot: Robot | str | None = None, *, given: Collection[str] = ()
) -> Nav2Settings:
    """Read Nav2's parameter file as settings of a scenario.

    Where the file has a server but not one of its parameters, Nav2's default counts. A server that the file does not
    have leaves trundle's settings as they are.

    Args:
        path: The file.
        robot: The robot that is driven, or its name: what is as the robot has it needs no setting. If None, the
            settings are for any robot.
        given: Fields of the scenario that come from elsewhere: files that the parameters name for them need not exist.

    Raises:
        InputError: If the file cannot be read, or a parameter cannot be used: what, where, and what to do.
    """
    file = ParameterFile(path)
    own = None if robot is None else Robot.load(robot)
    notes = Notes()
    for twice in file.repeated:
        notes.given_twice(twice)
    settings = _read_costmaps(file, own, notes)
    controllers, planners = file.node("controller_server"), file.node("planner_server")
    if controllers is not None:
        settings["controller"] = read_controller(controllers, notes)
        settings |= read_checkers(controllers, notes)
    if planners is not None:
        settings["planner"] = read_planner(planners, notes)
    smoothers = file.node("smoother_server")
    if smoothers is not None:
        smoother = read_smoother(smoothers, notes)
        settings |= {} if smoother is None else {"smoother": smoother}
    behaviors = file.node("behavior_server") or file.node("recoveries_server")
    if behaviors is not None:
        settings |= read_recovery(behaviors, notes)
    _add_limits(settings, file.node("velocity_smoother"), own, notes)
    _add_monitor(settings, file.node("collision_monitor"), own, notes)
    costmaps = [node for node in (file.node("global_costmap"), file.node("local_costmap")) if node is not None]
    settings |= read_filters(file, costmaps, frozenset(given), notes)
    amcl = file.node("amcl")
    if amcl is not None:
        start = read_start(amcl)
        if start is not None:
            settings["start"] = list(start)
        if "lidar" in settings and settings.get("known_map", True):
            settings["localizer"] = read_localizer(amcl, notes)
    for node, parameter in file.unread():
        notes.ignore_parameter(node, parameter, reason_for(node, parameter.name))
    _check(settings, file)
    return Nav2Settings(settings, tuple(notes.remarks))


def _check(settings: dict[str, object], file: ParameterFile) -> None:
    """Check what only a scenario can check, such as the ranges of trundle's settings."""
    try:
        Scenario.make(**{"world": "warehouse", **settings})
    except ScenarioError as error:
        raise InputError("\n".join(f"{file.path}: {line}" for line in str(error).splitlines())) from error


def _read_costmaps(file: ParameterFile, robot: Robot | None, notes: Notes) -> dict[str, object]:
    planners = file.node("planner_server")
    crosses = True if planners is None else reads_unknown(planners)
    settings = read_costmaps(
        file.node("global_costmap"), file.node("local_costmap"), crosses_unknown=crosses, notes=notes
    )
    outline = _outline_of(settings)
    if robot is not None and outline is not None and _same_outline(outline, robot.outline):
        del settings["assumed"]
    if robot is not None and "lidar" in settings and not robot.lidars:
        del settings["lidar"]
        settings.pop("known_map", None)
        layer = file.node("local_costmap") or cast("NodeParameters", file.node("global_costmap"))
        notes.changed(layer, "plugins", f"{robot.name} has no lidars: no obstacles are sensed")
    return settings


def _outline_of(settings: dict[str, object]) -> FloatArray | None:
    assumed = settings.get("assumed")
    return None if not isinstance(assumed, dict) else np.asarray(assumed["footprint"], dtype=np.float64)


def _same_outline(one: FloatArray, other: FloatArray) -> bool:
    corners = {tuple(corner) for corner in one.round(_DECIMALS).tolist()}
    return corners == {tuple(corner) for corner in other.round(_DECIMALS).tolist()}


def _add_limits(
    settings: dict[str, object], smoother: NodeParameters | None, robot: Robot | None, notes: Notes
) -> None:
    """Add the limits of the velocity smoother, of a known robot only those below its own."""
    if smoother is None:
        return
    limits = read_limits(smoother, notes)
    if robot is not None:
        kept = _assume(limits, smoother).within(robot.limits)
        own = AssumedLimits().within(robot.limits)
        for name, value in limits.items():
            if value > getattr(own, name):
                _note_limit(smoother, name, value, own, notes)
        limits = {name: value for name, value in limits.items() if getattr(kept, name) < getattr(own, name)}
    if limits:
        assumed = settings.get("assumed")
        settings["assumed"] = {**(assumed if isinstance(assumed, dict) else {}), "limits": limits}


def _assume(limits: dict[str, float], smoother: NodeParameters) -> AssumedLimits:
    try:
        return AssumedLimits(**limits)
    except InputError as error:
        raise smoother.wrong("max_velocity", f"gives limits that cannot be used: {error}") from error


_LIMIT_NAMES = {
    "linear_speed": "max_velocity",
    "reverse_speed": "min_velocity",
    "angular_speed": "max_velocity",
    "linear_acceleration": "max_accel",
    "angular_acceleration": "max_accel",
}


def _note_limit(smoother: NodeParameters, name: str, value: float, own: Limits, notes: Notes) -> None:
    parameter = _LIMIT_NAMES[name]
    text = f"{name.replace('_', ' ')} {value:g} is above the robot's own {getattr(own, name):g}, which holds"
    notes.default(smoother, parameter, value, text)


def _add_monitor(settings: dict[str, object], node: NodeParameters | None, robot: Robot | None, notes: Notes) -> None:
    """Add the collision monitor if scans come in; trundle's own, if the file has no monitor."""
    if "lidar" not in settings:
        return
    outline = _outline_of(settings)
    if outline is None and robot is not None:
        outline = robot.outline
    if node is None:
        settings["collision_monitor"] = MonitorSettings().model_dump(mode="json", exclude_none=True)
    elif outline is not None:
        settings["collision_monitor"] = read_monitor(node, outline, notes)
