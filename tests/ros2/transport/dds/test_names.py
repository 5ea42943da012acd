"""ROS's names in DDS."""

import pytest

from trundle.errors import InputError
from trundle.ros2.transport.dds import names


def test_names_go_there_and_back() -> None:
    assert names.dds_topic("/robot/scan") == "rt/robot/scan"
    assert names.ros_topic("rt/robot/scan") == "/robot/scan"
    assert names.ros_topic("rq/addRequest") == ""
    assert names.dds_type("nav_msgs/msg/OccupancyGrid") == "nav_msgs::msg::dds_::OccupancyGrid_"
    assert names.ros_type("nav_msgs::msg::dds_::OccupancyGrid_") == "nav_msgs/msg/OccupancyGrid"
    assert names.ros_type("nav2_msgs::action::dds_::Spin_SendGoal_Request_") == "nav2_msgs/action/Spin_SendGoal_Request"
    assert names.ros_type("HelloWorld") == "HelloWorld"


@pytest.mark.parametrize("topic", ["scan", "", "/", "/scan/", "/1scan", "/a b", "/a//b", "/a__b", "/ä", "/scan\n"])
def test_what_is_no_topic_is_refused(topic: str) -> None:
    with pytest.raises(InputError, match="topic"):
        names.dds_topic(topic)


@pytest.mark.parametrize("name", ["LaserScan", "sensor_msgs/LaserScan", "sensor_msgs/msg/laser", "a/msg/B::C", ""])
def test_what_is_no_type_is_refused(name: str) -> None:
    with pytest.raises(InputError, match="type"):
        names.dds_type(name)
