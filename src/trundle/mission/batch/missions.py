"""`MissionBatch`: drives missions along their plans in a kernel, with the decisions of a `Navigator`."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from trundle._core import MissionDriver, chebyshev_field
from trundle.control.regulated_pure_pursuit import RegulatedPurePursuit
from trundle.costmap import LETHAL
from trundle.errors import InputError, PlanningError
from trundle.geometry import FloatArray, Goal, Pose2D, Twist2D
from trundle.mission.batch.meetings import find_meetings
from trundle.mission.batch.model import numbers_of
from trundle.mission.batch.needs import world_needs_python
from trundle.mission.batch.sensing import KernelDrive, MissionSensing, Sensing, monitors
from trundle.mission.episode import Episode, Outcome
from trundle.mission.metrics import Measure
from trundle.mission.observers import RunInfo
from trundle.mission.running import endings
from trundle.mission.running.endings import Ending
from trundle.mission.running.episode_maker import make_episode
from trundle.mission.running.preparation import allowed_time, describe_run, prepare, standing_at
from trundle.mission.running.run_log import AgentTotals, RunLog
from trundle.mission.scenario import Setting
from trundle.mission.trajectory import Trajectory
from trundle.navigation import Navigator
from trundle.navigation.obstacle_watch import STANDING_WITHIN
from trundle.path import Path
from trundle.planning import PathCheck
from trundle.sim.kinematic import TIMESTEP
from trundle.sim.ramp import count_steps
from trundle.worlds import World

_ARRIVED, _DRIVING = 0, 8
_HANDED_OVER = {
    2: "contact",
    3: "blocked",
    4: "no progress along the path",
    5: "no progress",
    6: "contact of a robot that stands",
    7: "held by the collision monitor",
}
"""Endings of the kernel with which a drive is handed over."""

_MOST_KERNELS = 2
_MOST_PERIODS, _LONGEST_M = 1_000_000, 10_000.0
"""What the kernel takes of a mission at most, in control periods and path [m]; its memory is bounded by them."""


@dataclass(frozen=True, slots=True, eq=False)
class BatchMission:
    """A mission to drive.

    Attributes:
        setting: Its world, robot and navigator.
        measure: Measures its surroundings for the metrics; None means that they are not measured.
    """

    setting: Setting
    measure: Measure | None = None


@dataclass(frozen=True, slots=True)
class HandedOver:
    """A mission that needs more than the kernel has: it is driven from its start, step by step.

    Attributes:
        reason: What it needs, in a few words: "blocked".
    """

    reason: str


@dataclass(frozen=True, slots=True, eq=False)
class _Planned:
    """A mission with its plan."""

    mission: BatchMission
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


class MissionBatch:
    """Drives missions from the start to the end: one call of a kernel for all that share a costmap and a robot.

    Each is driven as `trundle.run` drives it in a `KinematicSimulator`, with the same commands. Where a mission needs
    more than to follow its path (a step of recovery, a contact, giving up), it is handed over; and so it is where what
    its lidars see might make the robot drive otherwise: see `Sensing`.

    Args:
        threads: How many of them are driven at a time.
    """

    def __init__(self, threads: int = 1) -> None:
        self._threads = threads
        self._kernels: list[tuple[tuple[object, ...], bytes, MissionDriver]] = []
        self._world: tuple[World, str] | None = None
        self._sensing = Sensing()

    def drive(self, missions: Sequence[BatchMission]) -> list[Episode | HandedOver | PlanningError]:
        """Plan and drive missions.

        Returns:
            For each its episode; that it is handed over; or why the robot cannot stand at one of its ends.

        Raises:
            InputError: If the control period is no multiple of the simulator's substep.
        """
        ends = [self._plan(mission) for mission in missions]
        groups: dict[int, tuple[MissionDriver, list[int]]] = {}
        for number, planned in enumerate(ends):
            if isinstance(planned, _Planned):
                kernel = self._kernel_for(planned.navigator)
                groups.setdefault(id(kernel), (kernel, []))[1].append(number)
        for kernel, numbers in groups.values():
            group = [planned for number in numbers if isinstance(planned := ends[number], _Planned)]
            for number, end in zip(numbers, self._drive(kernel, group), strict=True):
                ends[number] = end
        done = [end for end in ends if not isinstance(end, _Planned)]
        for number, reason in find_meetings([each.setting for each in missions], done, self._threads).items():
            done[number] = HandedOver(reason)
        return done

    def _plan(self, mission: BatchMission) -> Episode | HandedOver | PlanningError | _Planned:
        """Plan a mission; what a plug-in raises costs no other one, and is raised again where that is driven."""
        try:
            return _plan(mission, self._needs_of(mission.setting.world))
        except InputError:
            raise
        except Exception as error:  # noqa: BLE001 - whatever a plug-in raises
            return HandedOver(f"{type(error).__name__} while it plans")

    def _drive(self, kernel: MissionDriver, group: Sequence[_Planned]) -> list[Episode | HandedOver]:
        """Drive missions by a kernel: at once, but for those whose commands pass a collision monitor."""
        monitored = [monitors(planned.mission.setting) for planned in group]
        alone = [planned for planned, is_checked in zip(group, monitored, strict=True) if not is_checked]
        together = iter(_drive_together(kernel, alone, self._threads))
        ends: list[Episode | HandedOver] = []
        for planned, is_checked in zip(group, monitored, strict=True):
            sensed = self._sensing.begin(planned.mission.setting)
            drive = _drive_checked(kernel, planned, sensed) if is_checked else next(together)
            reason = _HANDED_OVER.get(drive.ending) or sensed.find_difference(drive)
            ends.append(HandedOver(reason) if reason else _conclude(planned, drive, sensed.log.monitor_stops))
        return ends

    def _needs_of(self, world: World) -> str:
        """What of a world has to be simulated in Python; it is kept for the next missions there."""
        if self._world is None or self._world[0] is not world:
            self._world = world, world_needs_python(world)
        return self._world[1]

    def _kernel_for(self, navigator: Navigator) -> MissionDriver:
        """The kernel for a navigator's costmap and settings; it is kept for the next missions."""
        costmap = navigator.costmap
        parts = (costmap, navigator.controller, navigator.goal_checker, navigator.progress_checker)
        for kept, _, kernel in self._kernels:
            if all(one is other for one, other in zip(kept, parts, strict=True)):
                return kernel
        numbers = numbers_of(navigator)
        key = b"".join(array.tobytes() for array in numbers)
        for kept, its_key, kernel in self._kernels:
            if kept[0] is costmap and its_key == key:
                return kernel
        blocked = (costmap.data >= LETHAL).view(np.uint8)
        origin = np.array(costmap.origin.as_tuple())
        kernel = MissionDriver(costmap.data, chebyshev_field(blocked), costmap.resolution, origin, *numbers)
        self._kernels = [*self._kernels[-_MOST_KERNELS + 1 :], (parts, key, kernel)]
        return kernel


def _plan(mission: BatchMission, needs: str) -> _Planned | Episode | HandedOver | PlanningError:
    """Plan a mission, as a session does before its first step."""
    began_s = clock.perf_counter()
    setting = mission.setting
    scenario, start, goals = setting.scenario, setting.start, setting.goals
    if needs:
        return HandedOver(needs)
    if setting.world.movers and scenario.lidar:
        return HandedOver("movers that lidars see")
    navigator = setting.navigator
    if type(navigator.controller) is not RegulatedPurePursuit or len(goals) != 1:
        return HandedOver("it does not drive to one goal by regulated_pure_pursuit")
    navigator.reset(seed=scenario.seed)
    try:
        paths, unreachable = prepare(navigator, start, goals, through=None)
    except PlanningError as error:
        return error
    limit_s = scenario.time_limit_s
    if limit_s is None:
        limit_s = allowed_time(navigator, setting.robot, start, goals, paths)
    info = describe_run(
        navigator.info(),
        navigator.dt,
        setting.robot,
        scenario.title,
        start,
        goals,
        paths,
        limit_s,
        scenario.seed,
        setting.world,
    )
    planned = _Planned(mission, navigator, info, began_s)
    if unreachable is not None:
        is_touching = bool(navigator.costmap.footprint_collides(start.as_tuple())[0])
        return (
            HandedOver("contact") if is_touching else _give_up(_Planned(mission, navigator, info, began_s), unreachable)
        )
    if navigator.path is None:
        return HandedOver("a plan that takes long")
    if limit_s / navigator.dt > _MOST_PERIODS or navigator.path.length > _LONGEST_M:
        return HandedOver("a long drive")
    return planned


def _drive_together(kernel: MissionDriver, group: Sequence[_Planned], threads: int) -> Iterator[KernelDrive]:
    """Drive missions in one call of a kernel."""
    if not group:
        return
    routes = [planned.route for planned in group]
    rows, ends, results = kernel.drive(
        np.array([planned.info.start.as_tuple() for planned in group]),
        np.array([_goal_numbers(planned.info.goals[0]) for planned in group]),
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


def _drive_checked(kernel: MissionDriver, planned: _Planned, sensed: MissionSensing) -> KernelDrive:
    """Drive a mission whose commands pass a collision monitor."""
    (path, check), info = planned.route, planned.info
    patience_s = planned.navigator.settings.patience_s
    run = kernel.begin(
        np.array(info.start.as_tuple()),
        np.array(_goal_numbers(info.goals[0])),
        info.time_limit_s,
        path.poses,
        np.append(path.backward, False),
        check.poses,
        check.along,
        np.array([*STANDING_WITHIN, patience_s]),
    )
    steps, period = count_steps(info.dt, TIMESTEP), 0
    while True:
        ending, x, y, yaw, v, w, wished_v, wished_w = run.decide()
        if ending != _DRIVING:
            break
        time = period * steps * TIMESTEP
        sent = sensed.check(Twist2D(wished_v, wished_w), Twist2D(v, w), time, Pose2D(x, y, yaw))
        run.move(sent.v, sent.w)
        period += 1
    rows, standing = run.result()
    return _as_drive(planned, rows, ending, standing)


def _as_drive(planned: _Planned, rows: FloatArray, ending: int, standing: int) -> KernelDrive:
    steps = count_steps(planned.info.dt, TIMESTEP)
    time = np.arange(0.0, len(rows) * steps, steps) * TIMESTEP
    return KernelDrive(time, rows, planned.route[1], ending, standing)


def _conclude(planned: _Planned, drive: KernelDrive, monitor_stops: int | None) -> Episode:
    """The episode of a drive."""
    info, rows, time = planned.info, drive.rows, drive.time
    log = RunLog.of(_trajectory(time, rows), (planned.route[0],))
    log.monitor_stops = monitor_stops
    totals = AgentTotals()
    if drive.standing:
        totals.standing_reasons["no valid control"] += drive.standing
    state = replace(standing_at(Pose2D(*rows[-1, :3].tolist()))[0], time=float(time[-1]))
    is_there = drive.ending == _ARRIVED
    ending = endings.at_goal(state, None) if is_there else endings.timed_out(info.goals, info.time_limit_s)
    return _make_episode(planned, log, totals, ending)


def _give_up(planned: _Planned, error: PlanningError) -> Episode:
    """The episode of a mission without a path."""
    state, estimate = standing_at(planned.info.start)
    log = RunLog()
    log.add(state, Twist2D(), estimate, 0, None)
    return _make_episode(planned, log, AgentTotals(), (Outcome.NO_PATH, str(error)), complete=error.complete)


def _make_episode(
    planned: _Planned, log: RunLog, totals: AgentTotals, ending: Ending, *, complete: bool | None = None
) -> Episode:
    totals.add(planned.navigator.report())
    outcome, message = ending
    return make_episode(
        planned.info,
        log,
        totals,
        outcome,
        message,
        goals_reached=int(outcome is Outcome.ARRIVED),
        behaviors=(),
        directives=(),
        world=planned.info.world,
        boxes=(),
        wall_s=clock.perf_counter() - planned.began_s,
        measure=planned.mission.measure,
        complete=complete,
    )


def _trajectory(time: FloatArray, rows: FloatArray) -> Trajectory:
    x, y, yaw, v, w, commanded_v, commanded_w = rows.T
    none = np.zeros(len(time), dtype=np.int64)
    return Trajectory(time, x, y, yaw, v, w, commanded_v, commanded_w, x, y, yaw, goal=none, path=none)


def _goal_numbers(goal: Goal) -> tuple[float, float, float]:
    return goal.pose.x, goal.pose.y, math.nan if goal.yaw_free else goal.pose.yaw
