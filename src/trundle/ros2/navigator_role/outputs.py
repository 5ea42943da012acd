"""What the navigator publishes besides costmap and pose: its map, its plan, and markers of its goals and rollouts."""

from __future__ import annotations

from typing import Any

import numpy as np

from trundle.control import Rollouts
from trundle.geometry import Goal
from trundle.maps import OccupancyGrid
from trundle.messages.qos import LATCHED, Qos
from trundle.mission import Step
from trundle.ros2.navigator_role.context import Kit
from trundle.ros2.outputs.output import Cadence

PLAN_PERIOD_S = 1.0
"""How often Nav2's behavior tree plans [s]."""

_MARKERS = "visualization_msgs/msg/MarkerArray"
_SHOWN, _SECTION = 30, 3
"""So many rollouts are shown, by every third pose: more lines cost bytes, and show nothing more."""

_ADD, _DELETE_ALL = 0, 3
_ARROW, _SPHERE, _LINES = 0, 2, 5
_GREEN, _RED, _BLUE = (0.1, 0.7, 0.2), (0.9, 0.1, 0.1), (0.2, 0.4, 0.9)


class MapOutput:
    """Publishes the map for whoever comes: once, or as often as it has grown where the localizer makes it.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        self._kit = kit
        self._outlet = kit.context.wire.outlet("map", "nav_msgs/msg/OccupancyGrid", LATCHED)
        self._written: OccupancyGrid | None = None

    def publish(self, step: Step, time: float) -> None:
        """Publish the map, if it was not yet, or has changed since."""
        grid = self._kit.beliefs.map
        before = self._written
        if grid is None or grid is before:
            return
        self._written = grid
        same = before is not None and (grid.shape, grid.origin) == (before.shape, before.origin)
        if before is None or not same or not np.array_equal(grid.data, before.data):
            self._outlet.write(self._kit.make.grid(time, grid, self._kit.map_frame))


class PlanOutput:
    """Publishes the path that is followed, when it changes and once a second.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        self._kit = kit
        self._outlet = kit.context.wire.outlet("plan", "nav_msgs/msg/Path", Qos(10))
        self._path: object = None
        self._cadence = Cadence(PLAN_PERIOD_S)

    def publish(self, step: Step, time: float) -> None:
        """Publish the path, if there is one and it is due."""
        path = step.path
        if path is None or not self._outlet.is_wanted:
            return
        if path is self._path and not self._cadence.is_due(time):
            return
        self._path = path
        self._cadence.mark(time)
        self._outlet.write(self._kit.make.path(time, path.poses, self._kit.map_frame))


class MarkerOutput:
    """Publishes markers: the goals that are left, and the controller's best rollouts.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        wire = kit.context.wire
        self._kit = kit
        self._goals = wire.outlet("waypoints", _MARKERS, LATCHED)
        self._rollouts = wire.outlet("trajectories", _MARKERS, Qos(1))
        self._shown: object = None

    @property
    def wants_rollouts(self) -> bool:
        """Whether somebody looks at the rollouts, which take the controller a tenth of its time."""
        return self._rollouts.is_wanted

    def publish(self, step: Step, time: float) -> None:
        """Publish the goals where they have changed, and the rollouts."""
        goals = () if step.steering is None else step.steering.goals[step.goal :]
        if step.status.value in ("arrived", "idle"):
            goals = ()
        if goals != self._shown:
            self._shown = goals
            self._goals.write(self._kit.types.make(_MARKERS, markers=self._goal_markers(time, goals)))
        if step.rollouts is not None and self._rollouts.is_wanted:
            self._rollouts.write(self._kit.types.make(_MARKERS, markers=[self._lines(time, step.rollouts)]))

    def _goal_markers(self, time: float, goals: tuple[Goal, ...]) -> list[Any]:
        """Make a marker that deletes those of before, and one for each goal."""
        found = [self._marker(time, 0, _ARROW, (0.0, 0.0, 0.0), _RED, action=_DELETE_ALL)]
        for number, goal in enumerate(goals):
            shape, size = (_SPHERE, (0.2, 0.2, 0.2)) if goal.yaw_free else (_ARROW, (0.4, 0.06, 0.06))
            color = _GREEN if number == len(goals) - 1 else _BLUE
            marker = self._marker(time, number, shape, size, color)
            marker.pose = self._kit.make.pose(goal.pose, 0.1)
            found.append(marker)
        return found

    def _lines(self, time: float, rollouts: Rollouts) -> Any:
        """Make a marker of lines; its points are both ends of every section of the rollouts."""
        poses, point = rollouts.poses[:_SHOWN, ::_SECTION], self._kit.types.kind("geometry_msgs/msg/Point")
        ends = np.stack([poses[:, :-1, :2], poses[:, 1:, :2]], axis=2).reshape(-1, 2)
        marker = self._marker(time, 0, _LINES, (0.01, 0.0, 0.0), _BLUE)
        marker.points = [point(x, y, 0.05) for x, y in ends.tolist()]
        return marker

    def _marker(
        self,
        time: float,
        number: int,
        shape: int,
        size: tuple[float, float, float],
        color: tuple[float, float, float],
        action: int = _ADD,
    ) -> Any:
        make = self._kit.types.make
        red, green, blue = color
        return make(
            "visualization_msgs/msg/Marker",
            header=self._kit.make.header(time, self._kit.map_frame),
            ns="trundle",
            id=number,
            type=shape,
            action=action,
            scale=make("geometry_msgs/msg/Vector3", x=size[0], y=size[1], z=size[2]),
            color=make("std_msgs/msg/ColorRGBA", r=red, g=green, b=blue, a=0.9),
        )
