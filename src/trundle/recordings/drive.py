"""`RecordedDrive`: a drive as observations, what was left out of it, and the robot of one that does not say which."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from trundle.geometry import Pose2D, Twist2D
from trundle.observation import Observation, Scan
from trundle.recordings.odometry import OdometryTrack
from trundle.robots import Robot


class Remarks:
    """Remarks about a recording in the order of their first occurrence."""

    def __init__(self) -> None:
        self._counts: dict[str, int] = {}
        self._notes: list[str] = []

    def note(self, text: str) -> None:
        """Add a remark that is said once, however often it is noted."""
        if text not in self._notes:
            self._notes.append(text)

    def count(self, text: str, times: int = 1) -> None:
        """Count something; the text follows the number: "scans … are left out"."""
        if times:
            self._counts[text] = self._counts.get(text, 0) + times

    @property
    def lines(self) -> tuple[str, ...]:
        """All remarks, one line each."""
        return (*self._notes, *(f"{times} {text}" for text, times in self._counts.items()))


UNKNOWN = "unknown"
"""Name of a robot that is not known."""

_HALF_M = 0.1  # nothing is measured nearer to the middle of a robot than this
_LEAST_SPEED, _LEAST_TURN = 1.0, 1.5  # [m/s], [rad/s]: a slow recording does not make a slow robot
_MARGIN = 1.5


def make_unknown_robot(speed: float, turning_speed: float) -> Robot:
    """Return a robot with a small outline, and limits above the highest speeds that were seen [m/s, rad/s].

    What the robot's own body reflects is not left out by such an outline, but by what is always in the scans: see
    `OwnHits`.
    """
    like = Robot.load("nova_carter")
    limits = like.limits.model_copy(
        update={
            "linear_speed": min(100.0, max(_LEAST_SPEED, _MARGIN * speed)),
            "angular_speed": min(100.0, max(_LEAST_TURN, _MARGIN * turning_speed)),
        }
    )
    outline = ((_HALF_M, _HALF_M), (-_HALF_M, _HALF_M), (-_HALF_M, -_HALF_M), (_HALF_M, -_HALF_M))
    return like.model_copy(
        update={"name": UNKNOWN, "limits": limits, "footprint": outline, "lidars": {}, "casters": ()}
    )


_SAME_S = 1e-6
_ODOMETRY_PERIOD_S = 0.05  # of observations between scans: a run's control periods are as long


@dataclass(frozen=True, slots=True, eq=False)
class DriveStep:
    """One observation of a recording.

    Attributes:
        observation: What the robot observed.
        begins_part: Whether nothing ties its odometry to that of the observation before: the robot was carried, its
            odometry was reset, or the clock of the recording began again.
        share: How much of the recording's scans is read with it, 0 to 1.
    """

    observation: Observation
    begins_part: bool
    share: float


@dataclass(frozen=True, slots=True, eq=False)
class RecordedDrive:
    """A drive that was recorded, by anyone.

    Attributes:
        path: The recording.
        robot: The robot, or what is known of it: an unknown one has a small outline and the speeds of the recording.
        knows_robot: Whether the robot is known.
        lidars: Names of the lidars whose scans are used.
        odometry: Where the odometry is from, such as the name of a topic; None where there is none.
        scans: Number of scans.
        duration_s: From the first to the last scan [s], without what lies between two stretches.
        remarks: What was left out, or taken to be so; complete when all steps are read.
        tracks: The odometry of each stretch; a stretch without odometry has None.
        scans_in_order: Makes an iterator of all scans with the number of their stretch, ascending; in each by time.
        damage: What cut the recording off; empty where it is whole.
        recovered: A whole bag of what could be read of a damaged one, for as long as the drive is kept; else None.
    """

    path: Path
    robot: Robot
    knows_robot: bool
    lidars: tuple[str, ...]
    odometry: str | None
    scans: int
    duration_s: float
    remarks: Remarks
    tracks: Sequence[OdometryTrack | None]
    scans_in_order: Callable[[], Iterator[tuple[int, Scan]]]
    damage: str = ""
    recovered: Path | None = None

    def steps(self) -> Iterator[DriveStep]:
        """Read the observations: one whenever a scan begins and ends, and between scans as the odometry has them.

        Times increase within a stretch. Without odometry the robot seems to stand.

        Raises:
            InputError: If the recording is damaged there.
        """
        stretch, last, read = -1, -np.inf, 0
        begins = False
        for number, ended, scans in _group(self.scans_in_order()):
            read += len(scans)
            if number != stretch:
                begins = stretch >= 0
                stretch, last = number, -np.inf
            track = self.tracks[number]
            began = min(scan.time for scan in scans)
            if ended <= last + _SAME_S:
                self.remarks.count("scans end before the one before, and are left out", len(scans))
                continue
            if track is not None and not track.knows(began, ended):
                self.remarks.count("scans are left out for whose time there is no odometry", len(scans))
                continue
            for time in _times_until(track, last, began, ended):
                seen = scans if time == ended else ()
                pose, twist = (_STANDS, _STILL) if track is None else track.at(time)
                yield DriveStep(Observation(time, twist, pose, seen), begins, read / max(1, self.scans))
                begins = False
            last = ended


def _group(scans: Iterator[tuple[int, Scan]]) -> Iterator[tuple[int, float, tuple[Scan, ...]]]:
    """Join scans that end at one time: the lidars of a simulation measure together."""
    group: list[Scan] = []
    of = (-1, 0.0)
    for number, scan in scans:
        ended = scan.time + scan.time_increment * max(0, len(scan.ranges) - 1)
        if group and (number != of[0] or ended > of[1] + _SAME_S):
            yield of[0], of[1], tuple(group)
            group = []
        if not group:
            of = number, ended
        group.append(scan)
    if group:
        yield of[0], of[1], tuple(group)


_STANDS, _STILL = Pose2D(0.0, 0.0), Twist2D(0.0, 0.0)


def _times_until(track: OdometryTrack | None, last: float, began: float, ended: float) -> list[float]:
    """Return the times of observations after `last` up to the end of a scan."""
    found = [] if track is None else track.between(last, began, _ODOMETRY_PERIOD_S)
    if began > last + _SAME_S and began < ended - _SAME_S:
        found.append(began)
    return [*found, ended]
