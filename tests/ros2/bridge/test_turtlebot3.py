"""A TurtleBot3 as ROBOTIS's programs expect it, and Nova Carter's scans."""

from __future__ import annotations

import math
import time

import numpy as np
import pytest

from ros2.bridge.conftest import LATCHED, wait_for
from trundle.errors import InputError
from trundle.geometry import Pose2D
from trundle.ros2.profile import Profile

TF, SCAN = "tf2_msgs/msg/TFMessage", "sensor_msgs/msg/LaserScan"
IMU, BATTERY = "sensor_msgs/msg/Imu", "sensor_msgs/msg/BatteryState"
JOINTS, ODOM = "sensor_msgs/msg/JointState", "nav_msgs/msg/Odometry"


def seconds(stamp):
    return stamp.sec + stamp.nanosec * 1e-9


@pytest.fixture
def burger(serve):
    """A TurtleBot3 at the origin that looks along x."""

    def burger(**options):
        scenario = {"robot": "turtlebot3_waffle", "start": (0.0, 0.0, 0.0), **options.pop("scenario", {})}
        return serve(profile="turtlebot3", scenario=scenario, speed=5.0, **options)

    return burger


def test_beams_go_from_the_front_once_around(burger, peer):
    peer.read("/scan", SCAN)
    served = burger(scenario={"world": {"name": "lot"}})
    wait_for(lambda: peer.got("/scan"))
    scan = peer.got("/scan")[-1]
    assert scan.header.frame_id == "base_scan"
    assert scan.angle_min == pytest.approx(0.0, abs=1e-5)
    assert scan.angle_max == pytest.approx(math.radians(359.0), abs=1e-4)
    assert scan.angle_increment == pytest.approx(math.radians(1.0), abs=1e-6)
    step = wait_for(lambda: served.bridge.context.session)
    seen = next(iter(step.state.scans), None)
    if seen is not None and seen.time == seconds(scan.header.stamp):
        assert scan.ranges == pytest.approx(np.roll(seen.ranges, -180).astype(np.float32))


def test_what_is_in_front_is_in_beam_0_and_what_is_left_in_beam_90(burger, peer, tmp_path):
    from trundle.maps import OccupancyGrid

    data = np.zeros((160, 160), np.int8)
    data[:, 110] = 100  # x = 1.5 m, in front
    data[140, :] = 100  # y = 3 m, on the left
    OccupancyGrid(data, 0.05, Pose2D(-4.0, -4.0)).save(tmp_path / "map.yaml")
    peer.read("/scan", SCAN)
    settings = {"world": None, "map": str(tmp_path / "map.yaml")}
    burger(scenario=settings)
    wait_for(lambda: peer.got("/scan"))
    ranges = peer.got("/scan")[-1].ranges
    assert ranges[0] == pytest.approx(1.5 + 0.064, abs=0.1)
    assert ranges[90] == pytest.approx(3.0, abs=0.1)
    assert ranges[180] > 3.4


def test_a_lidar_that_sees_half_of_its_surroundings_has_no_first_beam(serve):
    profile = Profile.model_validate({"sensors": {"front": {"scan": "scan", "first_beam": 0.0}}})
    with pytest.raises(InputError, match="first_beam of the lidar 'front' is for one that sees all around"):
        serve(start=False, profile=profile, scenario={"robot": "jackal"})


def test_frames_come_where_no_robot_state_publisher_is(burger, peer):
    peer.read("/tf_static", TF, LATCHED)
    peer.read("/tf", TF)
    burger()
    wait_for(lambda: peer.got("/tf_static"))
    (message,) = peer.got("/tf_static")
    frames = {one.child_frame_id: (one.header.frame_id, one.transform.translation) for one in message.transforms}
    assert {name: parent for name, (parent, _) in frames.items()} == {
        "base_link": "base_footprint",
        "imu_link": "base_link",
        "base_scan": "base_link",
    }
    at = frames["base_scan"][1]
    assert (at.x, at.z) == pytest.approx((-0.064, 0.121))
    wheels = wait_for(
        lambda: [m.transforms for m in peer.got("/tf") if m.transforms[0].child_frame_id.startswith("wheel")]
    )
    assert [one.child_frame_id for one in wheels[0]] == ["wheel_left_link", "wheel_right_link"]
    left = wheels[0][0].transform.translation
    assert (left.x, left.y, left.z) == pytest.approx((0.0, 0.1435, 0.023))


def test_a_robot_state_publisher_keeps_its_frames(burger, peer, types):
    peer.read("/joint_states", JOINTS)  # as it does
    peer.read("/tf", TF)
    frame = types.make("geometry_msgs/msg/TransformStamped", child_frame_id="base_scan")
    frame.header.frame_id = "base_link"
    peer.transport.publisher("/tf", TF, LATCHED)
    peer.transport.publisher("/tf_static", TF, LATCHED).write(types.encode(types.make(TF, transforms=[frame])))
    served = burger()
    outputs = served.bridge._outputs
    wait_for(lambda: outputs.static_frames.published)
    time.sleep(1.5)
    assert outputs.static_frames.published == ("base_link", "imu_link")
    assert not [m for m in peer.got("/tf") if m.transforms[0].child_frame_id.startswith("wheel")]


def test_static_frames_never_publishes_none(burger, peer):
    peer.read("/tf_static", TF, LATCHED)
    served = burger(static_frames="never")
    time.sleep(0.3)
    assert served.bridge._outputs.static_frames.published == ()
    assert not peer.got("/tf_static")


def test_the_imu_measures_turn_rate_and_acceleration(burger, peer):
    peer.read("/imu", IMU)
    burger()
    wait_for(lambda: peer.got("/imu"))
    peer.send("/cmd_vel", peer.twist(0.2, 0.5))
    wait_for(lambda: peer.got("/imu")[-1].angular_velocity.z > 0.45)
    messages = peer.got("/imu")
    assert messages[-1].header.frame_id == "imu_link"
    assert messages[-1].linear_acceleration.z == pytest.approx(9.81)
    assert max(one.linear_acceleration.x for one in messages) == pytest.approx(2.5, rel=0.1)
    assert messages[-1].angular_velocity_covariance[0] > 0.0


def test_nothing_is_claimed_of_the_battery(burger, peer):
    peer.read("/battery_state", BATTERY)
    burger()
    battery = wait_for(lambda: peer.got("/battery_state"))[0]
    assert math.isnan(battery.percentage)
    assert math.isnan(battery.voltage)
    assert battery.power_supply_status == 0
    assert battery.location == "not simulated"


def test_commands_with_wall_time_are_obeyed_with_one_warning(burger, peer):
    peer.read("/odom", ODOM)
    served = burger()
    wait_for(lambda: peer.got("/odom"))
    for _ in range(3):
        peer.send("/cmd_vel", peer.stamped_twist(0.2, stamp=time.time()))
    wait_for(lambda: peer.got("/odom")[-1].pose.pose.position.x > 0.02)
    assert [text for text in served.said if "with the wall clock" in text] == [
        text for text in served.said if "cmd_vel" in text
    ]
    assert served.counts["cmd_vel: wall time"] >= 1


def test_a_command_holds_until_the_next_one_as_on_the_robot(burger, peer):
    peer.read("/odom", ODOM)
    served = burger()
    wait_for(lambda: peer.got("/odom"))
    peer.send("/cmd_vel", peer.twist(0.2, 0.0))
    wait_for(lambda: peer.got("/odom")[-1].pose.pose.position.x > 0.25)  # more than half a second
    peer.send("/cmd_vel", peer.twist(0.0, 0.0))
    wait_for(lambda: peer.got("/odom")[-1].twist.twist.linear.x == 0.0)
    assert "cmd_vel: timeout" not in served.counts


def test_commands_from_another_time_are_dropped_as_before(burger, peer):
    peer.read("/odom", ODOM)
    served = burger()
    wait_for(lambda: peer.got("/odom"))
    peer.send("/cmd_vel", peer.stamped_twist(0.2, stamp=time.time() - 3600.0))
    wait_for(lambda: "cmd_vel: stamp in the future" in served.counts)


def test_scans_of_carter_are_stamped_a_twentieth_of_a_second_apart(serve, peer):
    peer.read("/front_2d_lidar/scan", SCAN)
    serve(profile="carter_navigation", speed=5.0)
    wait_for(lambda: len(peer.got("/front_2d_lidar/scan")) > 8)
    stamps = [seconds(one.header.stamp) for one in peer.got("/front_2d_lidar/scan")]
    assert np.diff(stamps) == pytest.approx(0.05, abs=1e-6)
