"""`MissionBatch`: drives missions along their plans in a kernel, with the decisions of a `Navigator`."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from trundle._core import MissionDriver, chebyshev_field
from trundle.control.mppi import MppiController
from trundle.control.pursuit_settings import PursuitSettings
from trundle.control.regulated_pure_pursuit import RegulatedPurePursuit
from trundle.costmap import LETHAL
from trundle.errors import PlanningError
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.mission.batch.drives import (
    ARRIVED,
    Planned,
    drive_by_controller,
    drive_checked,
    drive_together,
    find_meetings,
)
from trundle.mission.batch.needs import CONTROLLERS, world_needs_python
from trundle.mission.batch.sensing import BatchDrive, Sensing, monitors
from trundle.mission.episode import Episode, Outcome
from trundle.mission.metrics import Measure
from trundle.mission.running import endings
from trundle.mission.running.endings import Ending
from trundle.mission.running.episode_maker import make_episode
from trundle.mission.running.preparation import allowed_time, describe_run, prepare, standing_at
from trundle.mission.running.run_log import AgentTotals, RunLog
from trundle.mission.scenario import Setting
from trundle.mission.trajectory import Trajectory
from trundle.navigation import Navigator
from trundle.sim.kinematic import TIMESTEP
from trundle.sim.ramp import count_steps
from trundle.worlds import World

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


class MissionBatch:
    """Drives missions from the start to the end: one call of a kernel for all that share a costmap and a robot.

    Each is driven as `trundle.run` drives it in a `KinematicSimulator`, with the same commands. Where a mission needs
    more than to follow its path (a step of recovery, a contact, giving up), it is handed over; and so it is where what
    its lidars see might make the robot drive otherwise: see `Sensing`. Those of `mppi` are driven period by period,
    with their own samples, costmap and tracks.

    What is raised in one mission costs no other: that one is handed over, and fails there as it would alone.

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
        """
        ends = [self._plan(mission) for mission in missions]
        groups: dict[int, tuple[MissionDriver, list[int]]] = {}
        for number, planned in enumerate(ends):
            if isinstance(planned, Planned):
                try:
                    kernel = self._kernel_for(planned.navigator)
                except Exception as error:  # noqa: BLE001 - it is raised again where that is driven
                    ends[number] = _failed(error)
                    continue
                groups.setdefault(id(kernel), (kernel, []))[1].append(number)
        for kernel, numbers in groups.values():
            group = [planned for number in numbers if isinstance(planned := ends[number], Planned)]
            for number, end in zip(numbers, self._drive(kernel, group), strict=True):
                ends[number] = end
        done = [end for end in ends if not isinstance(end, Planned)]
        for number, reason in find_meetings([each.setting for each in missions], done, self._threads).items():
            done[number] = HandedOver(reason)
        return done

    def _plan(self, mission: BatchMission) -> Episode | HandedOver | PlanningError | Planned:
        """Plan a mission."""
        try:
            return _plan(mission, self._needs_of(mission.setting.world))
        except Exception as error:  # noqa: BLE001 - whatever a plug-in raises
            return HandedOver(f"{type(error).__name__} while it plans")

    def _drive(self, kernel: MissionDriver, group: Sequence[Planned]) -> list[Episode | HandedOver]:
        """Drive missions by a kernel: at once, but for those whose commands come from or pass something else."""
        alone = [planned for planned in group if _is_alone(planned)]
        try:
            together = dict(zip(map(id, alone), drive_together(kernel, alone, self._threads), strict=True))
        except Exception:  # noqa: BLE001 - one of them is at fault: each is driven on its own
            together = {}
        ends: list[Episode | HandedOver] = []
        for planned in group:
            try:
                ends.append(self._finish(kernel, planned, together.get(id(planned))))
            except Exception as error:  # noqa: BLE001 - whatever a plug-in raises
                ends.append(_failed(error))
        return ends

    def _finish(self, kernel: MissionDriver, planned: Planned, drive: BatchDrive | None) -> Episode | HandedOver:
        """Drive a mission, unless that is done, and judge whether its lidars would have made a difference."""
        sensed = self._sensing.begin(planned.setting)
        if _samples(planned):
            drive = drive_by_controller(kernel, planned, sensed)
        elif drive is None:
            drive = drive_checked(kernel, planned, sensed)
        reason = drive.needs or _HANDED_OVER.get(drive.ending) or sensed.find_difference(drive)
        return HandedOver(reason) if reason else _conclude(planned, drive, sensed.log.monitor_stops)

    def _needs_of(self, world: World) -> str:
        """Return what of a world has to be simulated in Python; it is kept for the next missions there."""
        if self._world is None or self._world[0] is not world:
            self._world = world, world_needs_python(world)
        return self._world[1]

    def _kernel_for(self, navigator: Navigator) -> MissionDriver:
        """Return the kernel for a navigator's costmap and settings; it is kept for the next missions."""
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


def _is_alone(planned: Planned) -> bool:
    """Return whether nothing but the kernel decides on a drive."""
    return not _samples(planned) and not monitors(planned.setting)


def _samples(planned: Planned) -> bool:
    """Return whether a mission is driven by samples."""
    return isinstance(planned.navigator.controller, MppiController)


def _failed(error: Exception) -> HandedOver:
    return HandedOver(f"{type(error).__name__} while it drives")


def _plan(mission: BatchMission, needs: str) -> Planned | Episode | HandedOver | PlanningError:
    """Plan a mission, as a session does before its first step."""
    began_s = clock.perf_counter()
    setting = mission.setting
    scenario, start, goals = setting.scenario, setting.start, setting.goals
    if needs:
        return HandedOver(needs)
    if setting.world.movers and scenario.lidar:
        return HandedOver("movers that lidars see")
    navigator = setting.navigator
    if type(navigator.controller) not in (RegulatedPurePursuit, MppiController) or len(goals) != 1:
        return HandedOver(f"it does not drive to one goal by {' or '.join(CONTROLLERS)}")
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
    planned = Planned(setting, mission.measure, navigator, info, began_s)
    if unreachable is not None:
        is_touching = bool(navigator.costmap.footprint_collides(start.as_tuple())[0])
        return (
            HandedOver("contact")
            if is_touching
            else _give_up(Planned(setting, mission.measure, navigator, info, began_s), unreachable)
        )
    if navigator.path is None:
        return HandedOver("a plan that takes long")
    if limit_s / navigator.dt > _MOST_PERIODS or navigator.path.length > _LONGEST_M:
        return HandedOver("a long drive")
    return planned


def _conclude(planned: Planned, drive: BatchDrive, monitor_stops: int | None) -> Episode:
    """Return the episode of a drive."""
    info, rows, time = planned.info, drive.rows, drive.time
    log = RunLog.of(_trajectory(time, rows), (planned.route[0],))
    log.monitor_stops = monitor_stops
    totals = AgentTotals()
    totals.standing_reasons.update(drive.reasons)
    state = replace(standing_at(Pose2D(*rows[-1, :3].tolist()))[0], time=float(time[-1]))
    is_there = drive.ending == ARRIVED
    ending = endings.at_goal(state, None) if is_there else endings.timed_out(info.goals, info.time_limit_s)
    return _make_episode(planned, log, totals, ending)


def _give_up(planned: Planned, error: PlanningError) -> Episode:
    """Return the episode of a mission without a path."""
    state, estimate = standing_at(planned.info.start)
    log = RunLog()
    log.add(state, Twist2D(), estimate, 0, None)
    return _make_episode(planned, log, AgentTotals(), (Outcome.NO_PATH, str(error)), complete=error.complete)


def _make_episode(
    planned: Planned, log: RunLog, totals: AgentTotals, ending: Ending, *, complete: bool | None = None
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
        measure=planned.measure,
        complete=complete,
    )


def _trajectory(time: FloatArray, rows: FloatArray) -> Trajectory:
    x, y, yaw, v, w, commanded_v, commanded_w = rows.T
    none = np.zeros(len(time), dtype=np.int64)
    return Trajectory(time, x, y, yaw, v, w, commanded_v, commanded_w, x, y, yaw, goal=none, path=none)


def numbers_of(navigator: Navigator) -> tuple[FloatArray, ...]:
    """Return the numbers that the kernel takes of a costmap's inflation, the robot, and a navigator's settings.

    Raises:
        InputError: If the control period is no multiple of the simulator's substep.
    """
    costmap, robot, controller = navigator.costmap, navigator.robot, navigator.controller
    # Others decide on their own; the kernel then moves and judges alone.
    settings = controller.settings if isinstance(controller, RegulatedPurePursuit) else PursuitSettings()
    limits, drive = robot.limits, robot.drive
    goal, progress = navigator.goal_checker, navigator.progress_checker
    return (
        np.array([costmap.inscribed_radius, costmap.cost_scaling_factor, costmap.inflation_radius]),
        np.ascontiguousarray(robot.planar.outline),
        np.ascontiguousarray(robot.planar.padded(settings.footprint_padding).outline),
        np.array(
            [
                limits.linear_speed,
                limits.linear_speed if limits.reverse_speed is None else limits.reverse_speed,
                limits.angular_speed,
                limits.linear_acceleration,
                limits.angular_acceleration,
                drive.wheel_radius,
                drive.track_width,
                math.inf if drive.max_wheel_speed is None else drive.max_wheel_speed,
                TIMESTEP,
                count_steps(navigator.dt, TIMESTEP),
                navigator.dt,
            ]
        ),
        np.array(
            [
                math.inf if settings.desired_linear_vel is None else settings.desired_linear_vel,
                settings.lookahead_dist,
                settings.min_lookahead_dist,
                settings.rotate_to_heading_min_angle,
                settings.rotate_to_heading_angular_vel,
                settings.regulated_linear_scaling_min_radius,
                settings.regulated_linear_scaling_min_speed,
                settings.cost_scaling_dist,
                settings.approach_velocity_scaling_dist,
                settings.min_approach_linear_velocity,
                settings.approach_deceleration,
                settings.acceleration_of(robot),
                settings.footprint_padding,
            ]
        ),
        np.array([goal.xy_tolerance, goal.yaw_tolerance, goal.stopped_linear, goal.stopped_angular]),
        np.array(
            [
                progress.required_movement_radius,
                progress.required_movement_angle,
                progress.movement_time_allowance,
            ]
        ),
    )
