"""`RunData`: an observer that keeps what a replay of a run needs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from trundle.costmap import Costmap
from trundle.mission.episode import Episode
from trundle.mission.observers import RunInfo, Step
from trundle.observation import Scan
from trundle.page.frames import frame_of
from trundle.page.maps import costmap_png
from trundle.page.run_lines import RunLines

MOST_ROWS = 36_000
"""Half an hour of control periods; of a longer run, every second row, every fourth, and so on."""

_MOST_FRAME_BYTES = 3_000_000
_MOST_COSTMAP_BYTES = 600_000
_FRAME_S = 0.2
_COSTMAP_S = 2.0


class RunData:
    """Keeps rows, paths, events, and thinned frames and costmaps of a run, within bounds whatever its length.

    Attributes:
        lines: The log of the run; None before its start.
    """

    wants_rollouts = True

    def __init__(self) -> None:
        self.lines: RunLines | None = None
        self._info: RunInfo | None = None
        self._frames = _Thinned(_FRAME_S, _MOST_FRAME_BYTES)
        self._costmaps = _Thinned(_COSTMAP_S, _MOST_COSTMAP_BYTES)
        self._shown: Costmap | None = None
        self._scans: dict[str, Scan] = {}

    def on_start(self, run: RunInfo) -> None:
        """Begin."""
        self.lines, self._info = RunLines(run), run

    def on_step(self, step: Step) -> None:
        """Keep a step."""
        if self.lines is None:
            return
        self.lines.add(step)
        for scan in step.scans:
            self._scans[scan.lidar] = scan
        time = step.state.time
        if self._frames.is_due(time) and (step.movers or self._scans or step.tracks or step.rollouts):
            frame = frame_of(step, scans=tuple(self._scans.values()))
            self._frames.add(time, frame, _weight(frame))
            self._scans.clear()
        if step.costmap is not None and step.costmap is not self._shown and self._costmaps.is_due(time):
            self._shown = step.costmap
            picture = {"t": round(time, 4), **costmap_png(step.costmap)}
            self._costmaps.add(time, picture, len(picture["png"]))

    def on_end(self, episode: Episode) -> None:
        """Add how it ended."""
        if self.lines is not None:
            self.lines.end(episode)

    def run_dict(self) -> dict[str, Any]:
        """{"info", "rows", "paths", "events", "frames", "costmaps"}; see `RunLines` and `frame_of`."""
        lines = self.lines
        if lines is None:
            return {"info": None, "rows": [], "paths": [], "events": [], "frames": [], "costmaps": []}
        step = -(-len(lines.rows) // MOST_ROWS) or 1
        last = [] if (len(lines.rows) - 1) % step == 0 else lines.rows[-1:]
        return {
            "info": lines.info,
            "rows": [*lines.rows[::step], *last],
            "paths": lines.paths,
            "events": lines.events,
            "frames": self._frames.kept,
            "costmaps": self._costmaps.kept,
        }


class _Thinned:
    """Items at times, of which every second one is dropped when they are too large together."""

    def __init__(self, period_s: float, most_bytes: int) -> None:
        self._period_s = period_s
        self._most = most_bytes
        self._items: list[tuple[float, Mapping[str, Any], int]] = []
        self._size = 0
        self._due = 0.0

    def is_due(self, time: float) -> bool:
        """Whether one is wanted now [s]."""
        return time >= self._due - 1e-9

    def add(self, time: float, item: Mapping[str, Any], size: int) -> None:
        """Keep one."""
        self._items.append((time, item, size))
        self._size += size
        while self._size > self._most and len(self._items) > 1:
            self._items = self._items[::2]
            self._size = sum(kept for _, _, kept in self._items)
            self._period_s *= 2.0
        self._due = time + self._period_s

    @property
    def kept(self) -> list[Mapping[str, Any]]:
        """Those that are left, in order."""
        return [item for _, item, _ in self._items]


def _weight(frame: Mapping[str, Any]) -> int:
    """About how many bytes a frame takes as JSON."""
    scans = sum(len(scan["points"]["b64"]) + 80 for scan in frame["scans"])
    rollouts = sum(12 * len(line) for line in frame["rollouts"])
    return 100 + scans + rollouts + 40 * (len(frame["movers"]) + len(frame["tracks"]) + len(frame["contacts"]))
