"""Subscribe to topics and print each message as a line of JSON: its bytes, and its values as rclpy reads them.

listener.py {"TOPIC": {"type": …, "reliability": …, "durability": …, "depth": …}, …}
"""

import base64
import importlib
import json
import sys

import rclpy
from rclpy.qos import QoSProfile, qos_policy_name_from_kind
from rclpy.serialization import deserialize_message


def kind_of(name):
    package, group, kind = name.split("/")
    return getattr(importlib.import_module(f"{package}.{group}"), kind)


def plain(value):
    if hasattr(value, "get_fields_and_field_types"):
        return {name: plain(getattr(value, name)) for name in value.get_fields_and_field_types()}
    if isinstance(value, bytes):
        return list(value)
    if isinstance(value, str) or not hasattr(value, "__len__"):
        return value.item() if hasattr(value, "item") else value
    return value.tolist() if hasattr(value, "tolist") else [plain(one) for one in value]


def say(**facts):
    print(json.dumps(facts), flush=True)


def main():
    rclpy.init()
    node = rclpy.create_node("listener")
    for topic, asked in json.loads(sys.argv[1]).items():
        kind = kind_of(asked["type"])

        def hear(data, topic=topic, kind=kind):
            value = plain(deserialize_message(data, kind))
            say(topic=topic, data=base64.b64encode(data).decode(), value=value)

        def refuse(event, topic=topic):
            say(topic=topic, incompatible=str(qos_policy_name_from_kind(event.last_policy_kind)))

        from rclpy.event_handler import SubscriptionEventCallbacks
        from rclpy.qos import DurabilityPolicy, ReliabilityPolicy

        qos = QoSProfile(
            depth=asked["depth"],
            reliability=ReliabilityPolicy[asked["reliability"].upper()],
            durability=DurabilityPolicy[asked["durability"].upper()],
        )
        events = SubscriptionEventCallbacks(incompatible_qos=refuse)
        node.create_subscription(kind, topic, hear, qos, raw=True, event_callbacks=events)
    say(ready=True)
    rclpy.spin(node)


main()
