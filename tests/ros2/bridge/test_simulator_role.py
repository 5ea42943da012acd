"""The robot on the network, driven from there."""

from __future__ import annotations

import math

import numpy as np
import pytest

from ros2.bridge.conftest import LATCHED, wait_for
from trundle.errors import InputError
from trundle.messages import Qos
from trundle.mission import Outcome
from trundle.ros2.names import Names
from trundle.ros2.profile import Profile

CLOCK, TF, ODOM = "rosgraph_msgs/msg/Clock", "tf2_msgs/msg/TFMessage", "nav_msgs/msg/Odometry"
SCAN, CLOUD, JOINTS = "sensor_msgs/msg/LaserScan", "sensor_msgs/msg/PointCloud2", "sensor_msgs/msg/JointState"


def seconds(stamp):
    return stamp.sec + stamp.nanosec * 1e-9


def x_of(message):
    return message.pose.pose.position.x


def test_the_clock_comes_from_the_physics_steps(serve, peer, monkeypatch):
    monkeypatch.setattr("trundle.ros2.outputs.robot.FASTEST", math.inf)  # a run that was held up hurries for a moment
    peer.read("/clock", CLOCK)
    served = serve(speed=5.0)
    wait_for(lambda: len(peer.got("/clock")) > 60)
    served.end()
    times = np.array([seconds(message.clock) for message in peer.got("/clock")])
    assert times[0] == 0.0
    assert np.diff(times) == pytest.approx(0.005, abs=1e-6)


def test_odometry_and_transform_agree_and_begin_at_zero(serve, peer):
    peer.read("/tf", TF)
    peer.read("/odom", ODOM)
    served = serve(speed=5.0)
    wait_for(lambda: peer.got("/odom"))
    first = peer.got("/odom")[0]
    begins = (x_of(first), first.pose.pose.position.y, first.pose.pose.orientation.w)
    assert begins == pytest.approx((0.0, 0.0, 1.0), abs=1e-9)
    peer.send("/cmd_vel", peer.twist(0.5))
    wait_for(lambda: x_of(peer.got("/odom")[-1]) > 0.1)
    served.end()
    moved = peer.got("/odom")[-1]
    (transform,) = peer.got("/tf")[-1].transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("odom", "base_link")
    assert (moved.header.frame_id, moved.child_frame_id) == ("odom", "base_link")
    assert transform.transform.translation.x == x_of(moved)
    assert transform.header.stamp == moved.header.stamp
    stamps = np.array([seconds(message.header.stamp) for message in peer.got("/odom")])
    assert np.diff(stamps) == pytest.approx(0.02, abs=1e-6)


def test_a_scan_and_the_points_of_it_are_the_same(serve, peer):
    served = serve(speed=5.0, scenario={"robot": "jackal"})
    peer.read("/scan", SCAN)
    peer.read("/lidar_points", CLOUD)
    wait_for(lambda: peer.got("/scan") and len(peer.got("/lidar_points")) > 2)
    served.end()
    cloud = peer.got("/lidar_points")[-1]
    scan = next(one for one in peer.got("/scan") if one.header.stamp == cloud.header.stamp)
    assert scan.header.frame_id == cloud.header.frame_id == "lidar_front"
    assert (cloud.height, cloud.width, cloud.point_step) == (1, len(scan.ranges), 20)
    assert [field.name for field in cloud.fields] == ["x", "y", "z", "intensity", "ring"]
    values = cloud.data.reshape(-1, 20)[:, :12].copy().view("<f4")
    angles = scan.angle_min + scan.angle_increment * np.arange(len(scan.ranges))
    hit = np.isfinite(scan.ranges)
    assert hit.any()
    assert values[hit, 0] == pytest.approx(scan.ranges[hit] * np.cos(angles[hit]), abs=1e-4)
    assert values[hit, 1] == pytest.approx(scan.ranges[hit] * np.sin(angles[hit]), abs=1e-4)
    assert np.isnan(values[~hit]).all()
    assert scan.scan_time == pytest.approx(0.02)


def test_late_joiners_get_static_transforms_and_the_urdf(serve, peer):
    served = serve(speed=5.0)
    wait_for(lambda: served.bridge.context.clock.now > 0.1)
    peer.read("/tf_static", TF, LATCHED)
    peer.read("/robot_description", "std_msgs/msg/String", LATCHED)
    (static,) = peer.got("/tf_static")
    mounts = {one.child_frame_id: one.transform.translation for one in static.transforms}
    assert {one.header.frame_id for one in static.transforms} == {"base_link"}
    assert set(mounts) == {"base_footprint", "lidar_front", "lidar_back"}
    assert (mounts["lidar_front"].x, mounts["lidar_front"].z) == (0.026, 0.418)
    (description,) = peer.got("/robot_description")
    assert description.data.lstrip().startswith("<")
    assert "joint_wheel_left" in description.data


def test_joint_states_name_the_wheels(serve, peer):
    peer.read("/joint_states", JOINTS)
    served = serve(speed=5.0)
    wait_for(lambda: peer.got("/joint_states"))
    peer.send("/cmd_vel", peer.twist(0.4, 0.2))
    wait_for(lambda: peer.got("/joint_states")[-1].position.min() > 0.1)
    served.end()
    last = peer.got("/joint_states")[-1]
    assert last.name == ["joint_wheel_left", "joint_wheel_right"]
    assert last.position[1] > last.position[0]


def test_nothing_is_made_that_nobody_reads(serve, network):
    served = serve(speed=5.0)
    wait_for(lambda: served.bridge.context.clock.now > 0.5)
    served.end()
    assert set(network.sent) == {"/tf_static", "/robot_description"}


def test_no_map_is_published(serve, peer):
    served = serve(start=False)
    topics = {outlet.topic for outlet in served.bridge.wire.outlets}
    assert "/map" not in topics
    assert topics >= {"/clock", "/tf", "/tf_static", "/odom", "/joint_states", "/robot_description", "/contacts"}


@pytest.mark.parametrize("stamped", [False, True])
def test_commands_of_both_types_drive_and_time_out(serve, peer, stamped):
    peer.read("/odom", ODOM)
    served = serve(speed=5.0)
    wait_for(lambda: peer.got("/odom"))
    peer.send("/cmd_vel", peer.stamped_twist(0.5) if stamped else peer.twist(0.5))
    wait_for(lambda: peer.got("/odom")[-1].twist.twist.linear.x == pytest.approx(0.5))
    wait_for(lambda: peer.got("/odom")[-1].twist.twist.linear.x == 0.0)
    served.end()
    driven = [seconds(one.header.stamp) for one in peer.got("/odom") if one.twist.twist.linear.x > 0.0]
    # Half a second of simulated time, and the ramps up and down.
    assert 0.5 <= driven[-1] - driven[0] < 1.0
    assert served.counts == {"cmd_vel: timeout": 1}


def test_the_robot_stops_where_the_last_publisher_goes(serve, peer):
    served = serve(speed=1.0)
    wait_for(lambda: served.bridge.context.clock.now > 0.0)
    peer.send("/cmd_vel", peer.twist(0.5))
    wait_for(lambda: served.bridge.wire.inlets[0].writers)
    role = served.bridge._role
    wait_for(lambda: role.agent._had_writers)
    peer.send("/cmd_vel", peer.twist(0.5))
    peer.leave()
    wait_for(
        lambda: any("nobody publishes /cmd_vel" in text for text in served.said) or "cmd_vel: timeout" in served.counts
    )
    served.end()
    assert any("nobody publishes /cmd_vel" in text for text in served.said)


def test_a_program_that_offers_both_types_and_sends_one_is_one_source(serve, peer):
    served = serve(speed=1.0)
    wait_for(lambda: served.bridge.context.clock.now > 0.0)
    for message in (peer.twist(0.1), peer.stamped_twist(0.1)):
        peer.transport.publisher("/cmd_vel", message.__msgtype__, Qos())
    wait_for(lambda: served.bridge._role.agent._writers() == 2)
    served.bridge._role.agent._take(peer.twist(0.1), "")  # as Jazzy's rclpy has it, which does not say whose it is
    assert "cmd_vel: two sources" not in served.counts
    served.bridge._role.agent._take(peer.stamped_twist(0.1, stamp=served.bridge.context.clock.now), "")
    assert served.counts["cmd_vel: two sources"] == 1


def test_two_sources_are_reported_and_the_first_drives(serve, peer, network, types):
    other = type(peer)(network, types)
    other.transport.node = "/joystick"
    served = serve(speed=1.0)
    wait_for(lambda: served.bridge.context.clock.now > 0.0)
    peer.send("/cmd_vel", peer.twist(0.3))
    wait_for(lambda: served.bridge.wire.inlets[0].received == 1)
    other.send("/cmd_vel", other.twist(-0.3))
    wait_for(lambda: "cmd_vel: two sources" in served.counts)
    served.end()
    (text,) = [text for text in served.said if "commands the robot, too" in text]
    assert "the node /joystick" in text
    assert "the node /peer" in text


@pytest.mark.parametrize(
    ("send", "kind"),
    [
        (lambda peer: peer.twist(math.nan), "cmd_vel: not finite"),
        (lambda peer: peer.twist(0.1, math.inf), "cmd_vel: not finite"),
        (lambda peer: peer.stamped_twist(0.1, stamp=1e6), "cmd_vel: stamp in the future"),
        (lambda peer: peer.stamped_twist(0.1, frame="map"), "cmd_vel: wrong frame"),
        (lambda peer: peer.twist(0.1, y=0.5), "cmd_vel: other directions"),
    ],
)
def test_bad_commands_are_dropped_with_one_warning(serve, peer, send, kind):
    served = serve(speed=1.0)
    wait_for(lambda: served.bridge.context.clock.now > 0.0)
    for _ in range(3):
        peer.send("/cmd_vel", send(peer))
    wait_for(lambda: served.counts.get(kind) == 3)
    episode = served.end()
    assert len([text for text in served.said if "not reported" in text]) >= 1
    assert sum(kind.split(": ")[1].split()[0] in text or "dropped" in text for text in served.said) >= 1
    assert episode.outcome is Outcome.ABORTED


def test_a_stamp_of_the_past_is_dropped(serve, peer):
    served = serve(speed=5.0)
    wait_for(lambda: served.bridge.context.clock.now > 1.0)
    peer.send("/cmd_vel", peer.stamped_twist(0.1, stamp=0.1, frame="base_link"))
    wait_for(lambda: "cmd_vel: stamp in the past" in served.counts)
    assert any("use_sim_time" in text for text in served.said)


def test_bytes_that_are_no_message_are_dropped(serve, peer):
    served = serve(speed=1.0)
    for data in (b"", b"\x00\x01", b"\x00\x01\x00\x00" + b"\xff" * 7):
        peer.send_bytes("/cmd_vel", "geometry_msgs/msg/Twist", data)
    wait_for(lambda: served.counts.get("/cmd_vel: not a geometry_msgs/msg/Twist") == 3)


def test_a_node_that_floods_is_bounded_and_reported(serve, peer):
    served = serve(speed=1.0)
    message = peer.twist(0.1)

    def floods():
        for _ in range(100):
            peer.send("/cmd_vel", message)
        return "/cmd_vel: flood" in served.counts

    wait_for(floods)
    assert any("/peer floods /cmd_vel" in text for text in served.said)


def test_names_frames_and_remaps_are_those_of_the_namespace(serve, peer):
    names = Names(namespace="r1", frame_prefix="r1/", remaps=["odom:=wheel_odom", "/tf:=tf"])
    served = serve(start=False, names=names)
    topics = {outlet.topic for outlet in served.bridge.wire.outlets}
    assert topics >= {"/clock", "/r1/tf", "/tf_static", "/r1/wheel_odom", "/r1/front/scan"}
    assert {inlet.topic for inlet in served.bridge.wire.inlets} == {"/r1/cmd_vel", "/tf_static"}
    peer.read("/r1/tf", TF)
    served.start()
    wait_for(lambda: peer.got("/r1/tf"))
    (transform,) = peer.got("/r1/tf")[0].transforms
    assert (transform.header.frame_id, transform.child_frame_id) == ("r1/odom", "r1/base_link")


def test_a_restart_goes_on_with_the_time_and_begins_the_odometry_again(serve, peer):
    from trundle.mission import Restart

    peer.read("/clock", CLOCK)
    peer.read("/odom", ODOM)
    served = serve(speed=5.0)
    wait_for(lambda: peer.got("/odom"))
    peer.send("/cmd_vel", peer.twist(0.5))
    wait_for(lambda: x_of(peer.got("/odom")[-1]) > 0.05)
    served.bridge.context.driver.steering.put(Restart())
    count = len(peer.got("/odom"))
    wait_for(lambda: any(abs(x_of(one)) < 1e-9 for one in peer.got("/odom")[count:]))
    served.end()
    times = np.array([seconds(message.clock) for message in peer.got("/clock")])
    assert (np.diff(times) >= 0.0).all()
    assert np.diff(times).max() <= 1.01


def test_losing_the_transport_stops_the_robot_and_is_reported(serve, peer):
    served = serve(speed=1.0)
    wait_for(lambda: served.bridge.context.clock.now > 0.0)
    peer.send("/cmd_vel", peer.twist(0.5))
    wait_for(lambda: served.bridge.wire.inlets[0].received)
    served.bridge.wire.transport.lost = "the child was killed"
    wait_for(lambda: any("the child was killed" in text for text in served.said))
    served.bridge.wire.transport.lost = ""
    wait_for(lambda: "the other side is back" in served.said)


@pytest.mark.parametrize(
    ("profile", "robot", "topics"),
    [
        (
            "carter_navigation",
            "nova_carter",
            {"/chassis/odom", "/front_3d_lidar/lidar_points", "/front_2d_lidar/scan", "/back_2d_lidar/scan"},
        ),
        ("turtlebot3", "turtlebot3_waffle", {"/odom", "/scan", "/joint_states"}),
        ("plain", "jackal", {"/odom", "/scan", "/lidar_points"}),
    ],
)
def test_profiles_have_the_names_of_their_launch_files(serve, profile, robot, topics):
    served = serve(start=False, profile=profile, scenario={"robot": robot})
    found = {outlet.topic for outlet in served.bridge.wire.outlets}
    assert found >= topics | {"/clock", "/tf"}
    assert "/tf_static" in found
    assert ("/imu" in found) == ("/battery_state" in found) == (profile == "turtlebot3")
    assert ("/robot_description" in found) == (profile != "turtlebot3")


@pytest.mark.parametrize("backend", ["kinematic", "mujoco"])
def test_joint_states_above_the_control_rate_come_from_the_physics_steps(serve, peer, backend):
    profile = Profile.load("plain").model_copy(update={"joint_state_rate": 200.0})
    peer.read("/joint_states", JOINTS)
    served = serve(speed=5.0, profile=profile, scenario={"backend": backend})
    peer.send("/cmd_vel", peer.twist(0.4))
    wait_for(lambda: len(peer.got("/joint_states")) > 50)
    served.end()
    states = peer.got("/joint_states")
    assert np.diff([seconds(one.header.stamp) for one in states]) == pytest.approx(0.005, abs=1e-6)
    turned = np.diff([one.position[0] for one in states])
    assert turned == pytest.approx([0.005 * one.velocity[0] for one in states[1:]], abs=1e-3)


def test_points_of_several_rings_are_rows_of_the_cloud(serve, peer):
    sensor = {"front": {"frame": "lidar_front", "points": "lidar_points", "rings": [-20.0, 0.0, 5.0]}}
    profile = Profile(sensors=sensor, only_listed=True)
    peer.read("/lidar_points", CLOUD)
    served = serve(speed=1.0, profile=profile, scenario={"robot": "jackal", "lidar": ["front"]})
    wait_for(lambda: peer.got("/lidar_points"))
    served.end()
    cloud = peer.got("/lidar_points")[-1]
    assert (cloud.height, cloud.width, cloud.row_step) == (3, 720, 720 * 20)
    values = cloud.data.reshape(3, 720, 20)
    points = values[..., :12].copy().view("<f4")
    assert values[..., 16:18].copy().view("<u2")[:, :, 0].tolist() == [[row] * 720 for row in range(3)]
    low, level, high = points
    floor = low[np.abs(low[:, 2] + 0.297) < 1e-3]
    assert len(floor) > 50
    assert np.hypot(floor[:, 0], floor[:, 1]) == pytest.approx(0.297 / math.tan(math.radians(20.0)), abs=0.01)
    assert np.nanmax(np.abs(level[:, 2])) < 1e-6
    assert np.nanmin(high[:, 2]) > 0.0


def test_a_run_that_is_much_faster_than_real_time_has_the_clock_once_in_a_period(serve, peer):
    peer.read("/clock", CLOCK)
    served = serve(speed=math.inf)
    clock = served.bridge.context.clock
    wait_for(lambda: served.bridge.context.driver.status.factor > 11.0)
    wait_for(lambda later=clock.now + 10.0: clock.now > later)
    served.end()
    times = np.array([seconds(message.clock) for message in peer.got("/clock")])
    assert np.diff(times)[-5:] == pytest.approx(0.02, abs=1e-6)


def test_a_profile_is_read_from_a_file(tmp_path):
    path = tmp_path / "mine.yaml"
    path.write_text("topics: {odom: wheel/odom}\nsensors: {front: {scan: scan, rings: [0, 2]}}\n")
    profile = Profile.load(str(path))
    assert (profile.topics.odom, profile.sensors["front"].rings) == ("wheel/odom", (0.0, 2.0))
    path.write_text("topic: {}\n")
    with pytest.raises(InputError, match=r"mine\.yaml:1"):
        Profile.load(str(path))
    with pytest.raises(InputError, match="carter_navigation"):
        Profile.load("carter")
