"""What a robot on the network, or a recording of one, is driven with: its map, its navigator and its localizer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from trundle.errors import InputError
from trundle.geometry import Goal, Pose2D
from trundle.localization import Localizer, create_localizer
from trundle.mapping.slam_localizer import SlamLocalizer
from trundle.maps import OccupancyGrid
from trundle.mission import Scenario
from trundle.mission.scenario import Setting
from trundle.mission.setup import Place, make_place
from trundle.robots import Robot
from trundle.ros2.profile import Profile
from trundle.ros2.remote.localizer import MapFit, RemoteLocalizer
from trundle.ros2.static_frames import StaticFramesMode
from trundle.worlds import World

TF = "tf"
"""The localizer that takes map → odom from outside."""


@dataclass(frozen=True, slots=True)
class RemoteOptions:
    """How a robot on the network is driven.

    Attributes:
        localizer: "tf", or None for the localizer of the scenario.
        start: Where the robot is at first, map frame; None where that comes on /initialpose.
        goals: Where it drives, in order, and then the run ends. If empty, it waits for goals.
        static_frames: Whether base → sensor is published.
    """

    localizer: Literal["tf"] | None = None
    start: Pose2D | None = None
    goals: tuple[Goal, ...] = ()
    static_frames: StaticFramesMode = "auto"


def prepare(scenario: Scenario, profile: Profile, options: RemoteOptions, *, robot: Robot | None = None) -> Setting:
    """Make map, robot and navigator of a scenario for a robot on the network, at its start.

    Args:
        scenario: The scenario.
        profile: Names of topics and sensors.
        options: Where it starts and drives.
        robot: The robot. If None, it is the scenario's.

    Raises:
        InputError: If they cannot be used, or the start is not on the map.
    """
    place = make_place(scenario) if scenario.known_map else _no_place(scenario)
    place = replace(place, robot=profile.fit(place.robot if robot is None else robot))
    start = options.start
    changes: dict[str, object] = {"start": None, "goal": None, "goals": None}
    if not scenario.known_map:  # nothing has to be picked, and no cell of the map be free
        changes |= {"start": (0.0, 0.0, 0.0), "goal": (0.0, 0.0)}
    setting = scenario.model_copy(update={**changes, "lidar": bool(profile.sensors_of(place.robot))}).prepare(place)
    if not scenario.known_map:
        return replace(setting, start=Pose2D(0.0, 0.0) if start is None else start)
    for what, at in (("start", start), *(("goal", goal.pose) for goal in options.goals)):
        if at is not None and not bool(setting.grid.contains(*setting.grid.world_to_cell(at.x, at.y))):
            raise InputError(f"the {what} ({at.x:g}, {at.y:g}) lies outside of the map: give a pose on it")
    return setting if start is None else replace(setting, start=start)


def _no_place(scenario: Scenario) -> Place:
    """Return the place of a robot that knows no map: an empty world."""
    blank = OccupancyGrid(np.zeros((80, 80), dtype=np.int8), scenario.resolution, Pose2D(-2.0, -2.0))
    return Place(World("unknown", ()), Robot.load(scenario.robot), blank, 0.0, None, None)


def make_localizer(
    setting: Setting, options: RemoteOptions, is_ready: Callable[[], bool], *, has_scans: bool
) -> RemoteLocalizer:
    """Make the localizer of a scenario.

    Args:
        setting: Map, robot and navigator.
        options: Where the robot is at first.
        is_ready: Whether the robot has sent its odometry.
        has_scans: Whether it sends scans.

    Raises:
        InputError: If there is none, or it cannot be made.
    """
    inner, fit = make_parts(setting, has_scans=has_scans)
    start = options.start
    if start is None and isinstance(inner, SlamLocalizer):
        start = Pose2D(0.0, 0.0)  # its map begins where the robot stands
    return RemoteLocalizer(inner, start, is_ready, needs_scan=_sees(setting, has_scans=has_scans), fit=fit)


def make_parts(setting: Setting, *, has_scans: bool) -> tuple[Localizer, MapFit | None]:
    """Make what estimates the pose on a setting's map, and what says whether scans fit it; None where nothing does.

    Args:
        setting: Map, robot and navigator.
        has_scans: Whether the robot sends scans.

    Raises:
        InputError: If there is none, or it cannot be made.
    """
    scenario = setting.scenario
    if scenario.localizer is None:
        raise InputError("a robot on the network needs a localizer: amcl, slam, odometry or tf")
    inner = create_localizer(scenario.localizer, setting.grid if scenario.known_map else None, setting.robot)
    return inner, MapFit(setting.grid) if scenario.known_map and _sees(setting, has_scans=has_scans) else None


def _sees(setting: Setting, *, has_scans: bool) -> bool:
    """Return whether the localizer of a scenario locates the robot by its scans."""
    choice = setting.scenario.localizer
    return has_scans and choice is not None and choice.name != "odometry"
