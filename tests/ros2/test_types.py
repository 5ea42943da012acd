"""Types of the other side: learned from its text, made with ROS's defaults, without what its distribution lacks."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from trundle.errors import InputError, UnknownNameError
from trundle.messages import Codec
from trundle.ros2.types import Types

SEPARATOR = "\n" + "=" * 80 + "\nMSG: "


@dataclass
class OtherSide:
    """Of a transport: the texts of its types."""

    texts: dict[str, str] = field(default_factory=dict)
    asked: list[str] = field(default_factory=list)

    def definition(self, type_name: str) -> str:
        self.asked.append(type_name)
        return self.texts.get(type_name, "")


def make_types(**texts: str) -> Types:
    named = {name.replace("__", "/"): text for name, text in texts.items()}
    return Types(Codec("jazzy"), OtherSide(named))  # pyright: ignore[reportArgumentType]


def test_what_is_not_given_is_as_ros_makes_it() -> None:
    types = make_types()
    pose = types.make("geometry_msgs/msg/PoseWithCovarianceStamped")
    assert (pose.header.frame_id, pose.header.stamp.sec, pose.pose.pose.orientation.w) == ("", 0, 1.0)
    assert pose.pose.covariance.tolist() == [0.0] * 36
    again = types.decode("geometry_msgs/msg/PoseWithCovarianceStamped", types.encode(pose))
    assert again.pose.pose == pose.pose.pose
    marker = types.make("visualization_msgs/msg/Marker")
    assert (marker.points, marker.text, marker.frame_locked) == ([], "", False)
    other = types.make("geometry_msgs/msg/PoseWithCovarianceStamped")
    assert other.pose.covariance is not pose.pose.covariance


def test_lists_of_numbers_become_arrays_and_fields_that_are_missing_are_left_out() -> None:
    types = make_types()
    message = types.make("sensor_msgs/msg/JointState", name=["a"], position=[1, 2], temperature=[3.0])
    assert message.name == ["a"]
    assert message.position.dtype == np.float64
    assert types.has("sensor_msgs/msg/JointState", "position")
    assert not types.has("sensor_msgs/msg/JointState", "temperature")
    with pytest.raises(InputError, match="data of std_msgs/msg/UInt8MultiArray"):
        types.make("std_msgs/msg/UInt8MultiArray", data=[400])
    with pytest.raises(InputError, match="std_msgs/msg/String cannot be written"):
        types.encode(types.make("std_msgs/msg/String", data=4))


def test_parts_of_services_and_actions_are_learned_from_the_other_side() -> None:
    types = make_types(
        nav2_msgs__action__Spin_Goal="float32 target_yaw\nbuiltin_interfaces/Duration time_allowance"
        + SEPARATOR
        + "builtin_interfaces/Duration\nint32 sec\nuint32 nanosec",
        nav2_msgs__action__Spin_Result='int64 NONE=0\nint64 TIMEOUT=701\nstring WHY="so what"\nuint16 error_code',
        nav2_msgs__srv__Clear_Request="uint8 structure_needs_at_least_one_member",
    )
    goal = types.make("nav2_msgs/action/Spin_Goal", target_yaw=1.0, disable_collision_checks=True)
    assert types.encode(goal) == b"\0\1\0\0" + b"\0\0\x80\x3f" + bytes(8)
    assert types.constant("nav2_msgs/action/Spin_Result", "TIMEOUT") == 701
    assert types.constant("nav2_msgs/action/Spin_Result", "UNKNOWN", 7) == 7
    assert types.kind("nav2_msgs/action/Spin_Result").WHY == "so what"
    assert types.encode(types.make("nav2_msgs/srv/Clear_Request")) == b"\0\1\0\0\0"
    assert types.definition("nav2_msgs/action/Spin_Goal").startswith("float32 target_yaw\n")
    assert types.type_hash("nav2_msgs/action/Spin_Goal").startswith("RIHS01_")


def test_what_nobody_knows_is_asked_for_once() -> None:
    types = make_types()
    assert not types.knows("nav2_msgs/action/Spin_Goal")
    assert not types.has("nav2_msgs/action/Spin_Goal", "target_yaw")
    assert types.constant("nav2_msgs/action/Spin_Result", "TIMEOUT", 3) == 3
    with pytest.raises(UnknownNameError, match="nav2_msgs/action/Spin_Goal"):
        types.make("nav2_msgs/action/Spin_Goal")
    assert types._transport.asked == ["nav2_msgs/action/Spin_Goal", "nav2_msgs/action/Spin_Result"]  # pyright: ignore


def test_a_part_that_differs_from_the_distributions_is_refused() -> None:
    types = make_types(
        bad__msg__Names="std_msgs/String[] names" + SEPARATOR + "std_msgs/String\nint32 data",
        bad__msg__Text="float32[",
        bad__msg__Part="other_msgs/Unknown part",
    )
    with pytest.raises(InputError, match="std_msgs/msg/String of the other side is not that of jazzy"):
        types.make("bad/msg/Names")
    with pytest.raises(InputError, match="not the text of bad/msg/Text"):
        types.make("bad/msg/Text")
    with pytest.raises(InputError, match="bad/msg/Part: Type 'other_msgs/msg/Unknown' is unknown"):
        types.make("bad/msg/Part")
