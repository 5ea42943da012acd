"""`ContactOutput`: what the robot touches."""

from __future__ import annotations

from typing import Any

from trundle.geometry import Pose2D
from trundle.messages import MessageMaker
from trundle.messages.qos import Qos
from trundle.mission import Step
from trundle.ros2.role import BridgeContext
from trundle.sim import Contact

CONTACTS = Qos(10)

_SIZE_M = 0.1
_SPHERE, _ADD, _DELETE_ALL = 2, 0, 3


class ContactOutput:
    """Publishes contacts as visualization_msgs/MarkerArray, once in each control period with one, and once without.

    Each contact is a red sphere where it is, in the frame of the base: its namespace is the name of what is
    touched, its text the part of the robot. The first marker deletes those of before.

    Args:
        context: The bridge.
        topic: Its topic.
    """

    def __init__(self, context: BridgeContext, topic: str) -> None:
        wire = context.wire
        self._types = wire.types
        self._make = MessageMaker(wire.types.codec)
        self._outlet = wire.outlet(topic, "visualization_msgs/msg/MarkerArray", CONTACTS)
        self._frame = wire.names.frame(context.profile.frames.base)
        self._touched = False

    def publish(self, step: Step, time: float) -> None:
        """Publish the contacts of a control period."""
        contacts = step.state.contacts
        if not self._outlet.is_wanted or not (contacts or self._touched):
            return
        self._touched = bool(contacts)
        header = self._make.header(time, self._frame)
        markers = [self._marker(header, action=_DELETE_ALL)]
        markers += [self._sphere(header, number, contact, step.state.pose) for number, contact in enumerate(contacts)]
        self._outlet.write(self._types.make("visualization_msgs/msg/MarkerArray", markers=markers))

    def _sphere(self, header: Any, number: int, contact: Contact, robot: Pose2D) -> Any:
        make = self._types.make
        x, y = robot.inverse().transform_points([(contact.x, contact.y)])[0].tolist()
        point = make("geometry_msgs/msg/Point", x=x, y=y, z=_SIZE_M)
        upright = make("geometry_msgs/msg/Quaternion", x=0.0, y=0.0, z=0.0, w=1.0)
        return self._marker(
            header,
            action=_ADD,
            ns=contact.other,
            id=number,
            type=_SPHERE,
            text=contact.part,
            pose=make("geometry_msgs/msg/Pose", position=point, orientation=upright),
            scale=make("geometry_msgs/msg/Vector3", x=_SIZE_M, y=_SIZE_M, z=_SIZE_M),
            color=make("std_msgs/msg/ColorRGBA", r=1.0, g=0.1, b=0.1, a=1.0),
        )

    def _marker(self, header: Any, **fields: Any) -> Any:
        return self._types.make("visualization_msgs/msg/Marker", header=header, **fields)
