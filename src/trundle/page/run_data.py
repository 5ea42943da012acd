"""`RunData`: an observer that keeps what a replay of a run needs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Generic, TypeVar

import numpy as np

from trundle.costmap import Costmap
from trundle.mission.episode import Episode
from trundle.mission.observers import RunInfo, Step
from trundle.mission.steering.directives import DropBox
from trundle.observation import Scan
from trundle.page.encoding import costmap_png, unpack_array
from trundle.page.frames import frame_of
from trundle.page.run_lines import RunLines
from trundle.page.scene import solid_instances

MOST_ROWS = 36_000
"""Half an hour of control periods; of a longer run, every second row, every fourth, and so on."""

# A report is one file that a browser loads at once: these bounds keep a run of a minute at some 1.5 MB, and a run of
# any length at a few. Frames and costmaps are thinned to stay within them.
_MOST_FRAME_BYTES = 3_000_000
_MOST_COSTMAP_BYTES = 300_000
_MOST_CELLS = 30_000_000
"""Cells of all costmaps that are kept in memory until the end, a byte each."""

_FRAME_S = 0.2
_COSTMAP_S = 2.0
_MOST_CONTACTS = 200
_MOST_PARTICLES = 150
"""Particles of a kept frame: enough to show how far they spread."""

_APART_CM = 8
"""Points of a kept scan nearer to the one before are left out: twice the distance of live frames, to save space."""

_LISTS = ("rows", "paths", "events", "frames", "costmaps", "contacts", "solids")


_Item = TypeVar("_Item")


class RunData:
    """Keeps rows, paths, events, and thinned frames and costmaps of a run, within bounds whatever its length.

    Attributes:
        lines: The log of the run; None before its start.
    """

    wants_rollouts = True

    def __init__(self) -> None:
        self.lines: RunLines | None = None
        self._frames: _Thinned[dict[str, Any]] = _Thinned(_FRAME_S, _MOST_FRAME_BYTES)
        self._costmaps: _Thinned[Costmap] = _Thinned(_COSTMAP_S, _MOST_CELLS)
        self._shown: Costmap | None = None
        self._scans: dict[str, Scan] = {}
        self._contacts: list[dict[str, Any]] = []
        self._dropped: list[dict[str, Any]] = []
        self._touching: frozenset[str] = frozenset()

    def on_start(self, run: RunInfo) -> None:
        """Begin."""
        self.lines = RunLines(run)

    def on_step(self, step: Step) -> None:
        """Keep a step."""
        if self.lines is None:
            return
        self.lines.add(step)
        self._add_contacts(step)
        for scan in step.scans:
            self._scans[scan.lidar] = scan
        time = step.state.time
        if self._frames.is_due(time) and self._has_something(step):
            frame = frame_of(step, scans=tuple(self._scans.values()), most_particles=_MOST_PARTICLES)
            frame["scans"] = [_compact(scan) for scan in frame["scans"]]
            self._frames.add(time, frame, _weight(frame))
            self._scans.clear()
        if step.costmap is not None and step.costmap is not self._shown and self._costmaps.is_due(time):
            self._shown = step.costmap
            self._costmaps.add(time, step.costmap, step.costmap.data.size)

    def on_end(self, episode: Episode) -> None:
        """Add how it ended."""
        if self.lines is not None:
            self.lines.end(episode)
            self._dropped = dropped_boxes(episode)

    def run_dict(self) -> dict[str, Any]:
        """Return {"info", "rows", "paths", "events", "frames", "costmaps", "contacts", "solids"}.

        See `RunLines` and `frame_of`.
        """
        lines = self.lines
        if lines is None:
            return {"info": None, **{name: [] for name in _LISTS}}
        step = -(-len(lines.rows) // MOST_ROWS) or 1
        last = [] if (len(lines.rows) - 1) % step == 0 else lines.rows[-1:]
        return {
            "info": lines.info,
            "rows": [*lines.rows[::step], *last],
            "paths": lines.paths,
            "events": lines.events,
            "frames": [frame for _, frame in self._frames.kept],
            "costmaps": encode_costmaps(self._costmaps.kept, _MOST_COSTMAP_BYTES),
            "contacts": self._contacts,
            "solids": self._dropped,
        }

    def _has_something(self, step: Step) -> bool:
        """Return whether a frame of the step would show something around the robot, or what a localizer believes."""
        believes = step.estimate is not None and step.estimate.pose is not step.state.pose
        return bool(step.movers or self._scans or step.tracks or step.rollouts or believes)

    def _add_contacts(self, step: Step) -> None:
        """Keep where a touch begins."""
        touched = frozenset(contact.other for contact in step.state.contacts)
        for contact in step.state.contacts:
            if contact.other not in self._touching and len(self._contacts) < _MOST_CONTACTS:
                self._touching |= {contact.other}
                what = f"{contact.part} touches {contact.other}"
                x, y = round(contact.x, 3), round(contact.y, 3)
                self._contacts.append({"t": round(step.state.time, 4), "what": what, "x": x, "y": y})
        self._touching = touched


def encode_costmaps(costmaps: Sequence[tuple[float, Costmap]], most_bytes: int) -> list[dict[str, Any]]:
    """Return costmaps at times as {"t", …} of `costmap_png`; of too many, every second one.

    One of the same extent as one before, "base" in the list, has as its picture what the costs are above those of the
    base, modulo 256.
    """
    while True:
        found = [{"t": round(time, 4), **picture} for time, picture in _encode_in_turn(costmaps)]
        if len(found) < 2 or sum(len(one["png"]) for one in found) <= most_bytes:
            return found
        costmaps = costmaps[::2]


def _encode_in_turn(costmaps: Sequence[tuple[float, Costmap]]) -> Iterator[tuple[float, dict[str, Any]]]:
    base, at = None, 0
    for index, (time, costmap) in enumerate(costmaps):
        if base is None or (costmap.shape, costmap.resolution, costmap.origin) != (
            base.shape,
            base.resolution,
            base.origin,
        ):
            base, at = costmap, index
            yield time, costmap_png(costmap)
        else:
            yield time, {**costmap_png(costmap, base=base), "base": at}


def dropped_boxes(episode: Episode) -> list[dict[str, Any]]:
    """Return {"t", "instances"} of each box that was dropped into a run."""
    return [
        {"t": round(given.time, 4), "instances": solid_instances([given.directive.solid("box")])}
        for given in episode.directives
        if isinstance(given.directive, DropBox) and not given.refused
    ]


def _compact(scan: Mapping[str, Any]) -> dict[str, Any]:
    """Return a scan of a frame with "deltas", the differences from point to point [cm], instead of its points."""
    points = unpack_array(scan["points"]).astype(np.int64)
    cells = points // _APART_CM
    kept = np.ones(len(points), dtype=np.bool_)
    kept[1:] = (cells[1:] != cells[:-1]).any(axis=1)
    deltas = np.diff(points[kept], axis=0, prepend=np.zeros((1, 2), dtype=np.int64))
    return {"name": scan["name"], "pose": scan["pose"], "deltas": deltas.ravel().tolist()}


class _Thinned(Generic[_Item]):
    """Items at times, of which every second one is dropped when they are too large together."""

    def __init__(self, period_s: float, most_bytes: int) -> None:
        self._period_s = period_s
        self._most = most_bytes
        self._items: list[tuple[float, _Item, int]] = []
        self._size = 0
        self._due = 0.0

    def is_due(self, time: float) -> bool:
        """Return whether an item is wanted at this time [s]."""
        return time >= self._due - 1e-9

    def add(self, time: float, item: _Item, size: int) -> None:
        """Keep an item of a size."""
        self._items.append((time, item, size))
        self._size += size
        while self._size > self._most and len(self._items) > 1:
            self._items = self._items[::2]
            self._size = sum(kept for _, _, kept in self._items)
            self._period_s *= 2.0
        self._due = time + self._period_s

    @property
    def kept(self) -> list[tuple[float, _Item]]:
        """The items that are left, in order, each with its time [s]."""
        return [(time, item) for time, item, _ in self._items]


def _weight(frame: Mapping[str, Any]) -> int:
    """Estimate how many bytes a frame takes as JSON."""
    scans = sum(3 * len(scan["deltas"]) + 80 for scan in frame["scans"])
    rollouts = sum(12 * len(line) for line in frame["rollouts"])
    small = 40 * (len(frame["movers"]) + len(frame["tracks"]) + len(frame["contacts"]))
    return 100 + scans + rollouts + small + _weight_of_belief(frame["belief"])


def _weight_of_belief(belief: Mapping[str, Any] | None) -> int:
    if belief is None:
        return 0
    particles = 0 if belief["particles"] is None else len(belief["particles"]["b64"])
    return 150 + particles + 30 * len(belief["places"])
