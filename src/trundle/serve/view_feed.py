"""`ViewFeed`: what pages are shown of a loop that is not trundle's."""

from __future__ import annotations

import time
import zlib
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass

from trundle import page
from trundle.costmap import Costmap
from trundle.geometry import FloatArray, Goal, Pose2D
from trundle.mission import LiveStatus
from trundle.observation import Estimate, Scan
from trundle.page.encoding import pack_array, rounded
from trundle.page.frames import belief_of, scan_of
from trundle.page.run_lines import goal_of
from trundle.robots import Robot
from trundle.serve.feed import Newest
from trundle.serve.page_messages import encode_items, encode_message
from trundle.serve.run_feed import COSTMAP_PERIOD_S, FRAME_PERIOD_S

MOST_ROWS = 10_000
"""Points of all trails together; where there are more, every second one of the older ones is left out."""

_APART_M = 0.1
"""A trail has a point after so much of the way: a loop may go on for days, and what stands still draws none."""


@dataclass(frozen=True, slots=True, eq=False)
class Shown:
    """All that one update left to be drawn; nothing changes it.

    Attributes:
        time: Wall time since the view was opened [s].
        poses: Pose of base_link of each robot by its name, map frame.
        paths: Path of each robot that has one [m], map frame, shape (N, 2).
        scans: Robot, scan, and the robot's pose at the update that gave it.
        costmap: The costmap, or None.
        text: The headline.
        goal: The goal that is marked, or None.
        belief: What the robot believes of its pose, or None.
    """

    time: float
    poses: Mapping[str, Pose2D]
    paths: Mapping[str, FloatArray]
    scans: tuple[tuple[str, Scan, Pose2D], ...]
    costmap: Costmap | None
    text: str
    goal: Goal | None
    belief: Estimate | None = None


class Trails:
    """Where the robots were, as rows [t, x, y, yaw, v, robot]; the older ones are thinned, so that it stays bounded."""

    def __init__(self) -> None:
        self._rows: list[str] = []
        self._first = 0  # number of the first row; thinning numbers all rows anew, after all numbers before

    def add(self, row: list[float | str]) -> None:
        """Add a row."""
        self._rows.append(encode_items([row]))
        if len(self._rows) > MOST_ROWS:
            self._first += len(self._rows)
            half = MOST_ROWS // 2
            self._rows = self._rows[:half:2] + self._rows[half:]

    def read(self, cursor: int) -> tuple[str, int] | None:
        """Return the `log` message for a client whose cursor is here; of rows that were thinned it gets all again."""
        end = self._first + len(self._rows)
        if cursor >= end:
            return None
        begin = max(0, cursor - self._first)
        rows = ",".join(self._rows[begin:])
        return f'{{"type":"log","from":{begin},"rows":[{rows}],"paths":[],"events":[]}}', end


class ViewFeed:
    """One loop as the pages get it. The loop's thread replaces what is shown; the server's thread encodes it.

    Args:
        scene: The `scene` message.
        robot: The robot.
        title: What the page calls the loop.

    Attributes:
        log: The trails.
        end: The `end` message, once the view is closed.
    """

    solids: tuple[str, ...] = ()
    is_behind = False

    def __init__(self, scene: str, robot: Robot, title: str) -> None:
        info = {"name": title, "robot": robot.name, "start": None, "goals": []}
        self.scene, self.run = scene, encode_message("run", info=info, n=0, orders=None)
        self.log = Trails()
        self.end: str | None = None
        self._shown: Shown | None = None
        self._passed: deque[list[float | str]] = deque()
        self._last: dict[str, tuple[float, Pose2D]] = {}
        self._frame, self._paths, self._costmap = Newest(), Newest(), Newest()
        self._framed: Shown | None = None
        self._drawn: Mapping[str, FloatArray] = {}
        self._framed_s = self._mapped_s = 0.0
        self._mapped: tuple[Costmap | None, int] = (None, 0)

    @property
    def newest(self) -> tuple[Newest, ...]:
        """The newest `frame`, `paths` and `costmap` messages."""
        return self._frame, self._paths, self._costmap

    # The thread of the loop -----------------------------------------------------------------------------------------

    def show(self, shown: Shown) -> None:
        """Draw this from now on."""
        for name, pose in shown.poses.items():
            before = self._last.get(name)
            way = 0.0 if before is None else pose.distance_to(before[1])
            if before is None or way >= _APART_M:
                speed = 0.0 if before is None else way / max(1e-3, shown.time - before[0])
                self._last[name] = shown.time, pose
                self._passed.append([*rounded((shown.time, *pose.as_tuple(), speed), 3), name])
        self._shown = shown

    # The server's thread --------------------------------------------------------------------------------------------

    def encode(self, status: LiveStatus, *, watched: bool) -> None:
        """Encode what is new: the trails always, the rest for clients alone."""
        while self._passed:
            self.log.add(self._passed.popleft())
        shown = self._shown
        if shown is None or not watched:
            return
        now = time.monotonic()
        if shown is not self._framed and now - self._framed_s >= FRAME_PERIOD_S:
            self._framed, self._framed_s = shown, now
            self._frame = self._frame.next(_frame_of(shown))
            if shown.paths is not self._drawn:
                self._drawn = shown.paths
                paths = {name: pack_array(points, "f4") for name, points in shown.paths.items()}
                self._paths = self._paths.next(encode_message("paths", paths=paths))
        if now - self._mapped_s >= COSTMAP_PERIOD_S:
            self._encode_costmap(shown.costmap, now)

    def _encode_costmap(self, costmap: Costmap | None, now: float) -> None:
        mapped, checksum = self._mapped
        if costmap is mapped:
            return
        # A loop may make a costmap at every step that is equal to the one before: comparing is cheaper than a picture.
        found = 0 if costmap is None else _checksum(costmap)
        self._mapped, self._mapped_s = (costmap, found), now
        if mapped is None or costmap is None or found != checksum:
            fields = {"png": None} if costmap is None else page.costmap_png(costmap)
            self._costmap = self._costmap.next(encode_message("costmap", **fields))


def _checksum(costmap: Costmap) -> int:
    extent = costmap.resolution, costmap.origin.as_tuple(), costmap.data.shape
    return zlib.crc32(costmap.data.tobytes(), zlib.crc32(repr(extent).encode()))


def _frame_of(shown: Shown) -> str:
    return encode_message(
        "frame",
        t=round(shown.time, 3),
        robots=[[name, *rounded(pose.as_tuple(), 3)] for name, pose in shown.poses.items()],
        scans=[scan_of(scan, pose) for _, scan, pose in shown.scans],
        text=shown.text,
        belief=None if shown.belief is None else belief_of(shown.belief),
        goals=[] if shown.goal is None else [goal_of(shown.goal)],
    )
