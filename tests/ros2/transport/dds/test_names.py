"""ROS's names in DDS."""

import pytest

from trundle.errors import InputError
from trundle.ros2.transport.dds.mapping import dds_topic, dds_type, ros_topic, ros_type


def test_names_go_there_and_back() -> None:
    assert dds_topic("/robot/scan") == "rt/robot/scan"
    assert ros_topic("rt/robot/scan") == "/robot/scan"
    assert ros_topic("rq/addRequest") == ""
    assert dds_type("nav_msgs/msg/OccupancyGrid") == "nav_msgs::msg::dds_::OccupancyGrid_"
    assert ros_type("nav_msgs::msg::dds_::OccupancyGrid_") == "nav_msgs/msg/OccupancyGrid"
    assert ros_type("nav2_msgs::action::dds_::Spin_SendGoal_Request_") == "nav2_msgs/action/Spin_SendGoal_Request"
    assert ros_type("HelloWorld") == "HelloWorld"


@pytest.mark.parametrize("topic", ["scan", "", "/", "/scan/", "/1scan", "/a b", "/a//b", "/a__b", "/ä", "/scan\n"])
def test_what_is_no_topic_is_refused(topic: str) -> None:
    with pytest.raises(InputError, match="topic"):
        dds_topic(topic)


@pytest.mark.parametrize("name", ["LaserScan", "sensor_msgs/LaserScan", "sensor_msgs/msg/laser", "a/msg/B::C", ""])
def test_what_is_no_type_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="type"):
        dds_type(name)
