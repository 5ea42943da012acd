"""A process that opens the transport, serves an action that never ends, prints the child's number and waits."""

# ruff: noqa: T201 - what it prints is for the test

import os
import sys
import time

from trundle.messages import Qos
from trundle.ros2.transport.domain import read_settings
from trundle.ros2.transport.rclpy.relay import open_rclpy


class Endless:
    def accepts(self, data: bytes) -> bool:
        return True

    def accepted(self, goal) -> None:
        print("accepted", flush=True)

    def cancel(self, goal) -> bool:
        return True


transport = open_rclpy(read_settings(), python=sys.argv[1])
transport.action("/count", "test_msgs/action/Fibonacci", Endless())
transport.service("/set", "std_srvs/srv/SetBool", lambda request: b"")
transport.publisher("/clock", "rosgraph_msgs/msg/Clock", Qos())
print(transport.pid, os.getpid(), flush=True)
while True:
    transport.wait(0.1)
    transport.dispatch()
    time.sleep(0.001)
