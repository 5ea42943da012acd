"""Cyclone's types are those of the codec: it takes the codec's bytes and gives the same back."""

import numpy as np
import pytest

from ros2.random_messages import random_message
from ros2.transport.dds.conftest import Open, received, until
from trundle.errors import UnknownNameError
from trundle.messages import DISTROS, Codec, Distro, Qos
from trundle.ros2.transport.dds.mapping import IdlTypes

TYPES = (
    "builtin_interfaces/msg/Time",
    "diagnostic_msgs/msg/DiagnosticArray",
    "geometry_msgs/msg/PoseWithCovarianceStamped",
    "geometry_msgs/msg/TwistStamped",
    "nav_msgs/msg/OccupancyGrid",
    "nav_msgs/msg/Odometry",
    "nav_msgs/msg/Path",
    "rcl_interfaces/msg/ParameterEvent",
    "rosgraph_msgs/msg/Clock",
    "sensor_msgs/msg/CameraInfo",
    "sensor_msgs/msg/JointState",
    "sensor_msgs/msg/LaserScan",
    "sensor_msgs/msg/PointCloud2",
    "shape_msgs/msg/SolidPrimitive",
    "std_msgs/msg/ByteMultiArray",
    "std_msgs/msg/Empty",
    "std_msgs/msg/String",
    "tf2_msgs/msg/TFMessage",
    "visualization_msgs/msg/MarkerArray",
)


def test_messages_arrive_as_they_were_written_to_the_bit(open_node: Open) -> None:
    codec, rng = Codec("jazzy"), np.random.default_rng(1)
    ours, theirs = open_node(), open_node("theirs")
    for number, name in enumerate(TYPES):
        subscription = theirs.subscription(f"/t{number}", name, Qos())
        publisher = ours.publisher(f"/t{number}", name, Qos())
        until(lambda one=publisher: one.matched == 1, name)
        data = codec.encode(random_message(codec, name, rng))
        publisher.write(data)
        (sample,) = received(theirs, subscription, 1)
        assert sample.data == data, name


@pytest.mark.parametrize("distro", DISTROS)
def test_every_message_of_every_distribution_has_a_type(distro: Distro) -> None:
    codec = Codec(distro)
    idl = IdlTypes(codec)
    for name in TYPES:
        struct = idl.struct(name)
        assert struct.__idl__.idl_transformed_typename.replace("::", "/") == (name.replace("/msg/", "/msg/dds_/") + "_")
        assert idl.struct(name) is struct


def test_bounds_are_kept() -> None:
    codec = Codec()
    codec.register("a_msgs/msg/Bounded", "string<=3 text\nint32[<=2] few\nstring<=4[] names\n")
    fields = IdlTypes(codec).struct("a_msgs/msg/Bounded").__annotations__
    assert "3" in str(fields["text"])
    assert "2" in str(fields["few"])
    assert "4" in str(fields["names"])


def test_a_type_that_is_not_known_is_refused() -> None:
    with pytest.raises(UnknownNameError, match="LaserScam"):
        IdlTypes(Codec()).struct("sensor_msgs/msg/LaserScam")
