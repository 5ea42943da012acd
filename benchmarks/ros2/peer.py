"""The other side of the benchmarks: a plain rclpy node, run by the Python of a real ROS 2. It prints JSON lines.

peer.py latency TOPIC SECONDS     how old scans are when they come; their stamps are real time
peer.py first TOPIC TYPE          when the first message came, by the monotonic clock
peer.py map TOPIC                 the same for a late joiner to a latched map
peer.py drive RATE SECONDS        numbered commands on /cmd_vel, from when somebody reads them
peer.py everything SECONDS        reads every topic there is, and counts
"""

import importlib
import json
import sys
import time

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import OccupancyGrid
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def get_message(kind):
    package, _, name = kind.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


def say(**values):
    print(json.dumps(values), flush=True)


def spin(node, seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.1)


def latency(node, topic, seconds):
    ages = []

    def take(scan):
        ages.append(time.time() - scan.header.stamp.sec - scan.header.stamp.nanosec * 1e-9)

    node.create_subscription(LaserScan, topic, take, qos_profile_sensor_data)
    say(ready=time.monotonic())
    spin(node, float(seconds))
    say(ages=ages)


def first(node, topic, kind):
    got = []
    node.create_subscription(get_message(kind), topic, lambda _: got.append(time.monotonic()), qos_profile_sensor_data)
    say(ready=time.monotonic())
    while not got:
        rclpy.spin_once(node, timeout_sec=0.1)
    say(first=got[0])


def map_(node, topic):
    got = []
    node.create_subscription(OccupancyGrid, topic, lambda grid: got.append((time.monotonic(), len(grid.data))), LATCHED)
    say(ready=time.monotonic())
    while not got:
        rclpy.spin_once(node, timeout_sec=0.1)
    say(first=got[0][0], cells=got[0][1])


def drive(node, rate, seconds):
    publisher = node.create_publisher(Twist, "/cmd_vel", 10)
    while not publisher.get_subscription_count():
        rclpy.spin_once(node, timeout_sec=0.05)
    time.sleep(1.0)  # until the other side knows of this one, too
    say(ready=time.monotonic())
    command, period, began = Twist(), 1.0 / float(rate), time.monotonic()
    count = int(float(seconds) * float(rate))
    for number in range(1, count + 1):
        command.linear.y = float(number)
        publisher.publish(command)
        time.sleep(max(0.0, began + number * period - time.monotonic()))
    say(sent=count)


def everything(node, seconds):
    counts, readers = {}, {}
    end = time.monotonic() + float(seconds)
    say(ready=time.monotonic())
    while time.monotonic() < end:
        for topic, kinds in node.get_topic_names_and_types():
            if topic in readers or "/_" in topic or topic in ("/parameter_events", "/rosout", "/cmd_vel"):
                continue
            counts[topic] = 0

            def count(_, topic=topic):
                counts[topic] += 1

            qos = QoSProfile(depth=100) if topic in ("/tf", "/odom", "/joint_states") else qos_profile_sensor_data
            readers[topic] = node.create_subscription(get_message(kinds[0]), topic, count, qos)
        until = time.monotonic() + 0.5
        while time.monotonic() < min(until, end):
            rclpy.spin_once(node, timeout_sec=0.1)
    say(counts=counts)


rclpy.init()
peer = Node("peer")
{"latency": latency, "first": first, "map": map_, "drive": drive, "everything": everything}[sys.argv[1]](
    peer, *sys.argv[2:]
)
rclpy.shutdown()
