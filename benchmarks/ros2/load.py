"""What publishing costs, and how old scans are at rclpy: /clock 200 Hz, 720 beams at 20 Hz, tf and odom 50 Hz.

python benchmarks/ros2/load.py [--distro jazzy] [--transport dds] [--seconds 20] [--rounds 3]

No simulation runs: the messages are made, serialised and written, as the bridge does it.
"""

from __future__ import annotations

import argparse
import statistics
import time

import numpy as np
from network import join, load, own_domain, peer, percentile

from trundle.geometry import Pose2D, Twist2D
from trundle.messages.codec import Codec
from trundle.messages.makers import MessageMaker
from trundle.messages.qos import CLOCK, SENSOR, TRANSFORMS, Qos
from trundle.observation import Scan

STEPS_HZ = 200


def publish(transport, seconds: float) -> float:
    """Publish in real time; returns the CPU time a second, as a share of a core."""
    codec = Codec(transport.distro)
    make = MessageMaker(codec)
    clock = transport.publisher("/clock", "rosgraph_msgs/msg/Clock", CLOCK)
    tf = transport.publisher("/tf", "tf2_msgs/msg/TFMessage", TRANSFORMS)
    odom = transport.publisher("/odom", "nav_msgs/msg/Odometry", Qos(10))
    scans = transport.publisher("/scan", "sensor_msgs/msg/LaserScan", SENSOR)
    angles, ranges = np.linspace(-np.pi, np.pi, 720), np.random.default_rng(0).uniform(0.2, 20.0, 720)
    began, cpu = time.monotonic(), time.process_time()
    for step in range(int(seconds * STEPS_HZ)):
        now = time.time()
        pose = Pose2D(0.001 * step, 0.0)
        clock.write(codec.encode(make.clock(now)))
        if step % (STEPS_HZ // 50) == 0:
            tf.write(codec.encode(make.transforms([make.transform(now, "odom", "base_link", pose)])))
            odom.write(codec.encode(make.odometry(now, "odom", "base_link", pose, Twist2D(0.2, 0.0))))
        if step % (STEPS_HZ // 20) == 0:
            scan = Scan("scan", time.time(), Pose2D(0.0, 0.0), 0.2, angles, ranges, 0.1, 30.0)
            scans.write(codec.encode(make.scan(scan, "base_scan")))
        time.sleep(max(0.0, began + (step + 1) / STEPS_HZ - time.monotonic()))
    return (time.process_time() - cpu) / (time.monotonic() - began)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--distro", default="jazzy")
    parser.add_argument("--transport", default="dds")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    own_domain()
    shares, ages = [], []
    for _ in range(given.rounds):
        transport = join(given.transport, given.distro)
        try:
            publish(transport, 1.0)  # the first serialisation of each type generates code
            with peer(given.distro, "latency", "/scan", given.seconds) as reader:
                reader.read()
                shares.append(publish(transport, given.seconds + 1.0))
                ages += reader.read()["ages"]
        finally:
            transport.close()
        print(f"{shares[-1]:.2%} of a core; {load()}", flush=True)
    scans = given.rounds * given.seconds * 20
    print(f"{given.transport}, {given.distro}: {statistics.median(shares):.2%} of a core (aim: 8 %)")
    print(f"scans: {len(ages)} of about {scans:.0f}; age at rclpy p50 {percentile(ages, 0.5) * 1e3:.1f} ms, ", end="")
    print(f"p95 {percentile(ages, 0.95) * 1e3:.1f} ms (aim: 10 ms), largest {max(ages) * 1e3:.1f} ms")


if __name__ == "__main__":
    main()
