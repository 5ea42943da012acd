"""Uses a navigator's localizer as RViz and AMCL's users do, and prints what it sees as lines of JSON."""

import json

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav2_msgs.msg import ParticleCloud
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from std_srvs.srv import Empty

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
seen = {}


def say(**values):
    print(json.dumps(values), flush=True)


def wait(accept, seconds=60.0):
    until = node.get_clock().now().nanoseconds + seconds * 1e9
    while not accept():
        rclpy.spin_once(node, timeout_sec=0.1)
        if node.get_clock().now().nanoseconds > until:
            raise SystemExit(f"waited in vain; seen: {sorted(seen)}")


def keep(name):
    return lambda message: seen.__setitem__(name, message)


rclpy.init()
node = rclpy.create_node("localization_user")
node.create_subscription(PoseWithCovarianceStamped, "amcl_pose", keep("pose"), LATCHED)
node.create_subscription(ParticleCloud, "particle_cloud", keep("cloud"), qos_profile_sensor_data)
node.create_subscription(DiagnosticArray, "/diagnostics", keep("said"), 10)
publisher = node.create_publisher(PoseWithCovarianceStamped, "initialpose", 10)
search = node.create_client(Empty, "reinitialize_global_localization")
wait(lambda: {"pose", "cloud", "said"} <= seen.keys())
cloud = seen["cloud"].particles
say(what="published", particles=len(cloud), weight=cloud[0].weight, covariance=list(seen["pose"].pose.covariance))
message = PoseWithCovarianceStamped()
message.header.frame_id = "map"
message.pose.pose.position.x, message.pose.pose.position.y, message.pose.pose.orientation.w = 5.5, 4.5, 1.0
message.pose.covariance[0] = message.pose.covariance[7] = 0.25
message.pose.covariance[35] = 0.0685
wait(lambda: publisher.get_subscription_count() > 0)
publisher.publish(message)
wait(lambda: abs(seen["pose"].pose.pose.position.y - 4.5) < 0.01)
say(what="told", x=seen["pose"].pose.pose.position.x)
search.wait_for_service()
answer = search.call_async(Empty.Request())
rclpy.spin_until_future_complete(node, answer, timeout_sec=30.0)
say(what="searched", done=answer.done())
wait(lambda: seen["said"].status[0].message == "localized")
level = seen["said"].status[0].level
say(what="state", level=level[0] if isinstance(level, bytes) else level)
