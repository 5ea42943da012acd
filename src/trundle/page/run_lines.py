"""`RunLines`: the log of a run for the page: rows, paths and events, which are only added to."""

from __future__ import annotations

from typing import Any

import numpy as np

from trundle.costmap import Costmap
from trundle.geometry import Pose2D
from trundle.mission.episode import Episode
from trundle.mission.metrics import CLEARANCE_CAP
from trundle.mission.observers import RunInfo, Step
from trundle.page.encoding import pack_array
from trundle.page.events import Events
from trundle.page.rows import info_of, row_of
from trundle.path import Path
from trundle.sim.clearance import map_world

_RESOLUTION_M = 0.05


class RunLines:
    """Collects the log of a run, step by step, to be sent as it grows.

    Args:
        info: The start of the run.

    Attributes:
        info: What `info_of` says of it.
        rows: One of `COLUMNS` for each step.
        paths: {"t", "points"} for each path that was followed from then on; the points are an array (N, 2) [m].
        events: {"t", "kind", "text"}.
    """

    def __init__(self, info: RunInfo) -> None:
        self.info = info_of(info)
        self.rows: list[list[Any]] = []
        self.paths: list[dict[str, Any]] = []
        self._events = Events()
        self._events.start(info)
        self._room = _Room(info)
        self._path: Path | None = None
        self._line: _Line | None = None

    @property
    def events(self) -> list[dict[str, Any]]:
        """What happened so far."""
        return self._events.found

    def note(self, time: float, kind: str, text: str) -> None:
        """Add an event from outside, such as who took over the driving."""
        self._events.note(time, kind, text)

    def add(self, step: Step) -> None:
        """Add a step."""
        state = step.state
        if step.path is not self._path:
            self._path, self._line = step.path, None if step.path is None else _Line(step.path)
            if step.path is not None:
                self.paths.append(path_of(step.path, state.time))
        clearance = 0.0 if state.contacts else self._room.around(state.pose)
        off = None if self._line is None else self._line.distance(state.pose.x, state.pose.y)
        self.rows.append(row_of(step, clearance=clearance, cross_track=off))
        self._events.add(step)

    def end(self, episode: Episode) -> None:
        """Add the end."""
        self._events.end(episode)


def path_of(path: Path, time: float) -> dict[str, Any]:
    """A path that is followed from a time [s] on."""
    return {"t": round(time, 4), "points": pack_array(path.poses[:, :2], "f4")}


class _Room:
    """Distance from the footprint to solids, to within a cell, on the world's true map or else the first costmap."""

    def __init__(self, info: RunInfo) -> None:
        self._map: Costmap | None = info.costmap
        if info.world is not None:
            points = np.array([(end.x, end.y) for end in (info.start, *info.goals)])
            resolution = _RESOLUTION_M if info.costmap is None else info.costmap.resolution
            margin = CLEARANCE_CAP + info.robot.circumscribed_radius
            self._map = map_world(info.world, info.robot, points, resolution=resolution, margin=margin)

    def around(self, pose: Pose2D) -> float | None:
        """[m], at most 2 m; none where nothing is known."""
        if self._map is None:
            return None
        return float(self._map.clearance(np.array([pose.as_tuple()]), CLEARANCE_CAP)[0])


class _Line:
    """A path as a polyline of complex numbers, for distances from it."""

    def __init__(self, path: Path) -> None:
        corners = path.poses[:, 0] + 1j * path.poses[:, 1]
        self._starts = corners[:-1] if len(corners) > 1 else corners
        self._along = np.diff(corners) if len(corners) > 1 else np.zeros(1, dtype=np.complex128)
        squared = np.abs(self._along) ** 2
        self._share = np.conj(self._along) / np.where(squared > 0.0, squared, 1.0)

    def distance(self, x: float, y: float) -> float:
        """Distance [m] from a point."""
        offsets = complex(x, y) - self._starts
        shares = (offsets * self._share).real.clip(0.0, 1.0)
        return float(np.abs(offsets - shares * self._along).min())
