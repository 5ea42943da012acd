"""Drives of planned missions: by a kernel at once, or period by period where something else has a say."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from trundle._core import MissionDriver, MissionRun
from trundle.errors import InputError, NoValidControlError
from trundle.geometry import FloatArray, Pose2D, Twist2D
from trundle.mission.batch.sensing import BatchDrive, MissionSensing
from trundle.mission.metrics import Measure
from trundle.mission.observers import RunInfo
from trundle.mission.scenario import Setting
from trundle.navigation import Navigator
from trundle.navigation.obstacle_watch import STANDING_WITHIN
from trundle.path import Path
from trundle.planning import PathCheck
from trundle.sim.kinematic import TIMESTEP
from trundle.sim.ramp import count_steps

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
        """The next one."""
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
