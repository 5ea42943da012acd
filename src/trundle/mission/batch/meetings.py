"""`find_meetings`: whether robots without lidars, once their drives are known, meet what moves in their worlds.

A robot that sees nobody drives the same among people as alone. So its drive is computed without them, and then repeated
among them, command by command: where nothing is touched, it stays as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from trundle.errors import InputError, WorldError
from trundle.maps import OccupancyGrid
from trundle.mission.episode import Episode
from trundle.mission.scenario import Setting
from trundle.mission.trajectory import Trajectory
from trundle.robots import Robot
from trundle.sim.batch import MOVER, BatchSimulator, MoverRecording
from trundle.sim.kinematic import TIMESTEP
from trundle.worlds import World
from trundle.worlds.movers.mover import Mover
from trundle.worlds.movers.walk import PERIOD_S


class _KnownDrive(NamedTuple):
    """A drive to be repeated: its world, robot and seed, and where it led with which commands."""

    setting: Setting
    trajectory: Trajectory


def find_meetings(settings: Sequence[Setting], ends: Sequence[object], threads: int) -> dict[int, str]:
    """Repeat drives among the movers of their worlds.

    Args:
        settings: The settings of missions.
        ends: What became of each; those that are episodes are repeated where the world has movers.
        threads: How many threads drive.

    Returns:
        The numbers of those that have to be driven in Python, and why: such as "contact".
    """
    groups: dict[tuple[int, int, float], dict[int, _KnownDrive]] = {}
    for number, (setting, end) in enumerate(zip(settings, ends, strict=True)):
        if isinstance(end, Episode) and setting.world.movers:
            key = id(setting.world), id(setting.robot), setting.navigator.dt
            groups.setdefault(key, {})[number] = _KnownDrive(setting, end.trajectory)
    reasons: dict[int, str] = {}
    for group in groups.values():
        try:
            found = _repeat(list(group.values()), threads)
        except Exception as error:  # noqa: BLE001 - whatever a plug-in's mover raises; it is raised again when driven
            found = [f"{type(error).__name__} among movers"] * len(group)
        reasons |= {number: reason for number, reason in zip(group, found, strict=True) if reason}
    return reasons


def _repeat(group: Sequence[_KnownDrive], threads: int) -> list[str]:
    """Repeat drives in one world with one robot."""
    setting = group[0].setting
    lengths = np.array([len(drive.trajectory) for drive in group])
    try:
        simulator = _simulator(setting.world, setting.robot, len(group), lengths.max() * setting.navigator.dt, threads)
    except (InputError, WorldError) as error:
        return [str(error)] * len(group)
    reasons = [""] * len(group)
    for number, (chosen, trajectory) in enumerate(group):
        start = trajectory.x[0], trajectory.y[0], trajectory.yaw[0]
        try:
            simulator.reset(start, robots=[number], recordings=0, seeds=chosen.scenario.seed)
        except WorldError as error:
            reasons[number] = str(error)
    placed = np.array([not reason for reason in reasons])
    commands = np.zeros((lengths.max(), len(group), 2))
    for number, (_, trajectory) in enumerate(group):
        commands[: len(trajectory), number, 0] = trajectory.commanded_v
        commands[: len(trajectory), number, 1] = trajectory.commanded_w
    touched = placed & (simulator.contacts[:, 0] == MOVER)
    for period in range(1, lengths.max()):  # the command of a row is the one that led to it
        active = placed & ~touched & (period < lengths)
        if not active.any():
            break
        simulator.step(commands[period], setting.navigator.dt, robots=active)
        touched |= active & (simulator.contacts[:, 0] == MOVER)
    return ["contact" if hit else reason for hit, reason in zip(touched.tolist(), reasons, strict=True)]


def _simulator(world: World, robot: Robot, count: int, seconds: float, threads: int) -> BatchSimulator:
    """A simulator of the world's movers alone: what stands there was looked at when the drives were computed."""
    cells = int(np.ceil(2.0 * robot.circumscribed_radius)) + 1
    nothing = OccupancyGrid(np.zeros((cells, cells), dtype=np.int8), 1.0)
    # Between two samples movers go straight: only those at the simulator's steps miss none of its contacts.
    period = TIMESTEP if any(isinstance(mover, Mover) for mover in world.movers) else PERIOD_S
    recording = MoverRecording.of_world(world, robot, duration_s=seconds, period_s=period, live_crowds=True)
    return BatchSimulator(nothing, robot, count=count, recordings=[recording], timestep=TIMESTEP, threads=threads)
