"""A ROS program: publishes one message of every type named, with ROS's defaults, to whoever comes late as well."""

import importlib
import sys

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile

rclpy.init()
node = rclpy.create_node("types")
publishers = []
for number, name in enumerate(sys.argv[1:]):
    package, folder, last = name.split("/")
    kind = getattr(importlib.import_module(f"{package}.{folder}"), last)
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    publishers.append(node.create_publisher(kind, f"/topic_{number}", latched))
    publishers[-1].publish(kind())
rclpy.spin(node)
