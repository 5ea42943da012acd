"""What a run leaves: its outcome, its metrics and its trajectory."""

from __future__ import annotations

import io
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from enum import StrEnum
from typing import TypeAlias, cast

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.files.npz import read_arrays
from trundle.files.writing import write_bytes
from trundle.geometry import FloatArray, Pose2D
from trundle.path import Path
from trundle.values import as_array

Goal: TypeAlias = tuple[float, float] | tuple[float, float, float]
"""(x, y) [m], to be reached with any yaw, or (x, y, yaw) [m, m, rad]; map frame."""


class Outcome(StrEnum):
    """How a run ended."""

    ARRIVED = "arrived"
    """The robot stands at the last goal and touched nothing on the way."""
    COLLIDED = "collided"
    """It touched something that is not the floor."""
    STUCK = "stuck"
    """It did not get on for too long."""
    TIMED_OUT = "timed_out"
    """The time limit was over first."""
    NO_PATH = "no_path"
    """No path from where it was to the goal was found."""
    PLANNING_TIMED_OUT = "planning_timed_out"
    """Planning was not done by its deadline, three times in a row; whether there is a path is not known."""
    ABORTED = "aborted"
    """Stopped from outside (Ctrl-C), or the physics broke down."""


@dataclass(frozen=True, slots=True)
class Metrics:
    """The figures of one run.

    Attributes:
        time_s: Simulated time [s].
        distance_m: Driven by base_link [m].
        path_length_m: Planned [m]: the first plan to each goal, summed; plans made on the way do not count.
        spl: Success weighted by path length, 0..1: success · l / max(distance, l) with l = `shortest_path_m` (Anderson
            et al., "On Evaluation of Embodied Navigation Agents", 2018). 0 unless arrived.
        min_clearance_m: Smallest distance [m] from the oriented footprint, at all poses of the trajectory, to a solid
            of the world that reaches between the robot's ground clearance and its height, whether its map has it or
            not; 0 where there was a contact, and `CLEARANCE_CAP` stands for that or more.
        mean_cross_track_error_m: Mean distance [m] from base_link to the path that was followed; none without a path.
        max_cross_track_error_m: Largest such distance [m]; none without a path.
        smoothness_rad_per_m: Turning per distance [rad/m]: the sum of all changes in yaw, as positive numbers, over
            `distance_m`; lower is smoother. "Angle over length" of Heiden et al., "Bench-MR" (RA-L 2021), with the
            yaw of the driven robot. None if it drove less than 0.01 m.
        planning_ms: Wall time spent on planning, all goals and replans [ms].
        replans: How often it planned again, beyond the first plan to each goal.
        real_time_factor: Simulated time over the wall time of the loop.
        contacts: Names of what it touched, in order of first touch.
        shortest_path_m: Length [m] of the shortest path of the footprint's inscribed disc through the goals in turn, in
            any direction, in the world's true map (cells of the costmap's resolution, every cell that a solid reaches
            into is blocked, except where the robot drove). None unless arrived.
        measured_on: "world" where `min_clearance_m` and `shortest_path_m` are measured on the world's solids; "map"
            where the simulator does not know them, as in an environment of Isaac Sim or on a real robot: on the
            robot's first costmap then, where unknown cells count as solid.
    """

    time_s: float
    distance_m: float
    path_length_m: float
    spl: float
    min_clearance_m: float
    mean_cross_track_error_m: float | None
    max_cross_track_error_m: float | None
    smoothness_rad_per_m: float | None
    planning_ms: float
    replans: int
    real_time_factor: float
    contacts: tuple[str, ...] = ()
    shortest_path_m: float | None = None
    measured_on: str = "map"


_WHOLE = ("goal", "path")


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """A run, one row per control period, in arrays of shape (N,) that are read-only.

    The first row is the start, at rest. The command of a row is what was commanded during the period that ends there.

    Attributes:
        time: Simulated time [s].
        x, y, yaw: True pose of base_link, map frame [m, m, rad].
        v, w: True twist in base_link [m/s, rad/s].
        commanded_v, commanded_w: The command, before the robot's limits [m/s, rad/s].
        odometry_x, odometry_y, odometry_yaw: Pose that the wheels tell, in a frame that starts at the start.
        goal: Index of the goal that it was driving to; int64.
        path: Index in `Episode.paths` of the path that it was following, −1 for none; int64.

    Raises:
        InputError: If the arrays are not one-dimensional, of one length above 0, and finite.
    """

    time: FloatArray
    x: FloatArray
    y: FloatArray
    yaw: FloatArray
    v: FloatArray
    w: FloatArray
    commanded_v: FloatArray
    commanded_w: FloatArray
    odometry_x: FloatArray
    odometry_y: FloatArray
    odometry_yaw: FloatArray
    goal: npt.NDArray[np.int64]
    path: npt.NDArray[np.int64]

    def __post_init__(self) -> None:
        for name in self.columns():
            kind = np.int64 if name in _WHOLE else np.float64
            array = as_array(getattr(self, name), kind, f"{name} of a trajectory")
            if array.ndim != 1 or len(array) == 0 or not np.isfinite(array).all():
                raise InputError(f"a trajectory needs finite numbers of shape (N,) with N ≥ 1; {name} is not that")
            array.flags.writeable = False
            object.__setattr__(self, name, array)
        if len({len(getattr(self, name)) for name in self.columns()}) != 1:
            raise InputError("a trajectory needs all its arrays to be of one length")

    @classmethod
    def columns(cls) -> tuple[str, ...]:
        """Names of the arrays."""
        return tuple(column.name for column in fields(cls))

    def __len__(self) -> int:
        return len(self.time)

    @property
    def poses(self) -> FloatArray:
        """(x, y, yaw), shape (N, 3)."""
        return np.column_stack([self.x, self.y, self.yaw])

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write an .npz of these arrays.

        Raises:
            OutputError: If it cannot be written; nothing is left behind.
        """
        content = io.BytesIO()
        np.savez_compressed(content, **{name: getattr(self, name) for name in self.columns()})
        write_bytes(path, content.getvalue(), durable=True)

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Trajectory:
        """Read what `save` wrote.

        Raises:
            InputError: If the file cannot be read, or is not a trajectory.
        """
        arrays, _ = read_arrays(path, cls.columns(), error=InputError)
        missing = [name for name in cls.columns() if name not in arrays]
        if missing:
            raise InputError(f"{os.fspath(path)}: not a trajectory: it has no {', '.join(missing)}")
        try:
            return cls(**arrays)
        except InputError as error:
            raise InputError(f"{os.fspath(path)}: {error}") from error
        except (TypeError, ValueError, OverflowError) as error:
            raise InputError(f"{os.fspath(path)}: its arrays are no numbers: {error}") from error


@dataclass(frozen=True, slots=True, eq=False)
class Episode:
    """One run from start to end.

    Attributes:
        outcome: How it ended.
        message: The outcome in words, with what was touched or what is in the way.
        metrics: Its figures.
        trajectory: Where it was and what was commanded.
        paths: Every path that was followed, in order.
        start: Where it started, map frame.
        goals: Where it was to go, in order.
        goals_reached: How many of them it reached.
        name: Name of the run.
        robot: Name of the robot.
        planner: Name of the planner.
        controller: Name of the controller.
        seed: Of the simulator.
        time_limit_s: When it would have been stopped [s].
        observer_errors: What observers raised; they were dropped, and the run went on.
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

    @property
    def arrived(self) -> bool:
        """Whether it reached the last goal without touching anything."""
        return self.outcome is Outcome.ARRIVED

    def as_dict(self) -> Mapping[str, object]:
        """Outcome, metrics and settings as plain values, for JSON."""
        return {
            "outcome": self.outcome.value,
            "message": self.message,
            **{name: _plain(value) for name, value in asdict(self.metrics).items()},
            "name": self.name,
            "robot": self.robot,
            "planner": self.planner,
            "controller": self.controller,
            "start": list(self.start.as_tuple()),
            "goals": [list(goal) for goal in self.goals],
            "goals_reached": self.goals_reached,
            "seed": self.seed,
            "time_limit_s": self.time_limit_s,
        }


def _plain(value: object) -> object:
    if isinstance(value, tuple):
        return list(cast("tuple[object, ...]", value))
    return value
