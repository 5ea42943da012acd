"""`Episode`: one run from start to end, with its outcome and its metrics."""

from __future__ import annotations

import math
import os
import pathlib
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from enum import StrEnum
from typing import cast

from trundle.costmap import Costmap
from trundle.errors import InputError
from trundle.fault import Fault
from trundle.files.opening import is_file
from trundle.geometry import Goal, Pose2D
from trundle.mission.own_map import OwnMap
from trundle.mission.run_files import DIRECTIVES_FILE, RECORD, check_record, load_directives, load_paths, read_record
from trundle.mission.steering.directives import GivenDirective
from trundle.mission.trajectory import Trajectory
from trundle.navigation.behaviors import BehaviorRun
from trundle.path import Path
from trundle.values import as_path

"""(x, y) [m], to be reached with any yaw, or (x, y, yaw) [m, m, rad]; map frame."""


class Outcome(StrEnum):
    """How a run ended."""

    ARRIVED = "arrived"
    """The robot stands at the last goal and touched nothing."""
    ARRIVED_BY_ESTIMATE = "arrived_by_estimate"
    """The robot stands at the last goal by its localizer's estimate, and touched nothing; in truth it is, or was at an
    earlier goal, elsewhere: see `Metrics.position_error_m`."""
    FINISHED = "finished"
    """An agent without a goal, such as a script of commands, was done, and the robot touched nothing."""
    COLLIDED = "collided"
    """It touched something that is not the floor."""
    STUCK = "stuck"
    """It made no progress within the time allowance."""
    TIMED_OUT = "timed_out"
    """The time limit was over first."""
    NO_PATH = "no_path"
    """No path from where it was to the goal was found."""
    PLANNING_TIMED_OUT = "planning_timed_out"
    """Planning was not done by its deadline, three times in a row; whether there is a path is not known."""
    ABORTED = "aborted"
    """Stopped from outside (Ctrl-C), or the physics broke down."""
    ERROR = "error"
    """An exception ended it, of a plug-in or of trundle itself: see `Episode.fault`."""


@dataclass(frozen=True, slots=True)
class Metrics:
    """The figures of one run.

    Attributes:
        time_s: Simulated time [s].
        distance_m: Driven by base_link [m].
        path_length_m: Planned [m]: the first plan to each goal, summed; replans do not count.
        spl: Success weighted by path length, 0..1: success · l / max(distance, l) with l = `shortest_path_m` (Anderson
            et al., "On Evaluation of Embodied Navigation Agents", 2018). 0 unless arrived.
        min_clearance_m: Smallest distance [m] from the oriented footprint, at all poses of the trajectory, to a solid
            of the world that reaches between the robot's ground clearance and its height, whether its map has it or
            not; 0 where there was a contact, and `CLEARANCE_CAP` stands for that or more. None where nothing is known
            to measure it on. Moving obstacles do not count.
        mean_cross_track_error_m: Mean distance [m] from base_link to the path that was followed; none without a path.
        max_cross_track_error_m: Largest such distance [m]; none without a path.
        smoothness_rad_per_m: Turning per distance [rad/m]: the sum of all changes in yaw, as positive numbers, over
            `distance_m`; lower is smoother. "Angle over length" of Heiden et al., "Bench-MR" (RA-L 2021), with the
            yaw of the driven robot. None if it drove less than 0.01 m.
        planning_ms: Wall time of all planning, replans included [ms].
        replans: Plans beyond the first to each goal.
        real_time_factor: Simulated time over the wall time of the loop.
        contacts: Names of what it touched, in order of first touch; without `standing_contacts`.
        shortest_path_m: Length [m] of the shortest path of the footprint's inscribed disc through the goals in turn, in
            any direction, in the world's true map (cells of the costmap's resolution, every cell that a solid reaches
            into is blocked, except where the robot drove). None unless arrived.
        measured_on: "world" where `min_clearance_m` and `shortest_path_m` are measured on the world's solids; "map"
            where the simulator does not know them, as in an environment of Isaac Sim or on a real robot: on the
            robot's first costmap then, where unknown cells count as solid; "nothing" where the agent has no costmap
            either, or nothing was measured.
        standing_contacts: Names of moving obstacles that ran into the robot while it stood: its true speeds were below
            0.05 m/s and 0.05 rad/s when the touch began; and of what they pushed it against while it stood so, or while
            its commands were to stand, until it has moved on by 0.05 m. A robot is pushed until it does what it is told
            again, and 0.5 s at least; while it stands and is told to, 3 s. They do not end a run.
        unseen_contacts: Those of `contacts` and `standing_contacts` that no lidar could have seen, as the plane of none
            that sent a scan crosses them; empty without scans.
        position_error_m: Distance [m] from the true position to the estimated one at the end; 0 without a localizer.
        localization_error_m: The same, mean of all control periods; 0 without a localizer.
        localization_error_p95_m: The same, which 95 % of the control periods do not exceed.
        lost_s: Simulated time [s] in which the localizer did not say "localized", but "ambiguous" or "lost".
        monitor_stops: How often the collision monitor stopped the robot; None where there was no monitor.
        recoveries: Number of steps of recovery that ran; None where a folder of an older version was loaded.
        standing_reasons: In how many control periods the controller made no progress, by its reason, such as "blocked
            by a mover", the most frequent one first; empty for an agent that gives no reasons, and in the folder of an
            older version.
    """

    time_s: float
    distance_m: float
    path_length_m: float
    spl: float
    min_clearance_m: float | None
    mean_cross_track_error_m: float | None
    max_cross_track_error_m: float | None
    smoothness_rad_per_m: float | None
    planning_ms: float
    replans: int
    real_time_factor: float
    contacts: tuple[str, ...] = ()
    shortest_path_m: float | None = None
    measured_on: str = "map"
    standing_contacts: tuple[str, ...] = ()
    unseen_contacts: tuple[str, ...] = ()
    position_error_m: float = 0.0
    localization_error_m: float = 0.0
    localization_error_p95_m: float = 0.0
    lost_s: float = 0.0
    monitor_stops: int | None = None
    recoveries: int | None = None
    standing_reasons: Mapping[str, int] = field(default_factory=dict[str, int])


@dataclass(frozen=True, slots=True, eq=False)
class Episode:
    """One run from start to end.

    Attributes:
        outcome: How it ended.
        message: The outcome in words, with what was touched or what blocks the path.
        metrics: Its figures.
        trajectory: Where it was and what was commanded.
        paths: Every path that was followed, in order.
        start: The start pose, map frame.
        goals: The goals, in order; none where the agent had none.
        goals_reached: The number of goals reached.
        name: Name of the run.
        robot: Name of the robot.
        planner: Name of the planner, "none" where the agent has no planner.
        controller: Name of the controller, or of the agent.
        seed: Seed of the simulator.
        time_limit_s: Simulated time at which the run would have been stopped [s], or infinity.
        observer_errors: What observers raised; they were dropped, and the run continued. They are not recorded.
        costmap: What the robot planned on at the start, for the notebook's picture; None where it was loaded.
        behaviors: The behaviors that ran, in order, each with its time, its reason and its result: steps of recovery,
            tasks of waypoints, and what was asked for; empty where a folder of an older version was loaded.
        directives: What was asked of it by `Steering`, in order, each with its time; empty where nothing was. They are
            recorded in `directives.json`.
        folder: The run's folder, where the episode was loaded from one; `Scenario.load(folder)` repeats the run.
        fault: The exception that ended it, with the plug-in that raised it; None unless the outcome is `error`.
        complete: Where the outcome is `no_path`, whether the search was complete: the costmap that the robot had has no
            path. Otherwise the search ended before it found one. None for other outcomes, and in older folders. In
            `episode.json` it is `search_complete`: `complete` says there that the run has ended.
        own_map: The map that the robot's localizer has made, with its pose graph; None where it makes none, and where
            the episode was loaded from a folder, which has the map as `own_map.yaml`.
    """

    outcome: Outcome
    message: str
    metrics: Metrics
    trajectory: Trajectory
    paths: tuple[Path, ...]
    start: Pose2D
    goals: tuple[Goal, ...]
    goals_reached: int
    name: str
    robot: str
    planner: str
    controller: str
    seed: int
    time_limit_s: float
    observer_errors: tuple[BaseException, ...] = ()
    costmap: Costmap | None = None
    behaviors: tuple[BehaviorRun, ...] = ()
    directives: tuple[GivenDirective, ...] = ()
    folder: pathlib.Path | None = None
    fault: Fault | None = None
    complete: bool | None = None
    own_map: OwnMap | None = None

    @classmethod
    def load(cls, folder: str | os.PathLike[str]) -> Episode:
        """Read the episode that `trundle run` or a `RunFolder` wrote.

        Raises:
            InputError: If the folder does not hold a run that has ended, or one of its files is missing or damaged;
                the message names the file.
        """
        place = pathlib.Path(as_path(folder, "the folder of a run"))
        values = read_record(place)
        trajectory = Trajectory.load(place / "trajectory.npz")
        paths = load_paths(place / "paths.npz")
        if int(trajectory.path.max()) >= len(paths):
            raise InputError(f"{place}: trajectory.npz follows more paths than paths.npz has; they are of two runs")
        directives = load_directives(place / DIRECTIVES_FILE) if is_file(place / DIRECTIVES_FILE) else ()
        episode = cls.from_record(values, trajectory, paths, place / RECORD)
        return replace(episode, directives=directives, folder=place)

    @classmethod
    def from_record(
        cls, values: Mapping[str, object], trajectory: Trajectory, paths: tuple[Path, ...], source: pathlib.Path
    ) -> Episode:
        """Make the episode whose `as_dict` gave these values.

        Args:
            values: Outcome, metrics and settings.
            trajectory: Where it was and what was commanded.
            paths: Every path that was followed.
            source: Where the values are from, for messages.

        Raises:
            InputError: If a value is missing or of another type; all are named.
        """
        facts = check_record(values, _Facts, source)
        metrics = check_record(values, Metrics, source)
        return cls(
            outcome=facts.outcome,
            message=facts.message,
            metrics=metrics,
            trajectory=trajectory,
            paths=paths,
            start=Pose2D.of(facts.start),
            goals=tuple(Goal.of(goal) for goal in facts.goals),
            goals_reached=facts.goals_reached,
            name=facts.name,
            robot=facts.robot,
            planner=facts.planner,
            controller=facts.controller,
            seed=facts.seed,
            time_limit_s=math.inf if facts.time_limit_s is None else facts.time_limit_s,
            behaviors=facts.behaviors,
            fault=facts.fault,
            complete=facts.search_complete,
        )

    def __repr__(self) -> str:
        driven = f"{self.metrics.time_s:.1f} s, {self.metrics.distance_m:.2f} m"
        return f"Episode({self.name!r}, {self.outcome.value}, {driven}, {self.robot}, {self.planner})"

    def _repr_png_(self) -> bytes:
        """Show a picture in notebooks: the overlay of the run's folder, or paths and drive on the costmap."""
        from trundle.mission.picture import draw_drive, read_overlay
        from trundle.pictures.figure import to_png

        overlay = None if self.folder is None else read_overlay(self.folder)
        if overlay is not None:
            return to_png(overlay)
        lines = [
            self.message,
            f"{self.metrics.time_s:.1f} s, {self.metrics.distance_m:.2f} m driven, SPL {self.metrics.spl:.2f}",
        ]
        title = f"{self.name}: {self.outcome.value.replace('_', ' ')}"
        return to_png(draw_drive(self.trajectory, self.paths, self.start, self.goals, title, lines, self.costmap))

    @property
    def arrived(self) -> bool:
        """Whether it reached the last goal without touching anything."""
        return self.outcome is Outcome.ARRIVED

    def as_dict(self) -> Mapping[str, object]:
        """Outcome, metrics and settings as plain values, for JSON."""
        return {
            "outcome": self.outcome.value,
            "message": self.message,
            "search_complete": self.complete,
            **{name: _plain(value) for name, value in asdict(self.metrics).items()},
            "name": self.name,
            "robot": self.robot,
            "planner": self.planner,
            "controller": self.controller,
            "start": list(self.start.as_tuple()),
            "goals": [list(goal) for goal in self.goals],
            "goals_reached": self.goals_reached,
            "seed": self.seed,
            "time_limit_s": self.time_limit_s if math.isfinite(self.time_limit_s) else None,
            "behaviors": [asdict(ran) for ran in self.behaviors],
            "fault": None if self.fault is None else asdict(self.fault),
        }


@dataclass(frozen=True, slots=True)
class _Facts:
    """What a record holds besides the metrics; see `Episode`."""

    outcome: Outcome
    message: str
    start: tuple[float, float, float]
    goals: tuple[tuple[float, float] | tuple[float, float, float], ...]
    goals_reached: int
    name: str
    robot: str
    planner: str
    controller: str
    seed: int
    time_limit_s: float | None
    behaviors: tuple[BehaviorRun, ...] = ()
    fault: Fault | None = None
    search_complete: bool | None = None


def _plain(value: object) -> object:
    if isinstance(value, tuple):
        return list(cast("tuple[object, ...]", value))
    return value
