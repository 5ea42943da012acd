"""What the navigator publishes of its costmap: all of it, a window around the robot, and the outline."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from trundle.costmap import NO_INFORMATION, Costmap
from trundle.geometry import Pose2D
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
