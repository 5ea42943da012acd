"""A ROS program: echoes /scan as bytes on /echo, reports what it gets, and drives by both types of /cmd_vel."""

# ruff: noqa: T201 - what it prints is for the test

import json
import sys

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import LaserScan

BEST_EFFORT = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)

rclpy.init()
node = rclpy.create_node("peer", namespace="/robots")
stamps = rclpy.create_node("stamps", context=(other := rclpy.Context()) and (other.init() or other))
echo = node.create_publisher(LaserScan, "/echo", 10)
plain = node.create_publisher(Twist, "/cmd_vel", 10)
stamped = stamps.create_publisher(TwistStamped, "/cmd_vel", 10)


def report(**facts):
    print(json.dumps(facts), flush=True)


def on_scan(data):
    echo.publish(bytes(data))


def on_map(grid):
    report(map=[grid.info.width, grid.info.height, list(grid.data)])


node.create_subscription(LaserScan, "/scan", on_scan, BEST_EFFORT, raw=True)
node.create_subscription(LaserScan, "/scan", lambda scan: report(scan=list(scan.ranges)), BEST_EFFORT)
node.create_subscription(OccupancyGrid, "/map", on_map, LATCHED)
while plain.get_subscription_count() < 1 or stamped.get_subscription_count() < 1 or echo.get_subscription_count() < 1:
    rclpy.spin_once(node, timeout_sec=0.02)
for number in range(int(sys.argv[1])):
    twist = Twist()
    twist.linear.x = float(number)
    plain.publish(twist)
    stamped.publish(TwistStamped(twist=twist))
report(sent=True)
while True:
    rclpy.spin_once(node, timeout_sec=0.1)
