"""Drives a robot that trundle simulates, calls simulation_interfaces, and prints what came as JSON."""

import json
import sys
import time

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import JointState, LaserScan, PointCloud2
from simulation_interfaces.action import SimulateSteps
from simulation_interfaces.srv import (
    GetEntities,
    GetEntityState,
    GetSimulationState,
    GetSimulatorFeatures,
    ResetSimulation,
    SetEntityState,
    SetSimulationState,
    StepSimulation,
)
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

STAMPED = "--stamped" in sys.argv
rclpy.init()
node = rclpy.create_node("peer", parameter_overrides=[rclpy.parameter.Parameter("use_sim_time", value=True)])
executor = SingleThreadedExecutor()
executor.add_node(node)
latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
got, subscriptions = {}, {}


def listen(kind, topic, qos=10):
    got[topic] = []
    subscriptions[topic] = node.create_subscription(kind, topic, got[topic].append, qos)


def spin(done, timeout=60.0):
    until = time.monotonic() + timeout
    while not done():
        if time.monotonic() > until:
            counts = {topic: len(messages) for topic, messages in got.items()}
            sys.exit(f"line {sys._getframe(1).f_lineno}: waited in vain; got {counts}")
        executor.spin_once(timeout_sec=0.05)


def call(kind, name, **fields):
    client = node.create_client(kind, name)
    spin(client.service_is_ready)
    future = client.call_async(kind.Request(**fields))
    spin(future.done)
    return future.result()


def seconds(stamp):
    return stamp.sec + stamp.nanosec * 1e-9


listen(Clock, "/clock")
listen(Odometry, "/odom")
listen(LaserScan, "/front/scan", qos_profile_sensor_data)
listen(LaserScan, "/back/scan")
listen(PointCloud2, "/front/lidar_points", qos_profile_sensor_data)
listen(JointState, "/joint_states")
listen(TFMessage, "/tf", 100)
listen(TFMessage, "/tf_static", latched)
listen(String, "/robot_description", latched)
spin(lambda: all(got.values()))
for topic in set(got) - {"/clock", "/odom"}:  # a busy machine has enough to do with these
    node.destroy_subscription(subscriptions[topic])
kind = TwistStamped if STAMPED else Twist
commands = node.create_publisher(kind, "/cmd_vel", 10)
spin(lambda: commands.get_subscription_count() > 0)


def drive():
    message = kind()
    if STAMPED:
        message.header.stamp = node.get_clock().now().to_msg()
        message.header.frame_id = "base_link"
    (message.twist if STAMPED else message).linear.x = 0.4
    commands.publish(message)


timer = node.create_timer(0.05, drive)
spin(lambda: got["/odom"][-1].pose.pose.position.x > 0.2)
node.destroy_timer(timer)
moving = max(one.twist.twist.linear.x for one in got["/odom"])
spin(lambda: abs(got["/odom"][-1].twist.twist.linear.x) < 1e-3)


def clocks_apart():
    return abs(seconds(node.get_clock().now().to_msg()) - seconds(got["/clock"][-1].clock))


spin(lambda: clocks_apart() < 0.1)  # of the two that hear the clock, one may have more to catch up with
cloud, scan = got["/front/lidar_points"][-1], got["/front/scan"][-1]
found = {
    "moving": moving,
    "sim_time": clocks_apart(),
    "scan": [scan.header.frame_id, len(scan.ranges)],
    "cloud": [cloud.header.frame_id, cloud.height, cloud.width, len(cloud.data)],
    "static": sorted(one.child_frame_id for one in got["/tf_static"][0].transforms),
    "urdf": "<robot" in got["/robot_description"][0].data,
    "joints": list(got["/joint_states"][-1].name),
}

pause = SetSimulationState.Request()
pause.state.state = 2
found["pause"] = call(SetSimulationState, "/set_simulation_state", state=pause.state).result.result
before = call(GetEntityState, "/get_entity_state", entity="nova_carter").state
began = time.monotonic()
found["step"] = call(StepSimulation, "/step_simulation", steps=10).result.result
after = call(GetEntityState, "/get_entity_state", entity="nova_carter").state
found["stepped"] = seconds(after.header.stamp) - seconds(before.header.stamp)
found["state"] = call(GetSimulationState, "/get_simulation_state").state.state
found["features"] = len(call(GetSimulatorFeatures, "/get_simulator_features").features.features)
found["entities"] = call(GetEntities, "/get_entities").entities[0]
place = SetEntityState.Request()
place.entity, place.state.pose = "nova_carter", before.pose
found["place"] = call(SetEntityState, "/set_entity_state", entity=place.entity, state=place.state).result.result
at = call(GetEntityState, "/get_entity_state", entity="nova_carter").state.pose.position
found["placed"] = [at.x - before.pose.position.x, at.y - before.pose.position.y]

steps = ActionClient(node, SimulateSteps, "/simulate_steps")
spin(steps.server_is_ready)
feedback = []
sent = steps.send_goal_async(
    SimulateSteps.Goal(steps=3), feedback_callback=lambda one: feedback.append(one.feedback.completed_steps)
)
spin(sent.done)
result = sent.result().get_result_async()
spin(result.done)
found["action"] = [result.result().status, result.result().result.result.result]
spin(lambda: feedback)  # rclpy drops what comes after the result
found["feedback"] = feedback == sorted(set(feedback)) and set(feedback) <= {1, 2, 3}
found["reset"] = call(ResetSimulation, "/reset_simulation").result.result
sys.stdout.write(json.dumps(found) + "\n")
sys.stdout.flush()
timer = node.create_timer(0.05, drive)
play = SetSimulationState.Request()
play.state.state = 1
call(SetSimulationState, "/set_simulation_state", state=play.state)
spin(lambda: False, 60.0)
