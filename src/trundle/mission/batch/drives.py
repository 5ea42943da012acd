"""Drives of planned missions: by a kernel at once, period by period where needed, and once more among movers."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from trundle._core import MissionDriver, MissionRun
from trundle.errors import InputError, NoValidControlError, WorldError
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.maps import OccupancyGrid
from trundle.mission.batch.sensing import BatchDrive, MissionSensing
from trundle.mission.episode import Episode
from trundle.mission.metrics import Measure
from trundle.mission.observers import RunInfo
from trundle.mission.scenario import Setting
from trundle.mission.trajectory import Trajectory
from trundle.navigation import Navigator
from trundle.navigation.obstacle_watch import STANDING_WITHIN
from trundle.path import Path
from trundle.planning import PathCheck
from trundle.robots import Robot
from trundle.sim.batch import MOVER, BatchSimulator, MoverRecording
from trundle.sim.kinematic import TIMESTEP
from trundle.sim.ramp import count_steps
from trundle.worlds import World
from trundle.worlds.movers.mover import Mover
from trundle.worlds.movers.walk import PERIOD_S

ARRIVED, DRIVING = 0, 8
"""Endings of the kernel: at the goal, and none yet."""

_STAND = Twist2D()
_NO_CONTROL = "no valid control"


@dataclass(frozen=True, slots=True, eq=False)
class Planned:
    """A mission with its plan."""

    setting: Setting
    measure: Measure | None
    navigator: Navigator
    info: RunInfo
    began_s: float

    @property
    def route(self) -> tuple[Path, PathCheck]:
        """The path, and its check.

        Raises:
            InputError: If there is none.
        """
        path, check = self.navigator.path, self.navigator.path_check
        if path is None or check is None:
            raise InputError("the mission has no path")
        return path, check

    @property
    def goal_numbers(self) -> tuple[float, float, float]:
        """(x, y, yaw) of the goal; a yaw that is free is no number."""
        goal = self.info.goals[0]
        return goal.pose.x, goal.pose.y, np.nan if goal.yaw_free else goal.pose.yaw


def drive_together(kernel: MissionDriver, group: Sequence[Planned], threads: int) -> Iterator[BatchDrive]:
    """Drive missions in one call of a kernel."""
    if not group:
        return
    routes = [planned.route for planned in group]
    rows, ends, results = kernel.drive(
        np.array([planned.info.start.as_tuple() for planned in group]),
        np.array([planned.goal_numbers for planned in group]),
        np.array([planned.info.time_limit_s for planned in group]),
        np.concatenate([path.poses for path, _ in routes]),
        np.concatenate([np.append(path.backward, False) for path, _ in routes]),
        np.cumsum([len(path.poses) for path, _ in routes]),
        np.concatenate([check.poses for _, check in routes]),
        np.concatenate([check.along for _, check in routes]),
        np.cumsum([len(check.poses) for _, check in routes]),
        threads,
    )
    first = 0
    for planned, end, (ending, standing) in zip(group, ends.tolist(), results.tolist(), strict=True):
        yield _as_drive(planned, rows[first:end], ending, standing)
        first = end


def drive_checked(kernel: MissionDriver, planned: Planned, sensed: MissionSensing) -> BatchDrive:
    """Drive a mission whose commands pass a collision monitor."""
    run, clock = _begin(kernel, planned), _Clock(planned)
    while True:
        ending, x, y, yaw, v, w, wished_v, wished_w = run.decide()
        if ending != DRIVING:
            break
        time, pose = clock.tick(), Pose2D(x, y, yaw)
        scans = sensed.look(time, pose)
        sent = sensed.check(Twist2D(wished_v, wished_w), Twist2D(v, w), scans, time, pose)
        run.move(sent.v, sent.w)
    return _as_drive(planned, *_result(run, ending))


def drive_by_controller(kernel: MissionDriver, planned: Planned, sensed: MissionSensing) -> BatchDrive:
    """Drive a mission by its navigator's controller: the kernel has motion, contacts, goal and progress."""
    controller, dt, check = planned.navigator.controller, planned.info.dt, planned.route[1]
    run, clock = _begin(kernel, planned), _Clock(planned)
    reasons: Counter[str] = Counter()
    surroundings, checked = sensed.surroundings(), planned.navigator.costmap
    needs = "an unmapped box near the path" if sensed.comes_near_box(check.poses) else ""
    while not needs:
        ending, x, y, yaw, v, w = run.look()
        if ending != DRIVING:
            return _as_drive(planned, *_result(run, ending), reasons)
        time, pose, twist = clock.tick(), Pose2D(x, y, yaw), Twist2D(v, w)
        scans = sensed.look(time, pose)
        surroundings.take(scans, time, pose)
        if surroundings.costmap is not checked:
            checked = surroundings.costmap
            if check.first_hit(checked) is not None:
                needs = "the path is blocked"
                break
        controller.set_tracks(surroundings.tracks)
        try:
            wish, blocked = controller.compute_velocity(pose, twist, checked, dt), ""
        except NoValidControlError:
            wish, blocked = _STAND, _NO_CONTROL
        if reason := controller.reason or blocked:
            reasons[reason] += 1
        ending = run.take(wish.v, wish.w)
        if ending != DRIVING:
            return _as_drive(planned, *_result(run, ending), reasons)
        sent = sensed.check(wish, twist, scans, time, pose, controller.intent)
        run.move(sent.v, sent.w)
    return BatchDrive(np.zeros(0), np.zeros((0, 7)), check, DRIVING, reasons, needs)


class _Clock:
    """Tells the time at the beginning of each control period [s], as the simulator does."""

    def __init__(self, planned: Planned) -> None:
        self._steps, self._period = count_steps(planned.info.dt, TIMESTEP), -1

    def tick(self) -> float:
        """Return the next one."""
        self._period += 1
        return self._period * self._steps * TIMESTEP


def _begin(kernel: MissionDriver, planned: Planned) -> MissionRun:
    (path, check), info = planned.route, planned.info
    return kernel.begin(
        np.array(info.start.as_tuple()),
        np.array(planned.goal_numbers),
        info.time_limit_s,
        path.poses,
        np.append(path.backward, False),
        check.poses,
        check.along,
        np.array([*STANDING_WITHIN, planned.navigator.settings.patience_s]),
    )


def _result(run: MissionRun, ending: int) -> tuple[FloatArray, int, int]:
    rows, standing = run.result()
    return rows, ending, standing


def _as_drive(
    planned: Planned, rows: FloatArray, ending: int, standing: int, reasons: Counter[str] | None = None
) -> BatchDrive:
    steps = count_steps(planned.info.dt, TIMESTEP)
    time = np.arange(0.0, len(rows) * steps, steps) * TIMESTEP
    counted = Counter({_NO_CONTROL: standing} if standing else {}) if reasons is None else reasons
    return BatchDrive(time, rows, planned.route[1], ending, counted)


class _KnownDrive(NamedTuple):
    """A drive to be repeated: its world, robot and seed, and where it led with which commands."""

    setting: Setting
    trajectory: Trajectory


def find_meetings(settings: Sequence[Setting], ends: Sequence[object], threads: int) -> dict[int, str]:
    """Return whether robots without lidars, once their drives are known, meet what moves in their worlds.

    A robot that sees nobody drives the same among people as alone. So its drive is computed without them, and then
    repeated among them, command by command: where nothing is touched, it stays as it is.

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
    """Return a simulator of the world's movers alone: what stands there was looked at when the drives were computed."""
    cells = int(np.ceil(2.0 * robot.circumscribed_radius)) + 1
    nothing = OccupancyGrid(np.zeros((cells, cells), dtype=np.int8), 1.0)
    # Between two samples movers go straight: only those at the simulator's steps miss none of its contacts.
    period = TIMESTEP if any(isinstance(mover, Mover) for mover in world.movers) else PERIOD_S
    recording = MoverRecording.of_world(world, robot, duration_s=seconds, period_s=period, live_crowds=True)
    return BatchSimulator(nothing, robot, count=count, recordings=[recording], timestep=TIMESTEP, threads=threads)
