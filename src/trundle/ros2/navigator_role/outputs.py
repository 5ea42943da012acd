"""What the navigator publishes: its costmap and outline; its map, its plan, and markers of goals and rollouts."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from trundle.control import Rollouts
from trundle.costmap import NO_INFORMATION, Costmap
from trundle.geometry import Goal, Pose2D
from trundle.maps import OccupancyGrid
from trundle.messages.qos import LATCHED, Qos
from trundle.mission import Step
from trundle.ros2.navigator_role.context import Kit
from trundle.ros2.outputs.output import Cadence

GLOBAL_PERIOD_S, LOCAL_PERIOD_S = 1.0, 0.5
"""Nav2's publish_frequency of the costmaps."""

WINDOW_M = 3.0
"""Width and height of Nav2's local costmap by default [m]."""

_SAME_FRAME = Pose2D(0.0, 0.0)

_SAME_CELL = 1e-6
"""A middle that is on the edge of a cell but for rounding is in that cell [cells]."""

_DIGITS = 3
"""A correction of less than a millimetre or a milliradian is none: the window is not sent whole for it."""

_GRID, _UPDATE = "nav_msgs/msg/OccupancyGrid", "map_msgs/msg/OccupancyGridUpdate"


def local_window(
    costmap: Costmap, pose: Pose2D, T_map_odom: Pose2D = _SAME_FRAME, size: float = WINDOW_M
) -> tuple[npt.NDArray[np.uint8], Pose2D]:
    """Sample the costs in a square around a pose, aligned with the odom frame, and the pose of its lower left corner.

    Each cell has the cost of the costmap's cell that its middle is in; cells outside the costmap are unknown. The
    square moves by whole cells of the odom frame, as that of Nav2's local costmap.

    Args:
        costmap: The costmap.
        pose: Where the robot is, map frame.
        T_map_odom: Where the odom frame is on the map.
        size: Edge of the square [m].

    Returns:
        The costs, shape (cells, cells), and the pose of the corner in the odom frame.
    """
    step = costmap.resolution
    cells = max(1, round(size / step))
    here = T_map_odom.inverse() @ pose
    left, low = (math.floor(value / step) - cells // 2 for value in (here.x, here.y))
    middles = np.stack(np.meshgrid(np.arange(left, left + cells), np.arange(low, low + cells)), axis=-1) * step
    points = T_map_odom.transform_points(middles.reshape(-1, 2) + 0.5 * step)
    in_grid = costmap.origin.inverse().transform_points(points) / step
    cols, rows = np.floor(in_grid + _SAME_CELL).astype(np.intp).T
    inside = (rows >= 0) & (rows < costmap.shape[0]) & (cols >= 0) & (cols < costmap.shape[1])
    window = np.full(cells * cells, NO_INFORMATION, np.uint8)
    window[inside] = costmap.data[rows[inside], cols[inside]]
    return window.reshape(cells, cells), Pose2D(left * step, low * step)


_POLYGON = "geometry_msgs/msg/PolygonStamped"
_PERIOD_S = 0.2


class GlobalCostmapOutput:
    """Publishes the costmap, and its changes for those who have it.

    A whole costmap goes out when its frame changes and when somebody new reads it; then the rectangles that changed.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        wire = kit.context.wire
        self._kit = kit
        self._whole = wire.outlet("global_costmap/costmap", _GRID, LATCHED)
        self._updates = wire.outlet("global_costmap/costmap_updates", _UPDATE, Qos(10))
        self._version: object = None
        self._frame: object = None
        self._readers = 0
        self._cadence = Cadence(GLOBAL_PERIOD_S)

    def publish(self, step: Step, time: float) -> None:
        """Publish what changed, if it is due."""
        costmap = step.costmap
        if costmap is None or not self._cadence.is_due(time):
            return
        readers, frame = self._whole.readers, (costmap.shape, costmap.resolution, costmap.origin)
        is_new = frame != self._frame or readers > self._readers
        self._cadence.mark(time)
        self._readers = readers
        if not is_new and costmap.version is self._version:
            return
        windows = None if is_new else costmap.changes_since(self._version)
        if windows is not None and self._updates.is_wanted:
            for rows, cols in windows:
                self._updates.write(self._kit.make.costmap_update(time, costmap, rows, cols, self._kit.map_frame))
        elif windows is None or readers > 0 or self._kit.context.wire.record is not None:
            self._whole.write(self._kit.make.costmap(time, costmap, self._kit.map_frame))
        else:
            return
        self._version, self._frame = costmap.version, frame


class LocalCostmapOutput:
    """Publishes the part of the costmap around the robot, in the odom frame, as Nav2's local costmap is.

    Args:
        kit: What the navigator works with.
    """

    def __init__(self, kit: Kit) -> None:
        wire = kit.context.wire
        self._kit = kit
        self._odom = wire.names.frame(kit.context.profile.frames.odom)
        self._whole = wire.outlet("local_costmap/costmap", _GRID, LATCHED)
        self._updates = wire.outlet("local_costmap/costmap_updates", _UPDATE, Qos(10))
        self._cadence = Cadence(LOCAL_PERIOD_S)
        self._frame: object = None
        self._version: object = None
        self._readers = 0

    def publish(self, step: Step, time: float) -> None:
        """Publish it, if it is due: whole where the window has moved, else as an update."""
        costmap, kit = step.costmap, self._kit
        if costmap is None or not self._cadence.is_due(time):
            return
        self._cadence.mark(time)
        belief = kit.beliefs.now
        costs, origin = local_window(costmap, belief.pose, belief.map_odom)
        moved = tuple(round(number, _DIGITS) for number in belief.map_odom.as_tuple())
        frame, readers = (costs.shape, costmap.resolution, origin, moved), self._whole.readers
        if frame == self._frame and readers <= self._readers:
            if costmap.version is not self._version and self._updates.is_wanted:
                self._updates.write(self._update(costs, time))
                self._version = costmap.version
            elif costmap.version is not self._version:
                self._frame = None
            return
        self._frame, self._version, self._readers = frame, costmap.version, readers
        self._whole.write(kit.make.costs(time, costs, costmap.resolution, origin, self._odom))

    def _update(self, costs: Any, time: float) -> Any:
        kit = self._kit
        message = kit.make.costs(time, costs, 1.0, Pose2D(0.0, 0.0), self._odom)
        rows, cols = costs.shape
        return kit.types.make(_UPDATE, header=message.header, x=0, y=0, width=cols, height=rows, data=message.data)


class FootprintOutput:
    """Publishes the outline that a costmap is made with, in its frame; 5 times a second, as Nav2 updates a local one.

    Args:
        kit: What the navigator works with.
        costmap: The costmap that it belongs to.
    """

    def __init__(self, kit: Kit, costmap: Literal["global_costmap", "local_costmap"]) -> None:
        self._kit = kit
        context = kit.context
        self._outlet = context.wire.outlet(f"{costmap}/published_footprint", _POLYGON, Qos(1))
        self._is_local = costmap == "local_costmap"
        odom = context.wire.names.frame(context.profile.frames.odom)
        self._frame = odom if self._is_local else kit.map_frame
        self._cadence = Cadence(_PERIOD_S)

    def publish(self, step: Step, time: float) -> None:
        """Publish it, if somebody reads it and it is due."""
        if not self._outlet.is_wanted or not self._cadence.is_due(time):
            return
        self._cadence.mark(time)
        kit, make = self._kit, self._kit.types.make
        belief = kit.beliefs.now
        pose = belief.map_odom.inverse() @ belief.pose if self._is_local else belief.pose
        corners = pose.transform_points(kit.context.mission.navigator.robot.outline)
        points = [make("geometry_msgs/msg/Point32", x=x, y=y, z=0.0) for x, y in corners.tolist()]
        polygon = make("geometry_msgs/msg/Polygon", points=points)
        self._outlet.write(make(_POLYGON, header=kit.make.header(time, self._frame), polygon=polygon))


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
