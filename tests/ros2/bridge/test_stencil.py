"""Messages that are written by changing the bytes of one are those that are made."""

import numpy as np
import pytest

from trundle.geometry import Pose2D, Twist2D
from trundle.messages import Codec, MessageMaker
from trundle.ros2.outputs.output import Stencil, mark, mark_stamp


@pytest.fixture(scope="module", params=["humble", "jazzy", "kilted", "lyrical"])
def codec(request):
    return Codec(request.param)


def test_a_stamp_and_numbers_are_replaced(codec):
    make = MessageMaker(codec)
    message = make.odometry(0.0, "odom", "base_link", Pose2D(0.0, 0.0), Twist2D())
    mark_stamp(message.header.stamp)
    place, turn = message.pose.pose.position, message.pose.pose.orientation
    place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w = mark(0, 7).tolist()
    stencil = Stencil(codec.encode(message), (7,))
    for time, pose in ((1.25, Pose2D(1.0, -2.0, 0.5)), (4000.000001, Pose2D(-1e3, 2.0, -3.0))):
        made = make.odometry(time, "odom", "base_link", pose, Twist2D())
        turn = made.pose.pose.orientation
        assert stencil.fill(time, (pose.x, pose.y, 0.0, 0.0, 0.0, turn.z, turn.w)) == codec.encode(made)


def test_an_array_in_it_is_filled_in_place(codec):
    make = MessageMaker(codec)
    ranges = np.arange(1.0, 6.0, dtype=np.float32)
    message = codec.make(
        "sensor_msgs/msg/LaserScan",
        header=make.header(0.0, "lidar"),
        angle_min=0.0,
        angle_max=1.0,
        angle_increment=0.25,
        time_increment=0.0,
        scan_time=0.1,
        range_min=0.05,
        range_max=12.0,
        ranges=ranges * -7e7,
        intensities=np.zeros(0, dtype=np.float32),
    )
    mark_stamp(message.header.stamp)
    stencil = Stencil(codec.encode(message))
    array = stencil.array(message.ranges.tobytes(), "<f4", 5)
    array[:] = ranges
    message.header, message.ranges = make.header(2.5, "lidar"), ranges
    assert stencil.fill(2.5) == codec.encode(message)


def test_a_message_without_its_marks_is_refused():
    with pytest.raises(ValueError, match="exactly once"):
        Stencil(bytes(40))
