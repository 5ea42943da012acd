"""`FootprintOutput`: the robot's outline where it believes to be, as each of Nav2's costmaps publishes it."""

from __future__ import annotations

from typing import Literal

from trundle.messages.qos import Qos
from trundle.mission import Step
from trundle.ros2.navigation.actions.parts import Kit
from trundle.ros2.outputs.cadence import Cadence

_POLYGON = "geometry_msgs/msg/PolygonStamped"
_PERIOD_S = 0.2


class FootprintOutput:
    """Publishes the outline that a costmap is made with, map frame; 5 times a second, as Nav2 updates a local costmap.

    Args:
        kit: What the navigator works with.
        costmap: Of which costmap.
    """

    def __init__(self, kit: Kit, costmap: Literal["global_costmap", "local_costmap"]) -> None:
        self._kit = kit
        self._outlet = kit.context.wire.outlet(f"{costmap}/published_footprint", _POLYGON, Qos(1))
        self._cadence = Cadence(_PERIOD_S)

    def publish(self, step: Step, time: float) -> None:
        """Publish it, if somebody reads it and it is due."""
        if not self._outlet.is_wanted or not self._cadence.is_due(time):
            return
        self._cadence.mark(time)
        kit, make = self._kit, self._kit.types.make
        corners = kit.beliefs.now.pose.transform_points(kit.context.mission.navigator.robot.outline)
        points = [make("geometry_msgs/msg/Point32", x=x, y=y, z=0.0) for x, y in corners.tolist()]
        polygon = make("geometry_msgs/msg/Polygon", points=points)
        self._outlet.write(make(_POLYGON, header=kit.make.header(time, kit.map_frame), polygon=polygon))
