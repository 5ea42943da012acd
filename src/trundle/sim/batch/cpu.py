"""`CpuEngine`: the state of a batch in arrays, computed by the kernel; `RobotCrowds`: the crowds around its robots."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from trundle._core import Batch, BatchCrowds
from trundle.errors import WorldError
from trundle.geometry import FloatArray
from trundle.sim.batch.arrays import BatchModel
from trundle.sim.batch.recording import MoverRecording, find_live


class RobotCrowds:
    """The crowds of a batch, which the kernel steps while the robots drive.

    Args:
        model: What the robots share.
        recordings: Movers, some of them with live crowds.
        count: Number of robots.
        threads: Number of threads.

    Attributes:
        kernel: The kernel's state of them, None without live crowds.
    """

    def __init__(self, model: BatchModel, recordings: Sequence[MoverRecording], count: int, threads: int) -> None:
        live = find_live(recordings)
        self._walks = {number: crowds.walk for number, crowds in live.items()}
        self._threads = threads
        self._radius = reach_of(model)
        of_recording = np.full(len(recordings), -1)
        of_recording[list(self._walks)] = np.arange(len(live))
        self.kernel: BatchCrowds | None = None
        if live:
            firsts = [model.recordings[number + 1] - len(crowds.walk.names) for number, crowds in live.items()]
            self.kernel = BatchCrowds(
                [crowds.walk.model for crowds in live.values()],
                np.array(firsts),
                of_recording,
                [crowds.movers for crowds in live.values()],
                count,
            )

    def place(
        self,
        chosen: npt.NDArray[np.int64] | None,
        recordings: npt.NDArray[np.int64],
        poses: FloatArray,
        seeds: npt.NDArray[np.uint64],
    ) -> None:
        """Start the crowds of the chosen robots, or of all if None, by their seeds.

        Raises:
            WorldError: If there is no room for a crowd beside a robot; all crowds stay as they are then.
        """
        if self.kernel is None:
            return
        rows = np.arange(len(poses)) if chosen is None else chosen
        most = max(len(walk.words(0)) for walk in self._walks.values())
        words = np.zeros((len(rows), most, 4), dtype=np.uint64)
        for row, (recording, seed) in enumerate(zip(recordings.tolist(), seeds.tolist(), strict=True)):
            if recording in self._walks:
                drawn = self._walks[recording].words(seed)
                words[row, : len(drawn)] = drawn
        missing = self.kernel.place(rows, recordings, poses, self._radius, words, self._threads)
        if (missing >= 0).any():
            first = int(np.argmax(missing >= 0))
            error = self._walks[int(recordings[first])].has_no_room(int(missing[first]))
            raise WorldError(f"robot {rows[first]}: {error}. Nothing was reset")

    def members(self, robot: int, time: float) -> FloatArray:
        """Return (x, y, yaw) of the members around a robot at its time [s], shape (N, 3)."""
        return np.zeros((0, 3)) if self.kernel is None else self.kernel.members(robot, time)


def reach_of(model: BatchModel) -> float:
    """Return the radius of the robot's circle [m], beside which crowds are placed."""
    return float(np.hypot(model.outline[:, 0], model.outline[:, 1]).max())


Mask = npt.NDArray[np.bool_]


class BatchEngine(Protocol):
    """Holds the state of a batch on some device, and computes it there. Arrays are the device's."""

    poses: Any
    motions: Any
    wheels: Any
    lengths: Any
    steps: Any
    contacts: Any
    places: Any
    ranges: Any

    def takes(self, *values: object) -> bool:
        """Return whether one of these is an array of the device, which is no host array."""
        ...

    def put(self, robots: Any, **given: Any) -> None:
        """Put some robots at rest, or all if None.

        With arrays of the device `takes` one of these, and each of `given` has a row for each robot of the batch;
        otherwise the robots are indices, and checked arrays of the host have a row for each of them.
        """
        ...

    def drive(self, commands: Any, robots: Any, substeps: int) -> None:
        """Drive substeps, and find what is touched first."""
        ...

    def scan(self, robots: Any) -> None:
        """Turn the lidars of some robots once, or of all if None."""
        ...

    def scan_exactly(self) -> FloatArray:
        """Turn all lidars once, and return the ranges in float64."""
        ...

    def off_map(self) -> Any:
        """Return which robots are beyond their map."""
        ...

    def members(self, robot: int, recording: int, time: float) -> FloatArray:
        """Return (x, y, yaw) of the members of crowds around a robot on a recording at its time [s], shape (N, 3)."""
        ...

    def synchronize(self) -> None:
        """Wait for the device, and raise what it has found."""
        ...


class CpuEngine:
    """Computes a batch on the processor.

    Args:
        model: What the robots share.
        recordings: The movers, some of them with live crowds.
        count: Number of robots.
        threads: Number of threads.
    """

    def __init__(self, model: BatchModel, recordings: Sequence[MoverRecording], count: int, threads: int) -> None:
        self._batch = Batch(*model)
        self._crowds = RobotCrowds(model, recordings, count, threads)
        self._model, self._count, self._threads = model, count, threads
        self.poses = np.zeros((count, 3))
        self.wheels = np.zeros((count, 2))
        self.lengths = np.zeros(count)
        self.steps = np.zeros(count, dtype=np.int64)
        self.contacts = np.zeros((count, 4), dtype=np.int64)
        self.places = np.full((count, 2), (0, -1), dtype=np.int64)
        self.motions = np.zeros((count, 6))
        self.ranges = np.full((count, len(model.angles)), np.inf, dtype=np.float32)
        self._errors = np.zeros((count, 2))
        self._keys = np.zeros(count, dtype=np.uint64)
        self._everyone = np.ones(count, dtype=bool)
        self._standing = np.zeros((count, 2))

    def takes(self, *_values: object) -> bool:
        """Return that none is: the processor has arrays of the host."""
        return False

    def put(self, robots: npt.NDArray[np.int64] | None, **given: npt.NDArray) -> None:
        """Put robots at rest, and find what they touch there."""
        rows = slice(None) if robots is None else robots
        self._crowds.place(robots, given["recordings"], given["poses"], given["seeds"])
        self.poses[rows] = given["poses"]
        self.places[rows, 0], self.places[rows, 1] = given["maps"], given["recordings"]
        self._errors[rows, 0], self._errors[rows, 1] = given["noise"], given["dropouts"]
        self._keys[rows] = given["seeds"]
        for array in (self.wheels, self.lengths, self.steps, self.motions):
            array[rows] = 0
        self.drive(self._standing, None if robots is None else mask_of(robots, self._count), 0)

    def drive(self, commands: FloatArray, robots: Mask | None, substeps: int) -> None:
        """Drive substeps, and find what is touched first."""
        active = self._everyone if robots is None else robots
        state = (self.poses, self.motions, self.wheels, self.lengths, self.steps, self.contacts)
        self._batch.drive(*state, commands, self.places, active, substeps, self._threads, self._crowds.kernel)

    def scan(self, robots: Mask | None) -> None:
        """Turn the lidars of some robots once, or of all if None."""
        self._scan_into(self.ranges, self._everyone if robots is None else robots)

    def scan_exactly(self) -> FloatArray:
        """Turn all lidars once, and return the ranges in float64."""
        ranges = np.full(self.ranges.shape, np.inf)
        self._scan_into(ranges, self._everyone)
        return ranges

    def off_map(self) -> Mask:
        """Return which robots are beyond their map."""
        maps, model = self.places[:, 0], self._model
        x, y, yaw = model.frames[maps].T
        dx, dy = self.poses[:, 0] - x, self.poses[:, 1] - y
        cos, sin = np.cos(yaw), np.sin(yaw)
        col, row = (cos * dx + sin * dy) / model.resolution, (cos * dy - sin * dx) / model.resolution
        rows, cols = model.shapes[maps].T
        return (col < 0.0) | (row < 0.0) | (col > cols) | (row > rows)

    def members(self, robot: int, recording: int, time: float) -> FloatArray:
        """Return (x, y, yaw) of the members of crowds around a robot, shape (N, 3)."""
        return self._crowds.members(robot, time)

    def synchronize(self) -> None:
        """Do nothing: the processor is done when a call returns."""

    def _scan_into(self, ranges: npt.NDArray[Any], active: Mask) -> None:
        where = (self.poses, self.steps, self.places, active, self._errors, self._keys)
        self._batch.scan(ranges, *where, self._threads, self._crowds.kernel)


def mask_of(chosen: npt.NDArray[np.int64], count: int) -> Mask:
    """Return a bool for each robot of a batch: whether it is chosen."""
    mask = np.zeros(count, dtype=bool)
    mask[chosen] = True
    return mask
