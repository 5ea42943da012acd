"""`read_run`: the run in a bag, of trundle or of any robot, for run folders, reports and metrics."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path as FilePath

import numpy as np

from trundle.bags.bag_content import BagContent, TopicNames, make_scan, read_content
from trundle.bags.bag_reader import BagReader
from trundle.bags.bag_rows import Beliefs, Rows, make_rows
from trundle.bags.run_record import RunFacts, RunRecord, read_record
from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.geometry import FloatArray, Goal, Pose2D, Twist2D, wrap_angles
from trundle.maps import OccupancyGrid
from trundle.messages.codec import DEFAULT, Distro
from trundle.mission import Episode, Observer, Outcome, RunInfo, Scenario, Step
from trundle.mission.metrics import compute_metrics, measure_truth
from trundle.mission.trajectory import Trajectory
from trundle.navigation import NavigationStatus
from trundle.observation import Observation, Scan
from trundle.path import Path
from trundle.robots import Robot, WheelSpeeds
from trundle.sim import RobotState

NEAR_GOAL_M = 0.25
"""A robot whose recording ends so near to the last goal has arrived: Nav2's xy_goal_tolerance."""

_SAME = 1e-6
"""Poses that differ by less [m, rad] are the same: they were written as transforms, and read again."""


@dataclass(frozen=True, slots=True, eq=False)
class RunFromBag:
    """The run in a bag.

    Attributes:
        info: What observers get before the first step.
        steps: What they get of every row.
        episode: What they get at the end.
        grid: The map.
        scenario: The scenario that repeats the run; None if the bag is not trundle's own.
        topics: Names of the topics that were read.
        remarks: What was left out, or taken to be so, and why.
    """

    info: RunInfo
    steps: tuple[Step, ...]
    episode: Episode
    grid: OccupancyGrid
    scenario: Scenario | None
    topics: tuple[str, ...]
    remarks: tuple[str, ...]

    def play(self, observers: Sequence[Observer]) -> None:
        """Notify observers of the run, as a session does."""
        for observer in observers:
            observer.on_start(self.info)
        for step in self.steps:
            for observer in observers:
                observer.on_step(step)
        for observer in observers:
            observer.on_end(self.episode)


def read_run(
    path: str | os.PathLike[str],
    *,
    robot: Robot | str | None = None,
    names: TopicNames | None = None,
    distro: Distro = DEFAULT,
) -> RunFromBag:
    """Read the run in a bag: where the robot was by its transforms, on which map, and what it planned.

    Args:
        path: A .mcap or .db3 file, or the folder of a rosbag2.
        robot: The robot that was driven, whose footprint counts for clearances. By default, it is the recording's own,
            or nova_carter.
        names: Names of topics where the usual ones, and their types, do not tell.
        distro: The distribution of which message types are where the bag has no definitions of them: .db3 files.

    Raises:
        InputError: If it is not a bag, it is damaged, or it has no map or transforms.
        MissingExtraError: If rosbags is not installed.
    """
    source = FilePath(path)
    with BagReader(source, distro=distro) as bag:
        content = read_content(bag, names or TopicNames())
        record = read_record(source)
    remarks: list[str] = []
    if robot is None:
        machine = record.robot if record is not None else Robot.load("nova_carter")
        if record is None:
            remarks.append("clearances are those of nova_carter; give the robot with --robot")
    else:
        machine = Robot.load(robot) if isinstance(robot, str) else robot
    rows = make_rows(content, source)
    return _Maker(source, content, rows, machine, record, remarks).make()


class _Maker:
    """Makes the run of a bag's content."""

    def __init__(
        self,
        source: FilePath,
        content: BagContent,
        rows: Rows,
        robot: Robot,
        record: RunRecord | None,
        remarks: list[str],
    ) -> None:
        if content.grid is None:
            raise InputError(f"{source}: the bag's map topic has no message; give the YAML file of its map with --map")
        self._source, self._content, self._rows = source, content, rows
        self._robot, self._record, self._remarks = robot, record, remarks
        self._grid = content.grid
        self._costmap = Costmap.from_grid(content.grid, robot)
        self._beliefs = Beliefs(content, rows)
        self._paths = self._make_paths()
        self._goals, self._goal_times = self._find_goals()

    def make(self) -> RunFromBag:
        """Return everything of it."""
        info = self._make_info()
        trajectory = self._make_trajectory()
        episode = self._make_episode(info, trajectory)
        record = self._record
        steps = tuple(self._steps(trajectory))
        scenario = None if record is None else record.scenario
        topics = self._content.topics
        return RunFromBag(info, steps, episode, self._grid, scenario, topics, tuple(self._remarks))

    def _make_info(self) -> RunInfo:
        rows, record = self._rows, self._record
        planned = [path.length for _, path in self._paths][: len(self._goals)]
        facts = RunFacts(
            name=self._source.stem,
            planner="recorded" if self._paths else "none",
            controller="recorded",
            seed=0,
            start=_as_pose(rows.truths[0]).as_tuple(),
            goals=(),
            dt=rows.period,
            time_limit_s=None,
            path_length_m=sum(planned),
            localizer="recorded" if self._beliefs.has_localizer else "none",
        )
        if record is not None:
            facts = record.run
        return RunInfo(
            name=facts.name,
            robot=self._robot,
            costmap=self._costmap,
            start=Pose2D.of(facts.start),
            goals=self._goals,
            path_length_m=facts.path_length_m,
            time_limit_s=math.inf if facts.time_limit_s is None else facts.time_limit_s,
            dt=facts.dt,
            planner=facts.planner,
            controller=facts.controller,
            seed=facts.seed,
            grid=self._grid,
            localizer=facts.localizer,
        )

    def _make_paths(self) -> list[tuple[float, Path]]:
        """Return the plans in the map frame, with their times."""
        made: list[tuple[float, Path]] = []
        for time, frame, poses in self._content.paths:
            placed = self._rows.place(poses, frame, time)
            if placed is None:
                self._remark(f"plans in the frame {frame!r}, which no transform ties to the map, are left out")
            elif np.isfinite(placed).all():
                made.append((time - self._rows.began, Path(placed, planner="recorded")))
        return made

    def _find_goals(self) -> tuple[tuple[Goal, ...], list[float]]:
        """Return the goals with the times from which they hold: as recorded, as sent, or the ends of the plans."""
        sent = [
            (time - self._rows.began, placed[0])
            for time, frame, pose in self._content.goals
            if (placed := self._rows.place(np.array([pose.as_tuple()]), frame, time)) is not None
        ]
        if self._record is not None:
            return tuple(Goal.of(goal) for goal in self._record.run.goals), [time for time, _ in sent]
        if not sent:
            for time, path in self._paths:
                end = path.poses[-1]
                if not sent or math.dist(end[:2], sent[-1][1][:2]) > NEAR_GOAL_M:
                    sent.append((time, end))
        return tuple(Goal.of(_as_pose(pose)) for _, pose in sent), [time for time, _ in sent]

    def _make_trajectory(self) -> Trajectory:
        rows = self._rows
        path_times = np.array([time for time, _ in self._paths])
        goal_times = np.array(self._goal_times)
        following = np.searchsorted(path_times, rows.times + 1e-6, side="right") - 1
        goal = np.clip(np.searchsorted(goal_times, rows.times + 1e-6, side="right") - 1, 0, None)
        columns: dict[str, FloatArray] = {}
        for prefix, names, table in (
            ("", ("x", "y", "yaw"), rows.truths),
            ("", ("v", "w"), rows.twists),
            ("commanded_", ("v", "w"), rows.sent),
            ("odometry_", ("x", "y", "yaw"), rows.odometry),
            ("estimate_", ("x", "y", "yaw"), rows.estimates),
        ):
            columns |= {f"{prefix}{name}": column for name, column in zip(names, table.T, strict=True)}
        return Trajectory(
            time=rows.times,
            goal=goal.astype(np.int64),
            path=following.astype(np.int64),
            localization=self._beliefs.states,
            **columns,
        )

    def _make_episode(self, info: RunInfo, trajectory: Trajectory) -> Episode:
        paths = tuple(path for _, path in self._paths)
        record = self._record
        if record is not None and record.episode is not None:
            return Episode.from_record(record.episode, trajectory, paths, self._source)
        outcome, message, reached = self._judge(trajectory)
        arrived = outcome is Outcome.ARRIVED
        ends = (info.start.as_tuple(), *self._goals)
        truth = measure_truth(trajectory.poses, ends, self._robot, None, self._costmap, arrived=arrived, touched=False)
        metrics = compute_metrics(
            trajectory,
            paths,
            self._costmap,
            arrived=arrived,
            path_length_m=info.path_length_m,
            planning_s=0.0,
            replans=max(0, len(paths) - max(1, len(self._goals))),
            wall_s=float(trajectory.time[-1]),
            contacts=(),
            truth=truth,
        )
        return Episode(
            outcome=outcome,
            message=message,
            metrics=metrics,
            trajectory=trajectory,
            paths=paths,
            start=info.start,
            goals=info.goals,
            goals_reached=reached,
            name=info.name,
            robot=self._robot.name,
            planner=info.planner,
            controller=info.controller,
            seed=info.seed,
            time_limit_s=info.time_limit_s,
            costmap=self._costmap,
        )

    def _judge(self, trajectory: Trajectory) -> tuple[Outcome, str, int]:
        """Judge how a run ended that has no record of its end, by where the robot was at the end of the recording."""
        seconds = float(trajectory.time[-1])
        if not self._goals:
            return Outcome.FINISHED, f"the recording ends after {seconds:.1f} s; it has no goal", 0
        gap = math.dist(trajectory.poses[-1, :2], self._goals[-1][:2])
        if gap <= NEAR_GOAL_M and self._record is None:
            return Outcome.ARRIVED, f"the recording ends {gap:.2f} m from the last goal", len(self._goals)
        reached = int(trajectory.goal[-1])
        return Outcome.ABORTED, f"the recording ends after {seconds:.1f} s, {gap:.2f} m before the last goal", reached

    def _steps(self, trajectory: Trajectory) -> Iterator[Step]:
        rows, paths = self._rows, [path for _, path in self._paths]
        scans, movers = self._scans_by_row(), self._movers_by_row()
        turned = np.zeros(2)
        previous = 0.0
        goals = len(self._goals)
        # Without a localizer both poses are the same: then nothing is drawn of what it believes.
        believes = self._beliefs.has_localizer or np.abs(rows.estimates - rows.truths).max() > _SAME
        for index, time in enumerate(rows.times.tolist()):
            twist = Twist2D(*rows.twists[index].tolist())
            speeds = self._robot.wheel_speeds(twist)
            turned += (time - previous) * np.array(speeds)
            previous = time
            odometry, truth = _as_pose(rows.odometry[index]), _as_pose(rows.truths[index])
            estimate = _as_pose(rows.estimates[index]) if believes else truth
            seen = scans.get(index, ())
            state = RobotState(
                time, truth, twist, WheelSpeeds(*turned.tolist()), speeds, odometry, (), seen, None, movers[index]
            )
            path = int(trajectory.path[index])
            arrived = index == len(rows.times) - 1 and goals > 0
            yield Step(
                index,
                state,
                Twist2D(*rows.commands[index].tolist()),
                min(int(trajectory.goal[index]), max(0, goals - 1)),
                paths[path] if path >= 0 else None,
                NavigationStatus.IDLE if arrived else NavigationStatus.DRIVING,
                Twist2D(*rows.sent[index].tolist()),
                Observation(time, twist, odometry, seen),
                self._beliefs.at(index, time, estimate, odometry),
                self._costmap,
            )

    def _scans_by_row(self) -> dict[int, tuple[Scan, ...]]:
        """Return the scans that arrived since the row before."""
        rows, found = self._rows, dict[int, list[Scan]]()
        mounts: dict[str, FloatArray | None] = {}
        for topic, message in self._content.scans:
            frame = message.header.frame_id.lstrip("/")
            if frame not in mounts:
                mounts[frame] = self._content.tree.static(frame, rows.base)
                if mounts[frame] is None:
                    self._remark(f"scans of {topic} are left out: no transform says where {frame!r} is on the robot")
            mount = mounts[frame]
            if mount is None or not len(message.ranges):
                continue
            try:
                scan = make_scan(message, frame, mount)
            except InputError as error:
                self._remark(f"scans of {topic} are left out: {error}")
                mounts[frame] = None
                continue
            row = int(np.searchsorted(rows.times, scan.time - rows.began - 1e-6))
            if 0 < row < len(rows.times) or (row == 0 and scan.time >= rows.began - 1e-6):
                found.setdefault(row, []).append(rows.shift(scan))
        return {row: tuple(scans) for row, scans in found.items()}

    def _movers_by_row(self) -> list[tuple]:
        """Return the movers at each row: the last that were recorded."""
        known = self._content.movers
        times = np.array([time for time, _ in known]) - self._rows.began
        last = np.searchsorted(times, self._rows.times + 1e-6, side="right") - 1
        return [known[index][1] if index >= 0 else () for index in last.tolist()]

    def _remark(self, text: str) -> None:
        if text not in self._remarks:
            self._remarks.append(text)


def _as_pose(row: FloatArray) -> Pose2D:
    x, y, yaw = row.tolist()
    return Pose2D(x, y, float(wrap_angles(np.array([yaw]))[0]))
