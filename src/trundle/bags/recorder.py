"""`Recorder`: an observer that writes a run as a rosbag2 MCAP file."""

from __future__ import annotations

import json
import math
import os
import time as clock
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Self

from trundle.bags.run_record import END_RECORD, RUN_RECORD, describe_run
from trundle.costmap import Costmap
from trundle.costmap.costs import LETHAL, NO_INFORMATION
from trundle.errors import InputError, OutputError, UnknownNameError
from trundle.extras import check_extra
from trundle.files.writing import cannot_write, output_path
from trundle.maps import OccupancyGrid
from trundle.maps.cells import FREE, OCCUPIED, UNKNOWN
from trundle.messages.codec import DEFAULT, DISTROS, Distro
from trundle.mission import Episode, RunInfo, Scenario, Step

if TYPE_CHECKING:
    from trundle.bags.topics import RunTopics

FLUSH_S = 1.0
"""A chunk ends after so many seconds, of the run or of the computer, whichever comes first."""


def partial_name(path: Path) -> Path:
    """Return the name of a recording that is being written: `run.partial.mcap` for `run.mcap`."""
    return path.with_suffix(f".partial{path.suffix}")


class Recorder:
    """Writes a run as rosbag2 does: clock, transforms, odometry, scans, map, costmaps, plans, commands and movers.

    While the run goes on, the file is called `run.partial.mcap` and is flushed each second: where the process is
    killed, `trundle record recover` makes it complete up to there. At the end it gets its name.

    Use it in a `with` block, or let a run end it: `trundle.run(…, observers=[Recorder("run.mcap")])`. The time of the
    messages is the time of the run, which starts at 0.

    Args:
        path: The file, which ends in .mcap.
        scenario: What repeats the run, or None.
        distro: The distribution of ROS 2 whose types, hashes and QoS it has.
        overwrite: Replace a recording of this name, or what a killed run left of one.
        named_by_folder: Keep the partial name until `save` is called; for `RunFolder(extras=…)`.

    Attributes:
        path: The file.

    Raises:
        InputError: If the path does not end in .mcap.
        UnknownNameError: If the distribution is not known.
        OutputError: If there is such a recording.
        MissingExtraError: If rosbags or mcap is not installed.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        *,
        scenario: Scenario | None = None,
        distro: Distro = DEFAULT,
        overwrite: bool = False,
        named_by_folder: bool = False,
    ) -> None:
        check_extra("record", "a recording")
        if distro not in DISTROS:
            raise UnknownNameError("ROS 2 distribution", distro, DISTROS)
        self.path = output_path(path)
        if self.path.suffix != ".mcap":
            raise InputError(f"a recording's file ends in .mcap, got {self.path}")
        self._partial = partial_name(self.path)
        if not overwrite:
            check_free(self.path)
        self._scenario = scenario
        self._distro: Distro = distro
        self._named_by_folder = named_by_folder
        self._topics: RunTopics | None = None
        self._flushed_at = self._flushed_clock = 0.0
        self._is_done = False

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def on_start(self, run: RunInfo) -> None:
        """Create the file, with the settings of the run and everything that does not change.

        Raises:
            OutputError: If it cannot be written, or it has already recorded a run.
        """
        from trundle.bags.topics import RunTopics

        if self._topics is not None or self._is_done:
            raise OutputError(f"{self.path} already has a run; create another Recorder for the next one")
        topics = self._topics = RunTopics(self._partial, run.robot, self._distro)
        topics.bag.add_metadata(RUN_RECORD, describe_run(run, self._scenario, self._distro))
        topics.start(run.grid if run.grid is not None else known_cells(run.costmap), run.goals)
        topics.bag.flush()
        self._flushed_at, self._flushed_clock = 0.0, clock.monotonic()

    def on_step(self, step: Step) -> None:
        """Write the messages of a control period."""
        topics = self._topics
        if topics is None:
            raise OutputError("the recorder got a step without the start of its run: pass it to run(observers=[…])")
        topics.add(step)
        now = clock.monotonic()
        if step.state.time - self._flushed_at >= FLUSH_S or now - self._flushed_clock >= FLUSH_S:
            topics.bag.flush()
            self._flushed_at, self._flushed_clock = step.state.time, now

    def on_end(self, episode: Episode) -> None:
        """Write the episode and the index, and give the file its name."""
        self._finish(episode)
        if not self._named_by_folder:
            self.save(self.path)

    def save(self, path: Path) -> None:
        """Rename the finished file to its final name.

        Raises:
            OutputError: If there is none, or it cannot be renamed.
        """
        if not self._is_done:
            raise OutputError(f"{self._partial} is not finished")
        try:
            self._partial.replace(path)
        except OSError as error:
            raise cannot_write(path, error) from error

    def close(self) -> None:
        """Close the file of a run that did not end; what there is of it stays under its partial name."""
        if self._topics is not None:
            self._topics.bag.abandon()
            self._topics = None

    def _finish(self, episode: Episode) -> None:
        topics = self._topics
        if topics is None:
            return
        content = json.dumps(_without_infinity(episode.as_dict()), ensure_ascii=False)
        topics.bag.add_metadata(END_RECORD, {"outcome": episode.outcome.value, "episode": content})
        topics.bag.close({"trundle.run": episode.name, "trundle.outcome": episode.outcome.value})
        self._topics, self._is_done = None, True


def check_free(path: Path) -> None:
    """Refuse a name that has a recording, complete or not.

    Raises:
        OutputError: If it has.
    """
    partial = partial_name(path)
    if path.exists():
        raise OutputError(f"{path} already exists; give another file, or replace it with --overwrite")
    if partial.exists():
        raise OutputError(
            f"{partial} is what a killed run left, or another run is writing it; keep it with trundle record recover "
            f"{partial}, or replace it with --overwrite"
        )


def known_cells(costmap: Costmap | None) -> OccupancyGrid | None:
    """Return what a costmap says about the map: its occupied, unknown and free cells."""
    if costmap is None:
        return None
    import numpy as np

    cells = np.full(costmap.shape, FREE, dtype=np.int8)
    cells[costmap.data == LETHAL] = OCCUPIED
    cells[costmap.unknown_cells | (costmap.data == NO_INFORMATION)] = UNKNOWN
    return OccupancyGrid(cells, costmap.resolution, costmap.origin)


def _without_infinity(values: Mapping[str, object]) -> dict[str, object]:
    """Return values of an episode, with None for numbers that JSON does not have."""
    return {
        name: None if isinstance(value, float) and not math.isfinite(value) else value for name, value in values.items()
    }
