"""Publish messages at 20 Hz, each given by its fields or its bytes, until it is killed; print their bytes once.

talker.py [["TOPIC", "TYPE", {"field": …} or "BASE64"], …]
"""

import base64
import importlib
import json
import sys
import time

import rclpy
from rclpy.serialization import serialize_message


def kind_of(name):
    package, group, kind = name.split("/")
    return getattr(importlib.import_module(f"{package}.{group}"), kind)


def fill(message, fields):
    for name, value in fields.items():
        if isinstance(value, dict):
            fill(getattr(message, name), value)
        else:
            setattr(message, name, value)
    return message


def main():
    rclpy.init()
    node = rclpy.create_node("talker")
    todo = []
    for topic, name, fields in json.loads(sys.argv[1]):
        kind = kind_of(name)
        data = base64.b64decode(fields) if isinstance(fields, str) else serialize_message(fill(kind(), fields))
        todo.append((node.create_publisher(kind, topic, 10), topic, data))
    while not all(publisher.get_subscription_count() for publisher, _, _ in todo):
        time.sleep(0.02)
    for _, topic, data in todo:
        print(json.dumps({"topic": topic, "data": base64.b64encode(data).decode()}), flush=True)
    while True:
        for publisher, _, data in todo:
            publisher.publish(data)
        time.sleep(0.05)


main()
