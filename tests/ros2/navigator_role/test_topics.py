"""What the navigator publishes and hears."""

import math

import numpy as np
import pytest

from ros2.navigator_role.conftest import COVARIANT, LATCHED, wait_for
from support.doubtful import COVARIANCE
from trundle.geometry import Pose2D
from trundle.messages import Qos
from trundle.messages.makers import MessageMaker, covariance_of, encode_particles
from trundle.messages.qos import SENSOR
from trundle.messages.readers import DIAGNOSIS, read_grid, read_stamp, read_yaw
from trundle.mission import DropBox, SetPose
from trundle.ros2.names import Names
from trundle.ros2.navigator_role.localization import TOLERANCE_S

GRID, UPDATE = "nav_msgs/msg/OccupancyGrid", "map_msgs/msg/OccupancyGridUpdate"
MARKERS = "visualization_msgs/msg/MarkerArray"
TF, ODOM = "tf2_msgs/msg/TFMessage", "nav_msgs/msg/Odometry"
MANY = Qos(1000)


def place(pose):
    return pose.position.x, pose.position.y


def initial(client, x, y, yaw=0.0, **options):
    stamped = client.pose(x, y, yaw, **options)
    make = client.types.make
    pose = make("geometry_msgs/msg/PoseWithCovariance", pose=stamped.pose)
    return make(COVARIANT, header=stamped.header, pose=pose)


# Published ------------------------------------------------------------------------------------------------------------


def test_late_joiners_get_the_map_the_costmaps_and_the_pose(serve, client):
    served = serve()
    goal = client.go(1.8, 1.5)
    goal.wait()
    client.read("/map", GRID, LATCHED)
    client.read("/global_costmap/costmap", GRID, LATCHED)
    client.read("/local_costmap/costmap", GRID, LATCHED)
    client.read("/amcl_pose", COVARIANT, LATCHED)
    (grid,) = client.got("/map")
    np.testing.assert_array_equal(read_grid(grid).data, served.bridge.mission.grid.data)
    assert client.got("/global_costmap/costmap")[0].info.width == 160
    assert client.got("/local_costmap/costmap")[0].info.width == 60
    assert client.got("/amcl_pose")[0].header.frame_id == "map"


def test_map_to_base_over_odom_is_where_the_robot_believes_to_be(serve, client):
    client.read("/tf", TF, MANY)
    serve(speed=10.0)
    goal = client.go(1.5, 3.0)
    goal.wait()
    transforms = [one for message in client.got("/tf") for one in message.transforms]
    ahead = [one for one in transforms if one.header.frame_id == "map"]
    assert {one.child_frame_id for one in ahead} == {"odom"}
    last = ahead[-1]
    time = read_stamp(last.header.stamp) - TOLERANCE_S
    (odom,) = [
        one for one in transforms if one.header.frame_id == "odom" and abs(read_stamp(one.header.stamp) - time) < 1e-6
    ]
    yaw, shift = read_yaw(last.transform.rotation), last.transform.translation
    at = odom.transform.translation
    x = shift.x + math.cos(yaw) * at.x - math.sin(yaw) * at.y
    y = shift.y + math.sin(yaw) * at.x + math.cos(yaw) * at.y
    assert math.hypot(x - 1.5, y - 3.0) < 0.3


def test_the_plan_is_published_while_the_robot_drives(serve, client):
    client.read("/plan", "nav_msgs/msg/Path", MANY)
    serve()
    client.go(6.5, 1.5).wait()
    plan = client.got("/plan")[0]
    assert plan.header.frame_id == "map"
    assert place(plan.poses[-1].pose) == pytest.approx((6.5, 1.5), abs=0.05)


@pytest.mark.parametrize("costmap", ["global_costmap", "local_costmap"])
def test_the_outline_of_the_robot_is_published_where_it_is(serve, client, costmap):
    client.read(f"/{costmap}/published_footprint", "geometry_msgs/msg/PolygonStamped", MANY)
    served = serve()
    shown = wait_for(lambda: client.got(f"/{costmap}/published_footprint"))[0]
    mission = served.bridge.mission
    corners = [(point.x, point.y) for point in shown.polygon.points]
    is_local = costmap == "local_costmap"  # the odometry begins at the start
    place = Pose2D(0.0, 0.0) if is_local else mission.start
    assert np.allclose(corners, place.transform_points(mission.navigator.robot.outline), atol=1e-3)
    assert shown.header.frame_id == ("odom" if is_local else "map")


def test_changes_of_the_costmap_are_updates(serve, client):
    client.read("/global_costmap/costmap", GRID, LATCHED)
    client.read("/global_costmap/costmap_updates", UPDATE, MANY)
    served = serve(scenario={"lidar": True}, speed=5.0)
    whole = wait_for(lambda: client.got("/global_costmap/costmap"))[0]
    data = np.array(whole.data, np.int8).reshape(120, 160)
    served.put(DropBox(2.6, 1.5, 0.0, (0.3, 0.3, 0.6)))
    wait_for(lambda: any((np.asarray(one.data) == 100).any() for one in client.got("/global_costmap/costmap_updates")))
    for one in client.got("/global_costmap/costmap_updates"):
        data[one.y : one.y + one.height, one.x : one.x + one.width] = np.array(one.data).reshape(one.height, one.width)
    assert (data[28:33, 48:56] == 100).any()
    assert len(client.got("/global_costmap/costmap")) == 1


def test_a_new_reader_gets_the_costmap_as_it_is_now(serve, client):
    client.read("/global_costmap/costmap", GRID, LATCHED)
    served = serve(scenario={"lidar": True}, speed=5.0)
    wait_for(lambda: client.got("/global_costmap/costmap"))
    served.put(DropBox(2.6, 1.5, 0.0, (0.3, 0.3, 0.6)))
    wait_for(lambda: served.bridge.mission.navigator.costmap.cost_at(2.5, 1.5) > 250)
    late = served.bridge.wire.transport.network.transport("late")
    reader = late.subscription("/global_costmap/costmap", GRID, LATCHED)
    samples = []

    def has_box():
        samples.extend(reader.take())
        grids = [np.array(client.types.decode(GRID, one.data).data).reshape(120, 160) for one in samples]
        return any((grid[28:33, 48:56] == 100).any() for grid in grids)

    wait_for(has_box)


def test_the_local_costmap_moves_with_the_robot(serve, client):
    client.read("/local_costmap/costmap", GRID, Qos(1000, durability="transient_local"))
    serve()
    client.go(1.5, 4.5).wait()
    origins = [place(message.info.origin) for message in client.got("/local_costmap/costmap")]
    assert origins[0] == pytest.approx((-1.5, -1.5), abs=0.06)
    assert origins[-1] == pytest.approx((-1.5, 1.5), abs=0.4)
    assert {message.header.frame_id for message in client.got("/local_costmap/costmap")} == {"odom"}


def test_goals_are_marked_until_they_are_reached(serve, client):
    client.read("/waypoints", MARKERS, Qos(1000, durability="transient_local"))
    serve()
    poses = [client.pose(1.5, 3.0), client.pose(1.5, 4.5)]
    client.send("/navigate_through_poses", "NavigateThroughPoses", poses=poses).wait()
    wait_for(lambda: len(client.got("/waypoints")) >= 4)
    counts = [len(message.markers) - 1 for message in client.got("/waypoints")]
    assert counts == [0, 2, 1, 0]


def test_rollouts_are_drawn_only_for_those_who_look(serve, client):
    served = serve(scenario={"controller": "mppi"}, speed=10.0)
    goal = client.go(1.5, 4.5)
    goal.wait_for_feedback(3)
    client.read("/trajectories", MARKERS, MANY)
    lines = wait_for(lambda: client.got("/trajectories"))[0].markers[0]
    assert len(lines.points) > 100
    assert len(lines.points) % 2 == 0
    assert served.counts == {}


def test_names_get_the_namespace_and_remaps(serve, network):
    serve(names=Names(namespace="r1", remaps=["map:=floor"]))
    topics = {endpoint.topic for endpoint in network.transports[0].graph().endpoints}
    assert {"/r1/floor", "/r1/plan", "/r1/goal_pose", "/r1/global_costmap/costmap"} <= topics


# Heard ----------------------------------------------------------------------------------------------------------------


def test_a_goal_from_rviz_is_driven_to(serve, client):
    served = serve()
    goal = client.go(6.5, 1.5)
    goal.wait_for_feedback(3)
    client.publish("/goal_pose", client.pose(1.5, 4.0))
    assert goal.wait().error_msg == "a goal came on /goal_pose"
    wait_for(lambda: served.goals == ((1.5, 4.0, 0.0),))
    assert served.counts == {}


@pytest.mark.parametrize(
    ("pose", "kind"),
    [
        ({"x": math.nan, "y": 1.0}, "not finite"),
        ({"x": 1.0, "y": 1.0, "frame": "moon"}, "wrong frame"),
        ({"x": 4.0, "y": 1.0}, "refused"),
        ({"x": 1.0, "y": 1e9}, "too far"),
    ],
)
def test_bad_goals_are_dropped_with_one_warning_for_each_kind(serve, client, pose, kind):
    served = serve()
    for _ in range(3):
        client.publish("/goal_pose", client.pose(**pose))
    wait_for(lambda: served.counts.get(f"goal_pose: {kind}") == 3)
    assert len(served.said) == 1


def test_a_goal_stamped_by_another_clock_is_taken_and_reported(serve, client):
    served = serve()
    client.publish("/goal_pose", client.pose(1.5, 4.0, stamp=1_700_000_000))
    wait_for(lambda: served.goals)
    assert served.counts == {"goal_pose: stamp in the future": 1}
    assert "use_sim_time" in served.said[0]


def test_the_pose_of_a_localizer_is_told_and_answered(serve, client):
    served = serve(scenario={"localizer": "odometry"})
    client.read("/amcl_pose", COVARIANT, MANY)
    client.publish("/initialpose", initial(client, 1.2, 1.7, 0.5))
    last = wait_for(lambda: [one for one in client.got("/amcl_pose") if abs(one.pose.pose.position.x - 1.2) < 0.01])[-1]
    assert place(last.pose.pose) == pytest.approx((1.2, 1.7), abs=0.01)
    assert served.counts == {}
    episode = served.end()
    (given,) = [one for one in episode.directives if isinstance(one.directive, SetPose)]
    assert given.by == "initialpose"


DOUBTFUL = "support.doubtful:DoubtfulLocalizer"
PARTICLES, DIAGNOSTICS = "nav2_msgs/msg/ParticleCloud", "diagnostic_msgs/msg/DiagnosticArray"


def test_the_covariance_that_rviz_sends_reaches_the_localizer_and_its_own_comes_back(serve, client):
    served = serve(scenario={"localizer": DOUBTFUL}, speed=5.0)
    client.read("/amcl_pose", COVARIANT, MANY)
    message = initial(client, 1.2, 1.7, 0.5)
    variances = np.zeros(36)
    variances[[0, 7, 35]] = 0.25, 0.25, 0.0685
    message.pose.covariance = variances
    client.publish("/initialpose", message)
    told = wait_for(lambda: [one for one in client.got("/amcl_pose") if abs(one.pose.pose.position.x - 1.3) < 0.01])[-1]
    found = np.asarray(told.pose.covariance).reshape(6, 6)[np.ix_((0, 1, 5), (0, 1, 5))]
    np.testing.assert_allclose(found, COVARIANCE)
    episode = served.end()
    (given,) = [one.directive for one in episode.directives if isinstance(one.directive, SetPose)]
    np.testing.assert_allclose(given.covariance, np.diag([0.25, 0.25, 0.0685]))


def test_a_covariance_that_is_none_is_dropped(serve, client):
    served = serve(scenario={"localizer": DOUBTFUL})
    message = initial(client, 1.2, 1.7)
    message.pose.covariance = np.diag([-1.0, 1.0, 0.0, 0.0, 0.0, 1.0]).ravel()
    client.publish("/initialpose", message)
    wait_for(lambda: served.counts == {"initialpose: no covariance": 1})


def test_particles_are_published_while_somebody_listens(serve, client):
    client.read("/particle_cloud", PARTICLES, SENSOR)
    served = serve(scenario={"localizer": DOUBTFUL}, speed=5.0)
    cloud = wait_for(lambda: client.got("/particle_cloud"))[-1]
    assert cloud.header.frame_id == "map"
    assert len(cloud.particles) == 600
    assert cloud.particles[0].weight == pytest.approx(1 / 600)
    x = np.mean([one.pose.position.x for one in cloud.particles])
    assert x == pytest.approx(served.bridge.mission.start.x + 0.1, abs=0.1)
    turn = cloud.particles[3].pose.orientation
    assert math.hypot(turn.z, turn.w) == pytest.approx(1.0)


def test_without_nav2_msgs_on_the_other_side_there_are_no_particles(serve, network):
    serve(definitions={}, scenario={"localizer": DOUBTFUL})
    topics = {endpoint.topic for endpoint in network.transports[0].graph().endpoints}
    assert "/particle_cloud" not in topics
    assert "/amcl_pose" in topics


def test_without_services_particles_need_no_type_of_the_other_side(serve, network):
    serve(definitions={}, has_services=False, scenario={"localizer": DOUBTFUL})
    topics = {endpoint.topic for endpoint in network.transports[0].graph().endpoints}
    assert "/particle_cloud" in topics


def test_the_state_of_the_localizer_is_a_diagnosis(serve, client):
    client.read("/diagnostics", DIAGNOSTICS, MANY)
    serve(scenario={"localizer": DOUBTFUL}, speed=5.0)

    def said():
        return [one.status[0] for one in client.got("/diagnostics") if one.status[0].name == DIAGNOSIS]

    wait_for(lambda: any(one.message == "localized" for one in said()))
    levels = {one.message: one.level for one in said()}
    assert levels == {"ambiguous: 3 places": 1, "lost": 2, "localized": 0}
    first = said()[0]
    assert [one.key for one in first.values] == ["state", "place 1", "place 2", "place 3"]


def test_a_robot_with_its_true_pose_has_no_diagnosis_of_it(serve, client):
    client.read("/diagnostics", DIAGNOSTICS, MANY)
    serve()
    wait_for(lambda: client.got("/diagnostics"))
    assert {one.status[0].name for one in client.got("/diagnostics")} == {"trundle: navigation"}


def test_map_to_odom_is_the_localizers_correction(serve, client):
    client.read("/tf", TF, MANY)
    serve(scenario={"localizer": DOUBTFUL}, speed=5.0)
    (first, *_) = wait_for(
        lambda: [t.transform for m in client.got("/tf") for t in m.transforms if t.header.frame_id == "map"]
    )
    assert (first.translation.x, first.translation.y) == pytest.approx((1.6, 1.5), abs=0.02)


def test_a_true_pose_stays_and_is_answered(serve, client):
    served = serve()
    client.read("/amcl_pose", COVARIANT, MANY)
    before = len(client.got("/amcl_pose"))
    client.publish("/initialpose", initial(client, 5.0, 5.0))
    wait_for(lambda: len(client.got("/amcl_pose")) > before)
    assert place(client.got("/amcl_pose")[-1].pose.pose) == pytest.approx((1.5, 1.5), abs=0.05)
    wait_for(lambda: served.counts == {"initialpose: no localizer": 1})


@pytest.mark.parametrize(
    ("frame", "w", "kind"), [("odom", 1.0, "wrong frame"), ("map", 0.0, "no rotation"), ("map", math.nan, "not finite")]
)
def test_bad_poses_are_dropped(serve, client, frame, w, kind):
    served = serve(scenario={"localizer": "odometry"})
    message = initial(client, 1.0, 1.0, frame=frame)
    message.pose.pose.orientation.w = w
    client.publish("/initialpose", message)
    wait_for(lambda: served.counts == {f"initialpose: {kind}": 1})


def test_the_robot_stands_when_the_other_side_is_lost(serve, client):
    served = serve()
    goal = client.go(6.5, 1.5)
    goal.wait_for_feedback(5)
    served.bridge.wire.transport.lost = "the process was killed"
    wait_for(lambda: served.goals == ())
    assert goal.status == "aborted"
    served.bridge.wire.transport.lost = ""


def test_a_covariance_in_the_plane_becomes_one_in_space():
    covariance = covariance_of(np.array([[1.0, 2.0, 3.0], [2.0, 4.0, 5.0], [3.0, 5.0, 6.0]])).reshape(6, 6)
    assert (covariance[0, 0], covariance[0, 5], covariance[5, 5], covariance[1, 5]) == (1.0, 3.0, 6.0, 5.0)
    assert covariance[2:5].any() == np.False_


def test_maps_of_others_are_not_read_whatever_their_size(serve, client):
    serve()
    for topic in ("/map", "/global_costmap/costmap", "/local_costmap/costmap"):
        assert client.transport.publisher(topic, GRID, LATCHED).matched == 0


@pytest.mark.parametrize("frame", ["map", "m", "robot_1/map"])
@pytest.mark.parametrize("count", [0, 1, 5])
def test_particles_have_the_bytes_of_a_message_of_objects(client, frame, count):
    codec = client.types.codec
    make = MessageMaker(codec)
    particles = np.random.default_rng(1).normal(size=(count, 4))
    pose = lambda row: make.pose(Pose2D(*row[:3]))  # noqa: E731
    kind = codec.kind("nav2_msgs/msg/Particle")
    slow = codec.make(
        PARTICLES, header=make.header(1.25, frame), particles=[kind(pose=pose(row), weight=row[3]) for row in particles]
    )
    assert encode_particles(make, 1.25, particles, frame) == codec.encode(slow)
