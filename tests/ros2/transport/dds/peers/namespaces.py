"""Nodes in two network namespaces that a cable joins, "one" and "two" here and "far" there: RANGE DOMAIN SECONDS.

Prints, as JSON, what each heard, and how many packets of IPv4 left the first namespace. Ends with 77 where there are
no such namespaces.
"""

# ruff: noqa: T201 - what it prints is for the test

from __future__ import annotations

import json
import runpy
import socket
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).parent
ONLY_LO = HERE.parents[4] / "scripts" / "only_lo.py"
NODES = ("one", "two", "far")
IPV4 = 0x0800


def main(range_: str, domain: str, seconds: str) -> None:
    second: subprocess.Popen[str] | None = None
    try:
        try:
            runpy.run_path(str(ONLY_LO))["enter"]()
            second = join_second()
        except (OSError, AttributeError, subprocess.CalledProcessError) as error:
            print(f"no two network namespaces here: {error}")
            raise SystemExit(77) from error
        inside = ["nsenter", "-t", str(second.pid), "-n"]
        packets = listen()
        running = {name: start(name, inside if name == "far" else [], range_, domain, seconds) for name in NODES}
        said = {name: process.communicate()[0].splitlines()[-1] for name, process in running.items()}
        print(json.dumps({**{name: json.loads(line) for name, line in said.items()}, "packets": count(packets)}))
    finally:
        if second is not None:
            second.kill()
            second.wait()


def start(name: str, inside: list[str], *arguments: str) -> subprocess.Popen[str]:
    others = [other for other in NODES if other != name]
    command = [*inside, sys.executable, str(HERE / "node.py"), name, *arguments, *others]
    return subprocess.Popen(command, stdout=subprocess.PIPE, text=True)


def join_second() -> subprocess.Popen[str]:
    """A process in the second namespace, with a cable between both."""
    second = subprocess.Popen(["unshare", "-n", "sleep", "600"], text=True)
    own = Path("/proc/self/ns/net").readlink()
    while Path(f"/proc/{second.pid}/ns/net").readlink() == own and second.poll() is None:
        time.sleep(0.01)
    inside = ["nsenter", "-t", str(second.pid), "-n"]
    for command in (
        ["ip", "link", "add", "near", "type", "veth", "peer", "name", "far", "netns", str(second.pid)],
        ["ip", "addr", "add", "10.99.0.1/24", "dev", "near"],
        ["ip", "link", "set", "near", "up", "multicast", "on"],
        [*inside, "ip", "addr", "add", "10.99.0.2/24", "dev", "far"],
        [*inside, "ip", "link", "set", "lo", "up"],
        [*inside, "ip", "link", "set", "far", "up", "multicast", "on"],
    ):
        subprocess.run(command, check=True, capture_output=True)
    return second


def listen() -> socket.socket:
    """Gets the packets of IPv4 on the cable, in both directions."""
    packets = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(0x0003))
    packets.bind(("near", 0))
    packets.setblocking(False)
    return packets


def count(packets: socket.socket) -> int:
    found = 0
    try:
        while frame := packets.recv(65536):
            found += int.from_bytes(frame[12:14], "big") == IPV4
    except BlockingIOError:
        return found
    return found


if __name__ == "__main__":
    main(*sys.argv[1:])
