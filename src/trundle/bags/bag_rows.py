"""`Rows`: where a bag's robot was and how it moved, at times in common; `Beliefs`: what its localizer believed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeVar

import numpy as np
import numpy.typing as npt

from trundle.bags.bag_content import BagContent
from trundle.bags.transforms import TransformTree
from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D, Twist2D, wrap_angles
from trundle.observation import LOCALIZATION_STATES, Estimate, Scan

PERIOD_S = 0.05
"""Rows are at most so close, as a run's control periods are."""

_BASES = ("base_link", "base_footprint")
_LONGEST_S = 6.0 * 3600.0  # of a recording: rows are made for all of it, in memory


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """Samples of a bag at the times of its odometry's transforms, in the map frame.

    Attributes:
        began: Stamp [s] of the first row.
        times: From there [s], increasing, shape (N,).
        estimates: Poses (x, y, yaw) of the base by the transforms, shape (N, 3).
        truths: True poses where the bag has them, else the estimates.
        odometry: Poses of the base in the odom frame; from the first row on where there is no such frame.
        twists: (v, w) in the base frame, shape (N, 2).
        commands: What the controller asked for; the same as `sent` where only that is known.
        sent: What was sent.
        base: Frame of the base.
        map_frame: Frame of the map.
        tree: All frames.
    """

    began: float
    times: FloatArray
    estimates: FloatArray
    truths: FloatArray
    odometry: FloatArray
    twists: FloatArray
    commands: FloatArray
    sent: FloatArray
    base: str
    map_frame: str
    tree: TransformTree

    @property
    def period(self) -> float:
        """Time between two rows [s], as most are."""
        return float(np.median(np.diff(self.times))) if len(self.times) > 1 else PERIOD_S

    def place(self, poses: FloatArray, frame: str, time: float) -> FloatArray | None:
        """Return poses in a frame, seen in the map frame at a time of stamps [s]; None where no transform ties them."""
        if frame in (self.map_frame, ""):
            return poses
        if self.tree.chain(frame, self.map_frame) is None:
            return None
        x, y, yaw = self.tree.poses(frame, self.map_frame, np.array([time]))[0]
        cos, sin = np.cos(yaw), np.sin(yaw)
        return np.column_stack(
            [x + cos * poses[:, 0] - sin * poses[:, 1], y + sin * poses[:, 0] + cos * poses[:, 1], poses[:, 2] + yaw]
        )

    def shift(self, scan: Scan) -> Scan:
        """Return a scan with its time on the clock of the rows."""
        return replace(scan, time=scan.time - self.began)


def make_rows(content: BagContent, source: Path) -> Rows:
    """Sample a bag.

    Raises:
        InputError: If no transform ties a base frame to the map frame, or there is no moment at which it is known.
    """
    tree = content.tree
    base, map_frame = _find_frames(content, source)
    chain = tree.chain(base, map_frame) or []
    stamps = max((tree.times(frame) for frame in chain), key=len)
    moving = [tree.times(frame) for frame in chain if len(tree.times(frame))]
    if not moving:
        raise InputError(
            f"{source}: the transforms from {map_frame!r} to {base!r} are all static: the robot never moved; "
            "give a recording of a drive"
        )
    stamps = stamps[(stamps >= max(times[0] for times in moving) - 1e-9)]
    stamps = _thin(stamps, PERIOD_S)
    if not len(stamps) or stamps[-1] - stamps[0] > _LONGEST_S:
        seconds = stamps[-1] - stamps[0] if len(stamps) else 0.0
        raise InputError(
            f"{source}: its transforms span {seconds:.0f} s, and a run may last {_LONGEST_S / 3600:.0f} h; check the "
            "clock of their stamps"
        )
    estimates = tree.poses(base, map_frame, stamps)
    odometry, twists = _read_odometry(content, base, stamps, estimates)
    sent = _read_commands(content, content.commands, stamps)
    asked = _read_commands(content, content.asked, stamps) if content.asked else sent
    truths = estimates
    if content.truth is not None and len(content.truth.times) > 1:
        truth = content.truth
        truths, twists = _sample(truth.times, truth.poses, stamps), _sample(truth.times, truth.twists, stamps)
    for poses in (estimates, truths, odometry):
        poses[:, 2] = wrap_angles(poses[:, 2])
    times = stamps - stamps[0]
    return Rows(float(stamps[0]), times, estimates, truths, odometry, twists, asked, sent, base, map_frame, tree)


def _find_frames(content: BagContent, source: Path) -> tuple[str, str]:
    """Return the frames of the base and of the map: by their usual names, by the odometry, and by the map."""
    tree = content.tree
    child = [content.odometry.child] if content.odometry is not None and content.odometry.child else []
    bases = [*child, *_BASES, *(frame for frame in tree.frames if frame.rsplit("/", 1)[-1] in _BASES)]
    maps = dict.fromkeys([content.map_frame, "map", *(one for one in tree.frames if one.rsplit("/", 1)[-1] == "map")])
    for map_frame in maps:
        for base in bases:
            if tree.chain(base, map_frame):
                return base, map_frame
    raise InputError(
        f"{source}: no transform ties a base frame ({', '.join(dict.fromkeys(bases))}) to the map frame "
        f"({', '.join(maps)}); the bag has the frames {', '.join(tree.frames)}. Was localization running?"
    )


def _read_odometry(
    content: BagContent, base: str, stamps: FloatArray, estimates: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return poses in the odom frame, and twists: of the odometry's messages, else of the transforms."""
    odometry = content.odometry
    if odometry is not None and len(odometry.times) > 1:
        return _sample(odometry.times, odometry.poses, stamps), _sample(odometry.times, odometry.twists, stamps)
    poses = estimates
    if content.tree.chain(base, "odom"):
        poses = content.tree.poses(base, "odom", stamps)
    return poses.copy(), _differentiate(stamps, poses)


def _read_commands(content: BagContent, commands: list[tuple[float, Twist2D]], stamps: FloatArray) -> FloatArray:
    """Return the command that was last sent at each time; zeros before the first one."""
    if not commands:
        return np.zeros((len(stamps), 2))
    received = content.stamps_of(np.array([time for time, _ in commands]))
    values = np.array([(0.0, 0.0), *((twist.v, twist.w) for _, twist in commands)])
    return values[np.searchsorted(received, stamps + 1e-6, side="right")]


def _sample(times: list[float], values: list[tuple[float, ...]], stamps: FloatArray) -> FloatArray:
    """Return values at times, interpolated; the third column is an angle."""
    known, first = np.unique(np.array(times), return_index=True)
    table = np.array(values, dtype=np.float64)[first]
    if table.shape[1] == 3:
        table[:, 2] = np.unwrap(table[:, 2])
    return np.column_stack([np.interp(stamps, known, column) for column in table.T])


def _differentiate(stamps: FloatArray, poses: FloatArray) -> FloatArray:
    """(v, w) of poses over time; v is along the robot's own axis."""
    if len(stamps) < 2:
        return np.zeros((len(stamps), 2))
    dx, dy = np.gradient(poses[:, 0], stamps), np.gradient(poses[:, 1], stamps)
    yaw = np.unwrap(poses[:, 2])
    return np.column_stack([dx * np.cos(yaw) + dy * np.sin(yaw), np.gradient(yaw, stamps)])


def _thin(stamps: FloatArray, period: float) -> FloatArray:
    """Return times that are at least about a period apart, of which the last one is among them."""
    kept: list[float] = []
    for stamp in stamps.tolist():
        if not kept or stamp - kept[-1] >= period * 0.95:
            kept.append(stamp)
    if kept:
        kept[-1] = float(stamps[-1])
    return np.array(kept)


_Known = TypeVar("_Known")


class Beliefs:
    """Makes the estimates of the rows of a bag: pose by its transforms, the rest as it was known last.

    Args:
        content: The bag's content.
        rows: Its rows.

    Attributes:
        states: Index in `LOCALIZATION_STATES` at each row, shape (N,).
        has_localizer: Whether the bag has anything of a localizer.
    """

    def __init__(self, content: BagContent, rows: Rows) -> None:
        self._rows = rows
        self._covariances = _at(rows, content.covariances)
        self._particles = _at(rows, content.particles)
        said = self._said = _at(rows, content.states)
        states = [0 if one is None else LOCALIZATION_STATES.index(one[0]) for one in said]
        self.states: npt.NDArray[np.int64] = np.array(states, dtype=np.int64)
        self.has_localizer = bool(content.covariances or content.particles or content.states)

    def at(self, index: int, time: float, pose: Pose2D, odometry: Pose2D) -> Estimate:
        """Return the estimate of a row."""
        said = self._said[index]
        return Estimate(
            time,
            pose,
            self._covariances[index],
            pose @ odometry.inverse(),
            LOCALIZATION_STATES[self.states[index]],
            () if said is None else said[1],
            self._particles[index],
        )


def _at(rows: Rows, known: Sequence[tuple[float, _Known]]) -> list[_Known | None]:
    """Return what was known last at each row, or None before there was anything."""
    times = np.array([time for time, _ in known]) - rows.began
    last = np.searchsorted(times, rows.times + 1e-6, side="right") - 1
    return [known[index][1] if index >= 0 else None for index in last.tolist()]
