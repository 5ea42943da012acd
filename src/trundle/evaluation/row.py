"""`Row`: what an evaluation keeps of one episode, its trail in few points among it."""

from __future__ import annotations

import heapq
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any, Self

import numpy as np

from trundle.geometry import FloatArray

MEASURED = ("planning_ms", "cpu_s", "wall_s")
"""Columns that depend on how fast the machine is; all others are the same whenever an episode is run again."""


NAVIGATOR = "navigator"
"""The agent of rows in which a planner and a controller drive."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One episode of an evaluation. Figures of an episode that did not end by itself (`crashed`, …) are None.

    Attributes:
        id: Hash of everything that decides the episode; 16 hexadecimal digits.
        mission: Hash of world, robot, start, goal and seed; episodes of one mission are compared with each other.
        index: Number of the episode in its suite.
        world: Label of the world.
        robot: Name of the robot.
        planner: Label of the planner: its name, with the options that the suite crosses.
        controller: Label of the controller, likewise.
        agent: Label of the agent, likewise; `navigator` where planner and controller drive.
        backend: Label of the simulator, likewise.
        seed: Seed of the mission.
        settings: Other settings that the suite crosses, as `name=value`, separated by spaces; empty without any.
        outcome: As `trundle.Outcome`, or `crashed`, `hung`, `out_of_memory` or `error`.
        message: The outcome in words.
        complete: Whether the search was complete where the outcome is `no_path`, as `Episode.complete`. None for other
            outcomes, and in older evaluations.
        error: What ended an episode that did not end by itself, with the place in the code; None for others.
        time_s: Simulated time [s].
        distance_m: Driven [m].
        spl: Success weighted by path length, 0..1, against the true shortest path; 0 unless arrived.
        min_clearance_m: Smallest distance to a solid [m]; see `Metrics`.
        contacts: Number of solids and moving obstacles touched, without `standing_contacts`.
        replans: Plans beyond the first.
        path_length_m: Length of the first plans [m].
        shortest_path_m: True shortest path [m]; None unless arrived.
        max_cross_track_error_m: Largest distance to the path that was followed [m].
        smoothness_rad_per_m: Turning per distance [rad/m].
        touched: Names of what was touched, separated by commas.
        start_x, start_y, start_yaw: Start [m, m, rad], map frame.
        goal_x, goal_y, goal_yaw: Last goal [m, m, rad]; `goal_yaw` is None for any yaw.
        end_x, end_y, end_yaw: Where the robot stopped [m, m, rad].
        closest_x, closest_y: Where its clearance was smallest [m].
        trail: Where it drove: x0, y0, x1, y1, … [m], up to 64 points, rounded to 1 cm.
        vary: What was varied, by name: the values drawn for this episode.
        place: Key of the world's map in the evaluation's folder; None where it was not built.
        standing_contacts: Number of moving obstacles that ran into the robot while it stood; None in older evaluations,
            as for the next two.
        unseen_contacts: Number of those touched that no lidar could see; see `Metrics`.
        position_error_m: Distance from the true position to the estimated one at the end [m].
        monitor_stops: How often the collision monitor stopped the robot; None without one.
        barn_score: Score of a run in BARN, 0 to 0.5; None in worlds without its reference path, as for the next two.
        reference_path_m: Length of BARN's reference path [m].
        shortest_time_s: Shortest time [s] on that path that the robot's limits allow from rest.
        recoveries: Number of steps of recovery that ran; None in older evaluations.
        behaviors: Names of the behaviors that ran, each with how often, separated by commas: `replan 2, back_up 1`.
        standing_periods: Number of control periods in which the controller made no progress; None in older evaluations.
        standing_reason: Why it made none most often: `blocked by a mover`.
        localization_error_m: Distance from the true position to the estimated one [m], mean of the run; None in older
            evaluations, as for the next two.
        localization_error_p95_m: The same, which 95 % of the run does not exceed.
        lost_s: Simulated time in which the localizer did not say that it is localized [s].
        handed_over: Why the backend `batch` has left it to the kinematic simulator; empty where it has not.
        planning_ms: Wall time of all planning [ms].
        cpu_s: CPU time of the episode in its worker [s].
        wall_s: Wall time of the episode in its worker [s].
    """

    id: str
    mission: str
    index: int
    world: str
    robot: str
    planner: str
    controller: str
    agent: str = NAVIGATOR
    backend: str
    seed: int
    settings: str = ""
    outcome: str
    message: str = ""
    complete: bool | None = None
    error: str | None = None
    time_s: float | None = None
    distance_m: float | None = None
    spl: float = 0.0
    min_clearance_m: float | None = None
    contacts: int | None = None
    replans: int | None = None
    path_length_m: float | None = None
    shortest_path_m: float | None = None
    max_cross_track_error_m: float | None = None
    smoothness_rad_per_m: float | None = None
    touched: str = ""
    start_x: float | None = None
    start_y: float | None = None
    start_yaw: float | None = None
    goal_x: float | None = None
    goal_y: float | None = None
    goal_yaw: float | None = None
    end_x: float | None = None
    end_y: float | None = None
    end_yaw: float | None = None
    closest_x: float | None = None
    closest_y: float | None = None
    trail: tuple[float, ...] = ()
    vary: Mapping[str, float] | None = None
    place: str | None = None
    standing_contacts: int | None = None
    unseen_contacts: int | None = None
    position_error_m: float | None = None
    monitor_stops: int | None = None
    barn_score: float | None = None
    reference_path_m: float | None = None
    shortest_time_s: float | None = None
    recoveries: int | None = None
    behaviors: str = ""
    standing_periods: int | None = None
    standing_reason: str = ""
    localization_error_m: float | None = None
    localization_error_p95_m: float | None = None
    lost_s: float | None = None
    handed_over: str = ""
    planning_ms: float | None = None
    cpu_s: float | None = None
    wall_s: float | None = None

    @classmethod
    def columns(cls) -> tuple[str, ...]:
        """Return the names of the columns, in order."""
        return tuple(field.name for field in fields(cls))

    def as_dict(self) -> dict[str, Any]:
        """Return the row as plain values, for JSON."""
        return {**asdict(self), "trail": list(self.trail), "vary": None if self.vary is None else dict(self.vary)}

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Self:
        """Make a row of what `as_dict` gave; columns that it does not know are left out."""
        known = {name: values[name] for name in cls.columns() if name in values}
        if not known.get("agent"):  # of an older evaluation, whose agents are told by having no planner
            known["agent"] = known["controller"] if known["planner"] == "none" else NAVIGATOR
        return cls(**{**known, "trail": tuple(known.get("trail") or ())})

    def unmeasured(self) -> dict[str, Any]:
        """Return all but the measured columns: equal whenever and wherever the episode is run with the same code."""
        return {name: value for name, value in self.as_dict().items() if name not in MEASURED}


MOST_POINTS = 64
_CLOSE_M = 0.01


def simplify(points: FloatArray, most: int = MOST_POINTS) -> tuple[float, ...]:
    """Keep few points of a line from which all others are near; those that are farthest off come first.

    Args:
        points: (x, y) [m], shape (N, 2), N ≥ 1.
        most: How many points to keep at most.

    Returns:
        x0, y0, x1, y1, … [m], rounded to 1 cm, with both ends.
    """
    last = len(points) - 1
    kept = {0, last}
    parts = [_farthest(points, 0, last)]
    while parts and len(kept) < most:
        gap, first, split, end = heapq.heappop(parts)
        if -gap <= _CLOSE_M:
            break
        kept.add(split)
        heapq.heappush(parts, _farthest(points, first, split))
        heapq.heappush(parts, _farthest(points, split, end))
    return tuple(float(number) for number in np.round(points[sorted(kept)], 2).ravel())


def _farthest(points: FloatArray, first: int, last: int) -> tuple[float, int, int, int]:
    """Return the point that is farthest from the line between two: minus its distance, and the three numbers."""
    if last - first < 2:
        return 0.0, first, first, last
    start, along = points[first], points[last] - points[first]
    offsets = points[first + 1 : last] - start
    squared = float(along @ along)
    share = np.clip(offsets @ along / squared, 0.0, 1.0) if squared > 0.0 else np.zeros(len(offsets))
    gaps = np.hypot(*(offsets - share[:, None] * along).T)
    split = int(gaps.argmax())
    return -float(gaps[split]), first, first + 1 + split, last
