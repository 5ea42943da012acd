"""A node of a real ROS 2: sends back what it gets, and reports what it sees.

Arguments are topics, "/name=package/msg/Type:qos": each message on /name/there goes back on /name/back. For each line
on the standard input, the name of a node, it prints what `ros2 node info` and `ros2 topic info --verbose` would.
"""

# ruff: noqa: T201 - what it prints is for the test

import contextlib
import importlib
import json
import sys
import threading

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import NodeNameNonExistentError
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy


def profile(name):
    if name == "latched":
        return QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    if name == "sensor":
        return QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
    return QoSProfile(depth=10)


def endpoints(node, topic):
    found = [*node.get_publishers_info_by_topic(topic), *node.get_subscriptions_info_by_topic(topic)]
    return [
        {
            "node": f"{one.node_namespace.rstrip('/')}/{one.node_name}",
            "kind": one.endpoint_type.name,
            "type": one.topic_type,
            "hash": f"RIHS0{one.topic_type_hash.version}_{bytes(one.topic_type_hash.value).hex()}",
            "reliability": one.qos_profile.reliability.name,
            "durability": one.qos_profile.durability.name,
        }
        for one in found
    ]


def graph(node, name):
    namespace, _, short = name.rpartition("/")
    topics = dict(node.get_topic_names_and_types())
    return {
        "nodes": [f"{space.rstrip('/')}/{one}" for one, space in node.get_node_names_and_namespaces()],
        "topics": topics,
        "publishers": dict(node.get_publisher_names_and_types_by_node(short, namespace or "/")),
        "subscribers": dict(node.get_subscriber_names_and_types_by_node(short, namespace or "/")),
        "endpoints": {topic: endpoints(node, topic) for topic in topics},
    }


def main():
    rclpy.init()
    node = rclpy.create_node("echo", namespace="/real")
    for one in sys.argv[1:]:
        topic, _, rest = one.partition("=")
        type_name, _, qos = rest.partition(":")
        package, _, short = type_name.partition("/msg/")
        kind = getattr(importlib.import_module(f"{package}.msg"), short)
        back = node.create_publisher(kind, f"{topic}/back", profile(qos))
        node.create_subscription(kind, f"{topic}/there", back.publish, profile(qos))
    threading.Thread(target=answer, args=(node,), daemon=True).start()
    print("ready", flush=True)
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        rclpy.spin(node)


def answer(node):
    for line in sys.stdin:
        try:
            print(json.dumps(graph(node, line.strip())), flush=True)
        except NodeNameNonExistentError as error:
            print(json.dumps({"error": str(error)}), flush=True)


if __name__ == "__main__":
    main()
