"""Whether commands are lost, and how long the bridge takes to be gone after Ctrl-C.

python benchmarks/ros2/commands.py lost [--distro jazzy] [--transport dds] [--seconds 600] [--rate 20]
python benchmarks/ros2/commands.py gone [--transport dds] [--rounds 5]
"""

from __future__ import annotations

import argparse
import signal
import time
from pathlib import Path

from network import join, load, own_domain, peer, served

from trundle.messages.codec import Codec
from trundle.messages.qos import Qos

TWIST = "geometry_msgs/msg/Twist"


def lost(given: argparse.Namespace) -> None:
    """Count numbered commands of a real rclpy, from when both sides know of each other."""
    codec = Codec(given.distro)
    transport = join(given.transport, given.distro)
    try:
        subscription = transport.subscription("/cmd_vel", TWIST, Qos(10))
        numbers: list[int] = []
        with peer(given.distro, "drive", given.rate, given.seconds) as driver:
            driver.read()
            end = time.monotonic() + given.seconds + 3.0
            while time.monotonic() < end:
                transport.wait(0.2)
                numbers += [round(codec.decode(TWIST, one.data).linear.y) for one in subscription.take()]
            sent = driver.read()["sent"]
    finally:
        transport.close()
    missing = sent - len(set(numbers))
    print(f"{given.transport}, {given.distro}: {sent} sent in {given.seconds:g} s, {missing} lost (aim: 0), ", end="")
    print(f"{len(numbers) - len(set(numbers))} came twice, in order: {numbers == sorted(numbers)}; {load()}")


def children(process: int) -> list[str]:
    """What a process has started."""
    return Path(f"/proc/{process}/task/{process}/children").read_text(encoding="ascii").split()


def gone(given: argparse.Namespace) -> None:
    """Time from Ctrl-C to the end of the process, in which none of its children may be left."""
    times = []
    for _ in range(given.rounds):
        with served(given.transport, given.distro) as (process, _offer):
            time.sleep(2.0)
            started = children(process.pid)
            began = time.monotonic()
            process.send_signal(signal.SIGINT)
            process.wait(timeout=30.0)
            times.append(time.monotonic() - began)
            left = [child for child in started if Path(f"/proc/{child}").exists()]
            print(f"exit code {process.returncode} after {times[-1]:.2f} s, {len(left)} children left; {load()}")
    print(f"{given.transport}: longest {max(times):.2f} s (aim: 2 s)")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("lost", "gone"))
    parser.add_argument("--distro", default="jazzy")
    parser.add_argument("--transport", default="dds")
    parser.add_argument("--seconds", type=float, default=600.0)
    parser.add_argument("--rate", type=float, default=20.0)
    parser.add_argument("--rounds", type=int, default=5)
    given = parser.parse_args()
    own_domain()
    {"lost": lost, "gone": gone}[given.what](given)


if __name__ == "__main__":
    main()
