"""CARMEN logs as drives: FLASER, RLASER, ROBOTLASER, RAWLASER, ODOM and PARAM lines, plain or gzipped.

The meaning of the fields is that of CARMEN's logger. Scans of FLASER lines have no directions: 180 and 181 beams are
1° apart, 360 and 361 half a degree, from -90° on, as CARMEN itself takes them; other numbers share 180° evenly.
"""

from __future__ import annotations

import gzip
import itertools
import math
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.files.opening import describe_unreadable, open_file
from trundle.geometry import FloatArray, Pose2D
from trundle.observation import Scan
from trundle.recordings.carmen_times import mend_times
from trundle.recordings.drive import RecordedDrive, Remarks, make_unknown_robot
from trundle.recordings.odometry import OdometryTrack, find_jumps
from trundle.recordings.own_hits import OwnHits
from trundle.robots import Robot

SUFFIXES = (".log", ".clf", ".gz")

_LONGEST_LINE = 1_000_000
_MOST_BYTES = 2_000_000_000  # of the unpacked text
_MOST_BEAMS = 20_000
_FARTHEST_M = 1e5
_LOOKS_M = 0.3  # height of the beams, which a log does not say
_NO_RETURN_SHARE = 5e-4  # the largest range is no measurement where it is so common
_LEAST_RANGE_M = 0.02  # smaller ones are errors of the lidar
_OLD = {"FLASER": "front", "RLASER": "rear"}


@dataclass(slots=True, eq=False)
class _Laser:
    """The scans of one of the robot's lasers, in the log's order."""

    name: str
    angles: FloatArray
    range_max: float | None
    ranges: list[npt.NDArray[np.float32]] = field(default_factory=list[npt.NDArray[np.float32]])
    order: list[int] = field(default_factory=list[int])
    times: list[float] = field(default_factory=list[float])
    lasers: list[tuple[float, ...]] = field(default_factory=list[tuple[float, ...]])
    robots: list[tuple[float, ...]] = field(default_factory=list[tuple[float, ...]])


@dataclass(slots=True, eq=False)
class _Log:
    """The content of a log."""

    lasers: dict[str, _Laser] = field(default_factory=dict[str, _Laser])
    odometry: list[tuple[float, ...]] = field(default_factory=list[tuple[float, ...]])
    odometry_order: list[int] = field(default_factory=list[int])
    parameters: dict[str, str] = field(default_factory=dict[str, str])
    damage: str = ""


def looks_like_carmen(path: Path) -> bool:
    """Return whether a file's name is that of a CARMEN log."""
    return path.suffix.lower() in SUFFIXES


def read_carmen(path: Path, *, robot: Robot | None = None) -> RecordedDrive:
    """Read a CARMEN log.

    Args:
        path: The log, plain or gzipped.
        robot: The robot, where it is known.

    Raises:
        InputError: If it cannot be read, or has no scans with odometry.
    """
    remarks = Remarks()
    log = _read_log(path, remarks)
    used = [laser for laser in log.lasers.values() if laser.ranges]
    if not used:
        raise InputError(f"{path}: no scans: no FLASER, RLASER, ROBOTLASER or RAWLASER line; give a CARMEN log")
    return _Maker(path, log, used, robot, remarks).make()


class _Maker:
    """Makes the drive of what a log holds."""

    def __init__(self, path: Path, log: _Log, lasers: list[_Laser], robot: Robot | None, remarks: Remarks) -> None:
        self._path, self._log, self._lasers, self._robot, self._remarks = path, log, lasers, robot, remarks

    def make(self) -> RecordedDrive:
        """Return the drive."""
        order, times, poses = self._merge()
        times, mended = mend_times(times, poses)
        if mended == len(times) - 1 and mended:
            self._remarks.note("the times of the log are broken: they were estimated from how far the robot drove")
        else:
            self._remarks.count("times are not after the one before: they were estimated from the motion", mended)
        jumps = find_jumps(times, poses)
        ends = [0, *jumps.tolist(), len(times)]
        tracks = [
            OdometryTrack(times[first:last], poses[first:last], is_sampled=True)
            for first, last in itertools.pairwise(ends)
        ]
        stretches = np.searchsorted(jumps, np.arange(len(times)), side="right")
        masks = {id(laser): self._find_own_hits(laser, order, poses) for laser in self._lasers}
        speeds = np.array([track.fastest for track in tracks]).max(axis=0)
        known = self._robot is not None
        mounts = {id(laser): self._find_mount(laser) for laser in self._lasers}
        far = {id(laser): self._find_range_max(laser) for laser in self._lasers}

        def scans() -> Iterator[tuple[int, Scan]]:
            for row, (laser, index) in enumerate(order):
                ranges = laser.ranges[index].astype(np.float64)
                mask = masks[id(laser)]
                if len(mask) == len(ranges):
                    ranges[mask] = np.nan
                ranges[ranges >= far[id(laser)]] = np.nan  # SICK lasers write 81.91 m for several errors, too
                ranges[ranges < _LEAST_RANGE_M] = np.nan
                yield (
                    int(stretches[row]),
                    Scan(
                        laser.name,
                        float(times[row]),
                        mounts[id(laser)],
                        _LOOKS_M,
                        laser.angles,
                        ranges,
                        _LEAST_RANGE_M,
                        far[id(laser)],
                    ),
                )

        return RecordedDrive(
            path=self._path,
            robot=self._robot or make_unknown_robot(*speeds.tolist()),
            knows_robot=known,
            lidars=tuple(laser.name for laser in self._lasers),
            odometry="the poses of the scans" if self._has_poses() else "ODOM lines",
            scans=len(order),
            duration_s=float(sum(track.times[-1] - track.times[0] for track in tracks)),
            remarks=self._remarks,
            tracks=tracks,
            scans_in_order=scans,
            damage=self._log.damage,
        )

    def _has_poses(self) -> bool:
        return all(len(laser.robots) == len(laser.ranges) for laser in self._lasers) and any(
            np.ptp(np.array(laser.robots), axis=0).max() > 1e-6 for laser in self._lasers
        )

    def _merge(self) -> tuple[list[tuple[_Laser, int]], FloatArray, FloatArray]:
        """Return all scans in the log's order, with their times and the robot's poses."""
        rows = sorted(
            ((laser.order[index], laser, index) for laser in self._lasers for index in range(len(laser.ranges))),
            key=lambda row: row[0],
        )
        order = [(laser, index) for _, laser, index in rows]
        times = np.array([laser.times[index] for laser, index in order])
        if self._has_poses():
            return order, times, np.array([laser.robots[index] for laser, index in order])
        if len(self._log.odometry) < 2:
            standing = any(laser.robots for laser in self._lasers)
            why = "the robot stands in all of it" if standing else "its scans have no pose, and it has no ODOM lines"
            raise InputError(f"{self._path}: no odometry: {why}; a log of a drive needs one of them")
        return order, times, self._odometry_at(np.array([row[0] for row in rows]), times)

    def _odometry_at(self, lines: npt.NDArray[np.int64], times: FloatArray) -> FloatArray:
        """Return poses of ODOM lines at the scans: by time where their times increase, else by their place."""
        table = np.array(self._log.odometry)
        poses = table[:, :3].copy()
        poses[:, 2] = np.unwrap(poses[:, 2])
        places, at = np.array(self._log.odometry_order, dtype=np.float64), lines.astype(np.float64)
        known = table[:, 3]
        if (np.diff(known) > 0.0).all() and (times >= known[0] - 1.0).all() and (times <= known[-1] + 1.0).all():
            places, at = known, times
        return np.column_stack([np.interp(at, places, column) for column in poses.T])

    def _find_mount(self, laser: _Laser) -> Pose2D:
        """Return where a laser is on the robot: by the robot's file, its parameters, or both their poses."""
        if self._robot is not None and laser.name in self._robot.lidars:
            lidar = self._robot.lidars[laser.name]
            return Pose2D(lidar.x, lidar.y, lidar.yaw)
        yaw = math.pi if laser.name == "rear" else 0.0
        name = {"front": "robot_frontlaser_offset", "rear": "robot_rearlaser_offset"}.get(laser.name)
        if len(laser.lasers) == len(laser.robots) and laser.lasers:
            offset = _median_offset(np.array(laser.robots), np.array(laser.lasers))
            if offset is not None and max(abs(offset.x), abs(offset.y), abs(offset.yaw)) > 1e-3:
                return offset
        offset = self._number(name) if name is not None else None
        if offset is None and laser.name not in _OLD.values():
            self._remarks.note(f"where laser {laser.name!r} is on the robot is not known: taken to be in its middle")
        return Pose2D(offset or 0.0, 0.0, yaw)

    def _find_range_max(self, laser: _Laser) -> float:
        """Return the range [m] from which on there was no return: the log's own, else the largest if it is common."""
        values = np.concatenate(laser.ranges)
        values = values[np.isfinite(values)]
        largest = float(values.max()) if len(values) else 1.0
        by_name = {"front": "robot_front_laser_max", "rear": "robot_rear_laser_max"}.get(laser.name)
        said = laser.range_max or (self._number(by_name) if by_name is not None else None)
        if said is not None and said > 1.0:
            return min(said, largest + 1e-3)
        is_common = (values > largest - 0.1).mean() > _NO_RETURN_SHARE
        return max(largest - 0.1 if is_common else largest + 1e-3, _LEAST_RANGE_M + 1e-3)

    def _find_own_hits(
        self, laser: _Laser, order: list[tuple[_Laser, int]], poses: FloatArray
    ) -> npt.NDArray[np.bool_]:
        hits = OwnHits()
        rows = [row for row, (owner, _) in enumerate(order) if owner is laser]
        for row in rows:
            hits.add(float(row), laser.ranges[order[row][1]].astype(np.float64))
        turned = poses.copy()
        turned[:, 2] = np.unwrap(turned[:, 2])
        mask = hits.find(turned[hits.times.astype(int)])
        if mask.any():
            self._remarks.note(
                f"{int(mask.sum())} beams of laser {laser.name!r} always meet the robot itself: left out"
            )
        return mask

    def _number(self, name: str | None) -> float | None:
        try:
            value = float(self._log.parameters.get(name or "", ""))
        except ValueError:
            return None
        return value if math.isfinite(value) and abs(value) < _FARTHEST_M else None


def _median_offset(robots: FloatArray, lasers: FloatArray) -> Pose2D | None:
    """Return where the laser is on the robot, from the poses of both; None where they do not agree."""
    step = lasers - robots
    cos, sin = np.cos(robots[:, 2]), np.sin(robots[:, 2])
    x, y = cos * step[:, 0] + sin * step[:, 1], -sin * step[:, 0] + cos * step[:, 1]
    yaw = np.angle(np.exp(1j * step[:, 2]))
    offset = [float(np.median(values)) for values in (x, y, yaw)]
    if max(np.abs(x - offset[0]).max(), np.abs(y - offset[1]).max()) > 0.05 or math.hypot(*offset[:2]) > 5.0:
        return None  # the laser's pose is one of another frame: corrected, say
    return Pose2D(*offset)


def _read_log(path: Path, remarks: Remarks) -> _Log:
    log = _Log()
    try:
        with open_file(path) as stream:
            zipped = stream.read(2) == b"\x1f\x8b"
            stream.seek(0)
            source: BinaryIO = gzip.GzipFile(fileobj=stream) if zipped else stream  # type: ignore[assignment]
            for number, line in enumerate(_lines(source, path, log)):
                words = line.split()
                if not words or words[0].startswith(b"#"):
                    continue
                if not _add_line(log, number, words):
                    remarks.count("lines of the log are damaged, and left out")
    except OSError as error:
        raise InputError(describe_unreadable(path, error, "a CARMEN log")) from error
    if log.damage:
        remarks.note(f"the file is cut off or damaged ({log.damage}): what could be read before is used")
    return log


def _lines(stream: BinaryIO, path: Path, log: _Log) -> Iterator[bytes]:
    """Read lines up to the end, or to where a gzipped file is cut off or damaged, which the log then says."""
    size = 0
    while True:
        try:
            line = stream.readline(_LONGEST_LINE)
        except (EOFError, zlib.error, gzip.BadGzipFile) as error:
            log.damage = str(error)
            return
        if not line:
            return
        size += len(line)
        if size > _MOST_BYTES:
            raise InputError(f"{path}: it unpacks to more than {_MOST_BYTES} bytes; split the log")
        if b"\0" in line[:64]:
            raise InputError(f"{path}: not a CARMEN log: it is not text. {_BINARY_ADVICE}")
        yield line


_BINARY_ADVICE = "An MRPT .rawlog has to be converted to CARMEN or rosbag2 first; a bag ends in .mcap or .db3"


def _add_line(log: _Log, number: int, words: list[bytes]) -> bool:
    """Add a line to the log; whether it could be read. Lines of other kinds are ignored."""
    kind = words[0].decode("ascii", "replace")
    try:
        if kind == "PARAM":
            log.parameters[words[1].decode("utf-8", "replace")] = words[2].decode("utf-8", "replace")
        elif kind == "ODOM":
            values = _floats([*words[1:4], words[7]])
            log.odometry.append(values)
            log.odometry_order.append(number)
        elif kind in _OLD:
            _add_old_scan(log, kind, number, words)
        elif kind.startswith(("ROBOTLASER", "RAWLASER")) and kind[-1].isdigit():
            _add_scan(log, kind, number, words)
    except (ValueError, IndexError, OverflowError):
        return False
    return True


def _add_old_scan(log: _Log, kind: str, number: int, words: list[bytes]) -> None:
    """Add a FLASER or RLASER line: number of beams, ranges, pose of the laser, odometry, times."""
    count = _count(words[1])
    ranges, rest = _floats(words[2 : 2 + count]), words[2 + count :]
    if len(ranges) != count:
        raise ValueError("cut off")
    values = _floats([*rest[:6], rest[6]])
    name = _OLD[kind] if _OLD[kind] not in log.lasers or _beams(log, _OLD[kind]) == count else f"{_OLD[kind]}_{count}"
    laser = log.lasers.setdefault(name, _Laser(name, _old_angles(count), None))
    _append(laser, number, ranges, values[6], values[:3], values[3:6])


def _add_scan(log: _Log, kind: str, number: int, words: list[bytes]) -> None:
    """Add a ROBOTLASER or RAWLASER line: its angles and limits, ranges, remissions, and of a ROBOTLASER the poses."""
    start, fov, step, far = _floats(words[2:6])
    count = _count(words[8])
    ranges = _floats(words[9 : 9 + count])
    remissions = int(words[9 + count])
    if len(ranges) != count or not 0 <= remissions <= _MOST_BEAMS:
        raise ValueError("cut off")
    rest = words[10 + count + remissions :]
    if not 0.0 < step < 1.0:
        step = fov / max(1, count - 1)
    name = f"laser{kind[-1]}" + ("_raw" if kind.startswith("RAW") else "")
    if name in log.lasers and _beams(log, name) != count:
        name = f"{name}_{count}"
    laser = log.lasers.setdefault(
        name, _Laser(name, start + step * np.arange(count, dtype=np.float64), far if far > 0.0 else None)
    )
    if kind.startswith("RAW"):
        _append(laser, number, ranges, _floats(rest[:1])[0])
    else:
        values = _floats([*rest[:6], rest[11]])
        _append(laser, number, ranges, values[6], values[:3], values[3:6])


def _append(
    laser: _Laser,
    number: int,
    ranges: tuple[float, ...],
    time: float,
    place: tuple[float, ...] | None = None,
    robot: tuple[float, ...] | None = None,
) -> None:
    values = np.array(ranges, dtype=np.float32)
    values[values < 0.0] = np.nan
    laser.ranges.append(values)
    laser.order.append(number)
    laser.times.append(time)
    if place is not None and robot is not None:
        laser.lasers.append(place)
        laser.robots.append(robot)


def _old_angles(count: int) -> FloatArray:
    step = math.radians(1.0) if count in (180, 181) else math.radians(0.5)
    if count not in (180, 181, 360, 361):
        step = math.pi / max(1, count - 1)
    return -math.pi / 2.0 + step * np.arange(count, dtype=np.float64)


def _beams(log: _Log, name: str) -> int:
    return len(log.lasers[name].angles)


def _count(word: bytes) -> int:
    count = int(word)
    if not 1 <= count <= _MOST_BEAMS:
        raise ValueError("no number of beams")
    return count


def _floats(words: list[bytes]) -> tuple[float, ...]:
    """Read numbers; all but ranges must be finite and in the range of any log, which ranges are, too."""
    values = tuple(map(float, words))
    if not all(math.isfinite(value) and abs(value) < 1e11 for value in values):
        raise ValueError("not finite")
    return values
