"""`Surroundings`: what a navigator makes of scans, for a controller that looks farther than along its path."""

from __future__ import annotations

from collections.abc import Sequence

from trundle.costmap import Costmap
from trundle.costmap.layers import LayersSettings
from trundle.geometry import Goal, Pose2D
from trundle.navigation import Navigator
from trundle.navigation.obstacle_watch import MoverMemory
from trundle.navigation.sensing import SensedMap, SensedTracks, make_placer
from trundle.observation import Estimate, Scan, Track


class Surroundings:
    """The costmap and the tracks of one drive, as the navigator has them.

    Args:
        navigator: The navigator, which drives on its map alone.
        layers: How scans are put into the costmap; None where that surely changes nothing.
        goal: Where it drives to.

    Attributes:
        costmap: The latest.
        tracks: What moves, predicted to now, map frame.
    """

    def __init__(self, navigator: Navigator, layers: LayersSettings | None, goal: Goal | None) -> None:
        self.costmap: Costmap = navigator.costmap
        self.tracks: tuple[Track, ...] = ()
        self._map = None if layers is None else SensedMap(self.costmap, navigator.robot, costmap=None, layers=layers)
        self._tracked = SensedTracks(navigator.robot, None, warn=False)
        self._placer = make_placer(navigator.robot, False if layers is None else layers, None)
        self._movers, self._goal = MoverMemory(), goal

    def take(self, scans: Sequence[Scan], time: float, pose: Pose2D) -> None:
        """Note the scans that arrived up to now [s], and where the robot is."""
        placed = self._placer.place(scans, Estimate(time, pose))
        if self._map is not None:
            self._map.update(placed, self._goal, self._movers.recent)
            self.costmap = self._map.costmap
        self.tracks = self._tracked.update(placed)
        self._movers.note(self.tracks, time)
