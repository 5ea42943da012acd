"""Print what `ros2 node list`, `ros2 node info NODE` and `ros2 topic info -v` would, as a line of JSON.

graph.py NODE TOPICS READ TOPIC READERS: asks until the node is there, offers the TOPICS and subscribes to those of
READ, both JSON lists, and TOPIC has its readers. A node's topics are found one by one, and its endpoints some time
after their names.
"""

import json
import sys
import time

import rclpy


def endpoint(info):
    qos = info.qos_profile
    return {
        "node": info.node_name,
        "type": info.topic_type,
        "hash": str(info.topic_type_hash),
        "reliability": qos.reliability.name.lower(),
        "durability": qos.durability.name.lower(),
    }


def main():
    rclpy.init()
    asking = rclpy.create_node("asking")
    name, topics, read = sys.argv[1], *(set(json.loads(given)) for given in sys.argv[2:4])
    topic, readers = sys.argv[4], int(sys.argv[5])
    until = time.monotonic() + 60
    while time.monotonic() < until:
        nodes = [one for one, _ in asking.get_node_names_and_namespaces()]
        if name in nodes:
            publishers = dict(asking.get_publisher_names_and_types_by_node(name, "/"))
            subscribers = dict(asking.get_subscriber_names_and_types_by_node(name, "/"))
            if (
                topics <= publishers.keys()
                and read <= subscribers.keys()
                and all(asking.get_publishers_info_by_topic(one) for one in topics)
                and len(asking.get_subscriptions_info_by_topic(topic)) >= readers
            ):
                break
        time.sleep(0.1)
    found = {
        "nodes": nodes,
        "publishers": publishers,
        "subscribers": subscribers,
        "services": dict(asking.get_service_names_and_types_by_node(name, "/")),
        "written": {one: [endpoint(info) for info in asking.get_publishers_info_by_topic(one)] for one in publishers},
        "read": {one: [endpoint(info) for info in asking.get_subscriptions_info_by_topic(one)] for one in subscribers},
    }
    print(json.dumps(found), flush=True)


main()
