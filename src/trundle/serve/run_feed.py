"""`RunFeed`: what pages are shown of one run, or of a world without one; `Watch`: the observer that feeds it."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

from trundle import page
from trundle.costmap import Costmap
from trundle.errors import WorldError
from trundle.maps import OccupancyGrid
from trundle.mission import Episode, LiveStatus, Observer, OwnMap, RunInfo, Steering, SteeringReport, Step
from trundle.observation import Scan
from trundle.page import RunLines
from trundle.page.frames import own_map_of
from trundle.page.run_lines import goal_of
from trundle.page.scene import solid_instances
from trundle.robots import Robot
from trundle.serve.feed import Newest
from trundle.serve.hub import Hub
from trundle.serve.page_messages import encode, encode_items, encode_message
from trundle.worlds import World

FRAME_PERIOD_S = 0.0495
"""At most 20 frames in a second, at the server's ticks."""

COSTMAP_PERIOD_S = 0.5
"""A costmap is by far the largest message, and changes slowly: two in a second leave room for the frames."""

_MAP_PERIOD_S = 1.0
"""A robot draws its map once a second."""

_MOST_BYTES_PER_S = 400_000
"""Costmaps and maps that are larger than this per second come less often."""

_MOST_AT_ONCE = 200
"""Steps that are encoded at once, so that a run at full speed goes on in between."""

_BATCH_BYTES = 256 * 1024
"""A client that catches up gets messages of about this size."""


@dataclass(frozen=True, slots=True)
class _Chunk:
    first: int
    rows: str
    paths: str
    events: str

    def __len__(self) -> int:
        return len(self.rows) + len(self.paths) + len(self.events)


class RunLog:
    """Holds what a run has told so far, encoded once for all clients, each of which has a cursor in it."""

    def __init__(self) -> None:
        self._chunks: list[_Chunk] = []
        self._rows = 0

    def add(self, rows: Sequence[object], paths: Sequence[object], events: Sequence[object]) -> None:
        """Append what is new."""
        if rows or paths or events:
            self._chunks.append(_Chunk(self._rows, *map(encode_items, (rows, paths, events))))
            self._rows += len(rows)

    def read(self, cursor: int) -> tuple[str, int] | None:
        """Return the `log` message for a client whose cursor is here, and its next cursor; None if it has everything.

        Cursors start at 0. A page takes "from": 0 for the beginning of everything: a message that goes on before there
        are rows has none.
        """
        size, end = 0, cursor
        while end < len(self._chunks) and (end == cursor or size + len(self._chunks[end]) <= _BATCH_BYTES):
            size += len(self._chunks[end])
            end += 1
        if end == cursor:
            return None
        part = self._chunks[cursor:end]
        rows = ",".join(chunk.rows for chunk in part if chunk.rows)
        paths = ",".join(chunk.paths for chunk in part if chunk.paths)
        events = ",".join(chunk.events for chunk in part if chunk.events)
        first = f'"from":{part[0].first},' if cursor == 0 or part[0].first else ""
        text = f'{{"type":"log",{first}"rows":[{rows}],"paths":[{paths}],"events":[{events}]}}'
        return text, end


@dataclass(frozen=True, slots=True)
class Note:
    """An event that is not seen in the steps, such as a takeover.

    Attributes:
        time: Simulated time [s].
        text: What happened.
    """

    time: float
    text: str


_Item: TypeAlias = Step | Episode | Note


class RunFeed:
    """One run as the pages get it. The thread that runs it hands over what happens; the server's thread encodes it.

    The run only appends to lists and replaces references, so it never waits for the server or a client.

    Args:
        number: Number of the run, from 1; 0 if nothing has run.
        scene: The `scene` message.
        info: The start of the run; None if nothing runs.
        orders: Number that orders to the run carry; None if it takes no orders.

    Attributes:
        log: Rows, paths and events.
        solids: Messages of what was added to the world.
        end: The `end` message, once the run is over and recorded.
        frame: The newest `frame` message.
        costmap: The newest `costmap` message.
        map: The newest `map` message, of a robot that makes its map.
    """

    def __init__(self, number: int, scene: str, info: RunInfo | None = None, orders: int | None = None) -> None:
        self.number, self.scene = number, scene
        self._lines = None if info is None else RunLines(info)
        self.run = None
        if self._lines is not None:
            self.run = encode_message("run", info=self._lines.info, n=number, orders=orders)
        self.log = RunLog()
        self.solids: list[str] = []
        self.end: str | None = None
        self.frame, self.costmap, self.map = Newest(), Newest(), Newest()
        self._items: deque[_Item] = deque()
        self._taken = (0, 0, 0)
        self._step: Step | None = None
        self._scans: dict[str, Scan] = {}
        self._framed: tuple[Step | None, str, object] = (None, "", None)
        self._mapped: Costmap | None = None
        self._drawn: OccupancyGrid | None = None
        self._own: OwnMap | None = None
        self._mapped_due_s = self._drawn_due_s = self._framed_s = 0.0
        self._goals = () if info is None else info.goals

    # Any thread -----------------------------------------------------------------------------------------------------

    def add(self, item: Step | Episode | Note) -> None:
        """Add a step, the end, or another event."""
        self._items.append(item)

    @property
    def newest(self) -> tuple[Newest, ...]:
        """The newest `frame`, `map` and `costmap` messages."""
        return self.frame, self.map, self.costmap

    @property
    def is_behind(self) -> bool:
        """Whether something happened that is not in the log yet."""
        return bool(self._items)

    # The server's thread --------------------------------------------------------------------------------------------

    def encode(self, status: LiveStatus, *, watched: bool) -> None:
        """Encode what is new: the log always, so that it stays small; frames and costmaps for clients alone."""
        self._encode_log()
        step = self._step
        if step is None or not watched:
            return
        now = time.monotonic()
        if now - self._framed_s >= FRAME_PERIOD_S and self._framed != (framed := (step, status.state, status.steering)):
            self._framed, self._framed_s = framed, now
            self.frame = self.frame.next(self._encode_frame(step, status))
        costmap = step.costmap
        if costmap is not None and costmap is not self._mapped and now >= self._mapped_due_s:
            self._mapped = costmap
            self.costmap = self.costmap.next(encode_message("costmap", **page.costmap_png(costmap)))
            self._mapped_due_s = now + max(COSTMAP_PERIOD_S, len(self.costmap.text) / _MOST_BYTES_PER_S)
        self._encode_map(step, now)

    def _encode_map(self, step: Step, now: float) -> None:
        """Encode the map that the robot makes, if it is due; the one of the end in any case."""
        own = self._own
        grid, track = (step.map, step.map_track) if own is None else (own.grid, own.track)
        if grid is None or grid is self._drawn or (own is None and now < self._drawn_due_s):
            return
        self._drawn = grid
        self.map = self.map.next(encode_message("map", **own_map_of(grid, track)))
        self._drawn_due_s = now + max(_MAP_PERIOD_S, len(self.map.text) / _MOST_BYTES_PER_S)

    def _encode_log(self) -> None:
        lines = self._lines
        if lines is None:
            return
        for _ in range(min(len(self._items), _MOST_AT_ONCE)):
            item = self._items[0]
            if isinstance(item, Step):
                lines.add(item)
                self._step = item
                self._scans |= {scan.lidar: scan for scan in item.scans}
            elif isinstance(item, Episode):
                lines.end(item)
                self._own = item.own_map
            else:
                lines.note(item.time, "steer", item.text)
            self._items.popleft()
        rows, paths, events = self._taken
        self._taken = len(lines.rows), len(lines.paths), len(lines.events)
        self.log.add(lines.rows[rows:], lines.paths[paths:], lines.events[events:])

    def _encode_frame(self, step: Step, status: LiveStatus) -> str:
        lines, steering = self._lines, status.steering
        fields: dict[str, Any] = {
            "row": None if lines is None else lines.rows[-1],
            "factor": round(status.factor, 3),
            "speed": "max" if status.speed == math.inf else status.speed,
            "paused": status.state == "paused",
            "waiting": status.state == "waiting",
            "manual": None if steering is None or steering.manual is None else page_number(steering.by),
            "held_back": None if steering is None else steering.held_back or None,
            "goals": self._goals_ahead(step, steering),
        }
        return encode({"type": "frame", **page.frame_of(step, scans=tuple(self._scans.values())), **fields})

    def _goals_ahead(self, step: Step, steering: SteeringReport | None) -> list[Any]:
        """Return the goal that the robot drives to and those after it, as [x, y, yaw]."""
        goals = self._goals if steering is None else steering.goals
        return [goal_of(goal) for goal in goals[step.goal :]]


def page_name(client: int) -> str:
    """Return the name of a page as the giver of a directive, for the record."""
    return f"page {client}"


def page_number(name: str) -> int | None:
    """Return the client that `page_name` names, or None for other names."""
    number = name.removeprefix("page ")
    return int(number) if number != name and number.isdigit() else None


def scene_message(world: World | None, robot: Robot, grid: OccupancyGrid | None) -> tuple[str, str]:
    """Return the `scene` message, and a remark for people: why it shows the map alone, what it leaves out, or ""."""
    try:
        scene = page.scene_of(world, robot, grid)
    except WorldError as error:
        scene = page.scene_of(None, robot, grid)
        return encode_message("scene", scene=scene), f"the page shows the map alone: {error}"
    return encode_message("scene", scene=scene), scene["note"]


REPORT = "report.html"


class Watch:
    """Shows one run to the pages; it takes next to no time of the run's thread.

    Args:
        hub: Where the pages are.
        number: Number of the run, from 1.
        folder: Where the run is recorded, so that pages get its files; None if it is not recorded.
        world: The simulated world now, with what was added to it.
        steering: The steering through which pages steer it; None if they cannot.
    """

    def __init__(
        self,
        hub: Hub,
        number: int,
        folder: Path | None,
        *,
        world: Callable[[], World | None] | None = None,
        steering: Steering | None = None,
    ) -> None:
        self._hub, self._number, self._folder, self._world, self._steering = hub, number, folder, world, steering
        self._feed: RunFeed | None = None
        self._solids = 0

    @property
    def wants_rollouts(self) -> bool:
        """Whether a page shows the samples of the controller."""
        return len(self._hub) > 0

    def on_start(self, run: RunInfo) -> None:
        """Show the world and the start."""
        self._solids = 0 if run.world is None else len(run.world.solids)
        scene, remark = scene_message(run.world, run.robot, run.grid)
        if remark:
            self._hub.announce(remark)
        if self._folder is not None:
            self._hub.folders[self._number] = self._folder.resolve()
        orders = None if self._steering is None else self._steering.run
        self._feed = RunFeed(self._number, scene, run, orders)
        self._hub.present(self._feed)

    def on_step(self, step: Step) -> None:
        """Hand over the step, and what was added to the world."""
        feed = self._feed
        if feed is None:
            return
        if step.steering is not None and step.steering.boxes > len(feed.solids):
            self._add_solids(feed)
        feed.add(step)

    def on_end(self, episode: Episode) -> None:
        """Hand over the end; the outcome is shown once it is `recorded`."""
        if self._feed is not None:
            self._feed.add(episode)

    @property
    def recorded(self) -> Observer:
        """The observer to be notified after those that write the folder: it shows the outcome, with its files."""
        return _Recorded(self._tell_end)

    def _tell_end(self, episode: Episode) -> None:
        feed, folder = self._feed, self._folder
        if feed is None:
            return
        has_report = folder is not None and (folder / REPORT).is_file()
        feed.end = encode_message(
            "end",
            outcome=episode.outcome.value,
            message=episode.message,
            folder=None if folder is None else str(folder),
            files=None if folder is None else f"/runs/{self._number}/",
            replay=f"/runs/{self._number}/{REPORT}" if has_report else None,
        )

    def _add_solids(self, feed: RunFeed) -> None:
        world = None if self._world is None else self._world()
        if world is None:
            return
        for solid in world.solids[self._solids :]:
            feed.solids.append(encode_message("solid", instances=solid_instances([solid])))
        self._solids = len(world.solids)


class _Recorded:
    """An observer that calls a function when the run ends."""

    def __init__(self, tell: Callable[[Episode], None]) -> None:
        self._tell = tell

    def on_start(self, run: RunInfo) -> None:
        """Do nothing."""

    def on_step(self, step: Step) -> None:
        """Do nothing."""

    def on_end(self, episode: Episode) -> None:
        """Call back."""
        self._tell(episode)
