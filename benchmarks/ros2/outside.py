"""Whether anything leaves this machine: what the bridge sends on interfaces other than lo.

unshare --net --user --map-root-user python benchmarks/ros2/outside.py [--range localhost] [--seconds 20]

It needs a separate network namespace, so that nobody else sends there; it adds a pair of interfaces that are up.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import time
from pathlib import Path

from network import load, own_domain, served


def sent() -> dict[str, int]:
    """Packets sent so far, by interface."""
    lines = Path("/proc/net/dev").read_text(encoding="ascii").splitlines()[2:]
    return {name.strip(): int(rest.split()[9]) for name, rest in (line.split(":", 1) for line in lines)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--range", default="localhost")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--transport", default="dds")
    given = parser.parse_args()
    if "eth-bench" not in sent():
        for command in (
            "ip link set lo up",
            "ip link set lo multicast on",
            "ip link add eth-bench type veth peer name eth-other",
            "ip address add 10.99.0.1/24 dev eth-bench",
            "ip link set eth-bench up",
            "ip link set eth-other up",
        ):
            subprocess.run(command.split(), check=True)
    for path in Path("/proc/sys/net/ipv6/conf").glob("*/disable_ipv6"):  # what the kernel itself sends
        if os.access(path, os.W_OK):
            path.write_text("1", encoding="ascii")
    own_domain()
    time.sleep(2.0)
    before = sent()
    with served(given.transport, "jazzy", "--range", given.range):
        time.sleep(given.seconds)
    packets = {name: count - before[name] for name, count in sent().items()}
    others = sum(count for name, count in packets.items() if name != "lo")
    print(f"--range {given.range}: {others} packets on other interfaces than lo in {given.seconds:g} s; {packets}")
    print(load())


if __name__ == "__main__":
    main()
