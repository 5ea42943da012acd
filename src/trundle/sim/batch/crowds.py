"""`RobotCrowds`: the live crowds around each robot of a batch."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from trundle._core import BatchCrowds
from trundle.errors import WorldError
from trundle.geometry import FloatArray
from trundle.sim.batch.arrays import BatchModel
from trundle.sim.batch.recording import MoverRecording


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
        live = [(number, each.crowds) for number, each in enumerate(recordings) if each.crowds is not None]
        self._walks = {number: crowds.walk for number, crowds in live}
        self._threads = threads
        self._radius = float(np.hypot(model.outline[:, 0], model.outline[:, 1]).max())
        of_recording = np.full(len(recordings), -1)
        of_recording[list(self._walks)] = np.arange(len(live))
        self.kernel: BatchCrowds | None = None
        if live:
            firsts = [model.recordings[number + 1] - len(crowds.walk.names) for number, crowds in live]
            self.kernel = BatchCrowds(
                [crowds.walk.model for _, crowds in live],
                np.array(firsts),
                of_recording,
                [crowds.movers for _, crowds in live],
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
