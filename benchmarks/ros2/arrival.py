"""How long until the first data, and until a late joiner has a map of 16 MB.

python benchmarks/ros2/arrival.py first|map [--distro jazzy] [--transport dds] [--rounds 5]
"""

from __future__ import annotations

import argparse
import statistics
import time

import numpy as np
from network import join, load, own_domain, peer, served

from trundle.geometry import Pose2D
from trundle.maps import OccupancyGrid
from trundle.messages.codec import Codec
from trundle.messages.makers import MessageMaker
from trundle.messages.qos import LATCHED

SCAN = "sensor_msgs/msg/LaserScan"


def first(given: argparse.Namespace) -> list[float]:
    """From when both sides are up to the first scan: first the client starts later, then the bridge."""
    with served(given.transport, given.distro), peer(given.distro, "first", "/scan", SCAN) as reader:
        after = -reader.read()["ready"] + reader.read()["first"]
    with peer(given.distro, "first", "/scan", SCAN) as reader:
        reader.read()
        with served(given.transport, given.distro):
            up = time.monotonic()
            before = reader.read()["first"] - up
    print(f"client later {after:.2f} s, bridge later {before:.2f} s; {load()}", flush=True)
    return [after, before]


def late_map(given: argparse.Namespace) -> list[float]:
    """A map of 16 MB that was published before its reader came."""
    codec = Codec(given.distro)
    cells = np.zeros((4000, 4000), dtype=np.int8)
    began = time.process_time()
    data = codec.encode(MessageMaker(codec).grid(0.0, OccupancyGrid(cells, 0.05, Pose2D(0.0, 0.0))))
    serialised = time.process_time() - began
    transport = join(given.transport, given.distro)
    try:
        began = time.monotonic()
        transport.publisher("/map", "nav_msgs/msg/OccupancyGrid", LATCHED).write(data)
        written = time.monotonic() - began
        time.sleep(1.0)
        with peer(given.distro, "map", "/map") as reader:
            ready = reader.read()["ready"]
            got = reader.read()
            if got["cells"] != cells.size:
                raise SystemExit(f"another map came, of {got['cells']} cells")
            took = got["first"] - ready
    finally:
        transport.close()
    print(f"serialised {serialised * 1e3:.0f} ms, written {written * 1e3:.0f} ms, there after {took:.2f} s; {load()}")
    return [took]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("first", "map"))
    parser.add_argument("--distro", default="jazzy")
    parser.add_argument("--transport", default="dds")
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    measure, aim = {"first": (first, 2.0), "map": (late_map, 6.0)}[given.what]
    own_domain()
    times = [took for _ in range(given.rounds) for took in measure(given)]
    print(f"{given.what}, {given.transport}, {given.distro}: median {statistics.median(times):.2f} s, ", end="")
    print(f"longest {max(times):.2f} s (aim: {aim:g} s)")


if __name__ == "__main__":
    main()
