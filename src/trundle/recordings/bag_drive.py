"""`read_bag_drive`: the drive in any rosbag2, of trundle or of a robot that nobody knows.

A bag is read twice: a survey finds the odometry, the mounts and what the lidars are like; then scans are read one after
the other, so that a long drive takes no more memory than its odometry.
"""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from trundle.bags.bag_content import SCANS, make_scan, of_types
from trundle.bags.bag_reader import BagReader
from trundle.bags.run_record import read_record
from trundle.errors import InputError
from trundle.geometry import FloatArray
from trundle.messages import readers
from trundle.messages.codec import DEFAULT, Distro
from trundle.observation import Scan
from trundle.recordings.bag_source import BagSource, DamagedError
from trundle.recordings.bag_survey import (
    LidarSurvey,
    find_base,
    find_mount,
    find_odometry_frame,
    find_odometry_topic,
    find_restarts,
    read_shape,
    survey_bag,
)
from trundle.recordings.drive import RecordedDrive, Remarks, make_unknown_robot
from trundle.recordings.odometry import OdometryTrack, find_jumps
from trundle.robots import Robot

_OTHER_CLOCK_S = 1.0
_WAIT_S = 1.0  # scans of several lidars come in any order within this time
_LONGEST_SCAN = 1.2  # periods that a scan may take, by its time_increment


def read_bag_drive(
    path: Path,
    *,
    robot: Robot | None = None,
    scan_topics: Sequence[str] = (),
    odometry: str | None = None,
    distro: Distro = DEFAULT,
) -> RecordedDrive:
    """Read the drive in a bag; see `open_drive`.

    A bag that was cut off is read up to there, with a remark.

    Raises:
        InputError: If it is no bag, nothing of it can be read, or it has no scans, or no odometry where it must.
    """
    remarks = Remarks()
    source = BagSource(path, distro, remarks)
    try:
        return _Maker(source, robot, scan_topics, odometry).make()
    except DamagedError:
        source.recover()
        return _Maker(source, robot, scan_topics, odometry).make()


@dataclass(frozen=True, slots=True, eq=False)
class _UsedLidar:
    """A lidar whose scans are used.

    Attributes:
        name: Its name.
        mount: Its pose in the base, shape (4, 4).
        angles: Directions of its beams in most scans, in the order in which the sensor turns [rad].
        own: Which of them meet the robot.
        increment: Time from beam to beam [s].
        shift: What is added to its stamps [s]; None where the times of reception are used.
    """

    name: str
    mount: FloatArray
    angles: FloatArray
    own: npt.NDArray[np.bool_]
    increment: float
    shift: float | None


class _Maker:
    """Makes the drive of what a bag holds."""

    def __init__(self, source: BagSource, robot: Robot | None, topics: Sequence[str], odometry: str | None) -> None:
        self._source, self._path, self._remarks = source, source.path, source.remarks
        self._topics, self._wanted = topics, odometry
        self._robot = robot

    def make(self) -> RecordedDrive:
        """Return the drive."""
        with self._source.open() as bag:
            self._check_topics(bag)
            record = read_record(bag.path)
            if self._robot is None and record is not None:
                self._robot = record.robot
            topic = find_odometry_topic(bag, self._wanted)
            self._survey = survey_bag(bag, self._remarks, scan_topics=self._topics, odometry=topic)
        if not self._survey.lidars:
            raise InputError(f"{self._path}: none of the bag's scans can be used: {'; '.join(self._remarks.lines)}")
        self._choose_lidars()
        base = find_base(self._survey)
        shift, name = self._find_shifts()
        self._restarts, tracks = self._make_tracks(base)
        known = [track for track in tracks if track is not None]
        self._used = self._use_lidars(base, known, shift)
        if not self._used:
            raise InputError(f"{self._path}: none of the bag's scans can be used: {'; '.join(self._remarks.lines)}")
        speeds = np.array([track.fastest for track in known]).max(axis=0).tolist() if known else (0.0, 0.0)
        stamps = [self._survey.lidars[key].stamps for key in self._used]
        return RecordedDrive(
            path=self._path,
            robot=self._robot or make_unknown_robot(*speeds),
            knows_robot=self._robot is not None,
            lidars=tuple(lidar.name for lidar in self._used.values()),
            odometry=name if known else None,
            scans=sum(map(len, stamps)),
            duration_s=max(max(one) - min(one) for one in stamps),
            remarks=self._remarks,
            tracks=tracks,
            scans_in_order=self._scans,
            damage=self._source.damage,
            recovered=self._source.recovered,
        )

    def _check_topics(self, bag: BagReader) -> None:
        there = of_types(bag.topics, SCANS)
        if not there:
            kinds = sorted({topic.name for topic in bag.topics if topic.type_name.endswith("PointCloud2")})
            clouds = f"; it has point clouds ({', '.join(kinds)}): record what pointcloud_to_laserscan makes of them"
            raise InputError(
                f"{self._path}: the bag has no scans (sensor_msgs/msg/LaserScan){clouds if kinds else ''}; it has "
                f"{', '.join(topic.name for topic in bag.topics) or 'no topics'}"
            )
        for name in self._topics:
            if name not in [topic.name for topic in there]:
                names = ", ".join(topic.name for topic in there)
                raise InputError(f"{self._path}: --scan-topic {name}: the bag has scans on {names}")

    def _choose_lidars(self) -> None:
        """Keep one topic of each lidar: filtered scans are often recorded beside the lidar's own."""
        by_frame: dict[str, list[LidarSurvey]] = {}
        for lidar in self._survey.lidars.values():
            by_frame.setdefault(lidar.frame, []).append(lidar)
        for frame, lidars in by_frame.items():
            if len(lidars) == 1 or self._topics:
                continue
            names = {lidar.topic for lidar in lidars}
            usual = sorted(lidars, key=lambda one: (one.topic.rsplit("/", 1)[-1] != "scan", len(one.topic), one.topic))
            for lidar in usual[1:]:
                del self._survey.lidars[lidar.topic, frame]
            self._remarks.note(
                f"{', '.join(sorted(names))} are scans of one lidar ({frame!r}): {usual[0].topic} is used; "
                "--scan-topic names another one"
            )

    def _find_shifts(self) -> tuple[dict[tuple[str, str], float | None], str | None]:
        """Return what brings each lidar's stamps to the clock of the odometry, and where the odometry is from."""
        survey = self._survey
        delays = [np.median(np.array(one.received) - np.array(one.stamps)) for one in survey.lidars.values()]
        reference, name = None, "/tf"
        if survey.odometry is not None:
            reference = float(np.median(np.array(survey.odometry_received) - np.array(survey.odometry.times)))
            name = str(survey.odometry_topic)
        shifts: dict[tuple[str, str], float | None] = {}
        for (key, lidar), delay in zip(survey.lidars.items(), delays, strict=True):
            if np.ptp(np.array(lidar.stamps)) == 0.0 and len(lidar.stamps) > 1:
                self._remarks.note(f"the stamps of {lidar.topic} are all the same: the times of reception are used")
                shifts[key] = None
            elif reference is not None and abs(delay - reference) > _OTHER_CLOCK_S:
                self._remarks.note(
                    f"the clock of {lidar.topic} is {delay - reference:+.1f} s off the odometry's, by when they were "
                    "received: corrected"
                )
                shifts[key] = float(delay - reference)
            else:
                shifts[key] = 0.0
        return shifts, name

    def _make_tracks(self, base: str) -> tuple[FloatArray, list[OdometryTrack | None]]:
        """Return when by reception each later stretch begins, and the odometry of each."""
        survey = self._survey
        if survey.odometry is None or self._wanted in ("tf", "none"):
            return self._make_other_tracks(base)
        received, stamps = np.array(survey.odometry_received), np.array(survey.odometry.times)
        poses = np.array(survey.odometry.poses)
        if np.ptp(stamps) == 0.0:
            self._remarks.note("the stamps of the odometry are all the same: the times of reception are used")
            stamps = received
            survey.odometry.times = received.tolist()
        restarts = find_restarts(received, stamps)
        stretch = np.searchsorted(restarts, received, side="right")
        begins: list[float] = []
        tracks: list[OdometryTrack | None] = []
        for number in range(len(restarts) + 1):
            mine = stretch == number
            times, first = np.unique(stamps[mine], return_index=True)
            own, at = poses[mine][first], received[mine][first]
            ends = [0, *find_jumps(times, own).tolist(), len(times)]
            for one, other in itertools.pairwise(ends):
                begins.append(float(at[one]))
                tracks.append(OdometryTrack(times[one:other], own[one:other]))
        if len(tracks) > 1:
            why = "its clock goes back, or it jumps farther than a robot drives"
            self._remarks.count(f"breaks in the odometry ({why}): the map begins a new part there", len(tracks) - 1)
        return np.array(begins[1:]), tracks

    def _make_other_tracks(self, base: str) -> tuple[FloatArray, list[OdometryTrack | None]]:
        """Return the odometry of the transforms; one stretch without it where there is none, or none is wanted."""
        tree = self._survey.tree
        frame = None if self._wanted == "none" else find_odometry_frame(self._survey, base)
        if frame is None:
            if self._wanted == "tf":
                raise InputError(
                    f"{self._path}: --odom tf: no transform moves {base!r}; frames: {', '.join(tree.frames)}"
                )
            return np.zeros(0), [None]
        lidars = self._survey.lidars.values()
        received = np.concatenate([one.received for one in lidars])
        if len(find_restarts(received, np.concatenate([one.stamps for one in lidars]))):
            raise InputError(
                f"{self._path}: the clock of its stamps goes back, and its only odometry is /tf, which cannot be told "
                "apart then; record the odometry's topic, or give the parts as bags of their own"
            )
        chain = tree.chain(base, frame) or []
        times = np.unique(np.concatenate([tree.times(child) for child in chain]))
        times = times[times >= max(tree.times(child)[0] for child in chain if len(tree.times(child))) - 1e-9]
        poses = tree.poses(base, frame, times)
        if "odom" not in frame:
            self._remarks.note(f"no frame of the odometry: poses of {base!r} in {frame!r} take its place")
        ends = [0, *find_jumps(times, poses).tolist(), len(times)]
        tracks: list[OdometryTrack | None] = [
            OdometryTrack(times[one:other], poses[one:other]) for one, other in itertools.pairwise(ends)
        ]
        if len(tracks) > 1:
            self._remarks.count("jumps in the transforms: the map begins a new part there", len(tracks) - 1)
        delay = float(np.median(received - np.concatenate([one.stamps for one in lidars])))
        return times[ends[1:-1]] + delay, tracks

    def _use_lidars(
        self, base: str, tracks: list[OdometryTrack], shifts: dict[tuple[str, str], float | None]
    ) -> dict[tuple[str, str], _UsedLidar]:
        """Return the lidars whose place on the robot is known, by topic and frame."""
        used: dict[tuple[str, str], _UsedLidar] = {}
        for key, lidar in self._survey.lidars.items():
            mount = find_mount(self._survey, lidar, base, self._robot, self._remarks)
            if mount is None:
                continue
            count, first, step = lidar.shape
            others = sum(lidar.shapes.values()) - lidar.shapes[lidar.shape]
            self._remarks.count(f"scans of {lidar.topic} have other beams than most: moved to the nearest ones", others)
            name = lidar.frame if [one.frame for one in self._survey.lidars.values()].count(lidar.frame) == 1 else ""
            used[key] = _UsedLidar(
                name or f"{lidar.frame}{lidar.topic}",
                mount,
                first + step * np.arange(count, dtype=np.float64),
                self._find_own_hits(lidar, tracks),
                self._find_increment(lidar),
                shifts[key],
            )
        return used

    def _find_own_hits(self, lidar: LidarSurvey, tracks: list[OdometryTrack]) -> npt.NDArray[np.bool_]:
        if len(tracks) != 1:
            return np.zeros(0, dtype=bool)
        delay = np.median(np.array(lidar.received) - np.array(lidar.stamps))
        times = lidar.own_hits.times - delay
        poses = np.column_stack([np.interp(times, tracks[0].times, column) for column in tracks[0].poses.T])
        mask = lidar.own_hits.find(poses)
        if mask.any():
            self._remarks.note(f"{int(mask.sum())} beams of {lidar.topic} always meet the robot itself: left out")
        return mask

    def _find_increment(self, lidar: LidarSurvey) -> float:
        """Return the time from beam to beam [s], if a scan does not take longer than it is until the next."""
        increment = lidar.increments.most_common(1)[0][0]
        period = lidar.period
        if increment >= 0.0 and (lidar.shape[0] - 1) * increment <= _LONGEST_SCAN * period:
            return increment
        self._remarks.note(
            f"time_increment {increment:g} s of {lidar.topic} does not fit a scan every {period:.3g} s: its beams are "
            "taken to be measured at once"
        )
        return 0.0

    def _scans(self) -> Iterator[tuple[int, Scan]]:
        """Read the scans in order of their ends: several lidars take turns, and some messages come late."""
        waiting: list[tuple[int, float, int, Scan]] = []
        newest = -np.inf
        stretch, taken = 0, 0
        last: dict[tuple[str, str], tuple[int, float]] = {}
        with self._source.open() as bag:
            topics = [topic for topic in of_types(bag.topics, SCANS) if any(key[0] == topic.name for key in self._used)]
            for topic, received, message in bag.messages(topics):
                key = topic.name, readers.read_frame(message.header.frame_id)
                lidar = self._used.get(key)
                scan = None if lidar is None else self._make_scan(lidar, message, received)
                if scan is None:
                    continue
                number = int(np.searchsorted(self._restarts, received, side="right"))
                if last.get(key, (-1, 0.0))[0] == number and scan.time <= last[key][1] + 1e-9:
                    self._remarks.count(f"scans of {topic.name} are not later than the one before, and are left out")
                    continue
                last[key] = number, scan.time
                if number != stretch:
                    while waiting:
                        yield _first(waiting)
                    stretch, newest = number, -np.inf
                taken += 1
                ended = scan.time + scan.time_increment * (len(scan.ranges) - 1)
                heapq.heappush(waiting, (number, ended, taken, scan))
                newest = max(newest, ended)
                while waiting and waiting[0][1] < newest - _WAIT_S:
                    yield _first(waiting)
            while waiting:
                yield _first(waiting)

    def _make_scan(self, lidar: _UsedLidar, message: Any, received: float) -> Scan | None:
        shape = read_shape(message)
        if shape is None:
            return None
        _, first, step = shape
        message.angle_min, message.angle_increment = first, step
        message.time_increment = lidar.increment
        low, high = float(message.range_min), float(message.range_max)
        if not (np.isfinite(low) and low >= 0.0):
            message.range_min = low = 0.0
        if not (np.isfinite(high) and high > low):
            message.range_max = high = low + 100.0
        try:
            scan = make_scan(message, lidar.name, lidar.mount)
        except InputError as error:
            self._remarks.note(f"scans are left out: {error}")
            return None
        sign = -1.0 if lidar.mount[2, 2] < 0.0 else 1.0
        angles, ranges = sign * lidar.angles, np.array(scan.ranges)
        if not np.array_equal(scan.angles, angles):
            ranges = _move_beams(scan.angles, ranges, angles)
        ranges[np.isfinite(ranges) & (ranges > high)] = np.inf
        ranges[np.isfinite(ranges) & (ranges < max(low, 1e-3))] = np.nan
        if len(lidar.own) == len(ranges):
            ranges[lidar.own] = np.nan
        time = received if lidar.shift is None else scan.time + lidar.shift
        return replace(scan, time=time, angles=angles, ranges=ranges)


def _move_beams(angles: FloatArray, ranges: FloatArray, wanted: FloatArray) -> FloatArray:
    """Return ranges of the nearest beams at other angles; NaN where there is none."""
    order = np.argsort(angles)
    found = np.clip(np.searchsorted(angles[order], wanted), 1, max(1, len(angles) - 1))
    if len(angles) == 1:
        found = np.ones(len(wanted), dtype=int)
        order = np.repeat(order, 2)
    left, right = order[found - 1], order[found]
    nearest = np.where(np.abs(angles[left] - wanted) <= np.abs(angles[right] - wanted), left, right)
    step = np.median(np.abs(np.diff(angles))) if len(angles) > 1 else 0.01
    return np.where(np.abs(angles[nearest] - wanted) <= 0.75 * step, ranges[nearest], np.nan)


def _first(waiting: list[tuple[int, float, int, Scan]]) -> tuple[int, Scan]:
    number, _, _, scan = heapq.heappop(waiting)
    return number, scan
