"""Records made-up messages, 20 times as fast as real time, until it is killed; prints the time of each."""

import sys
import time

from trundle.messages.codec import Codec
from trundle.messages.qos import LATCHED, Qos
from trundle.ros2.record import WireRecord

codec = Codec("jazzy")
data = codec.encode(codec.make("std_msgs/msg/String", data="words"))
record = WireRecord(sys.argv[1], "jazzy", codec)
record.add("/map_text", "std_msgs/msg/String", LATCHED, data, 0.0)
for index in range(100_000):
    record.add("/text", "std_msgs/msg/String", Qos(), data, 0.05 * index)
    sys.stdout.write(f"{0.05 * index:.3f}\n")
    sys.stdout.flush()
    time.sleep(0.0025)
