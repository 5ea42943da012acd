"""Nodes in two network namespaces that a cable joins, "one" and "two" here and "far" there: RANGE DOMAIN NAME ….

Waits until the nodes of these names have heard each other. Prints, as JSON, what each heard, and how many packets of
IPv4 left the first namespace. Ends with 77 where there are no such namespaces.
"""

# ruff: noqa: T201 - what it prints is for the test

from __future__ import annotations

import json
import runpy
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

HERE = Path(__file__).parent
ONLY_LO = HERE.parents[4] / "scripts" / "only_lo.py"
NODES = ("one", "two", "far")
IPV4 = 0x0800
PATIENCE_S = 120.0
REST_S = 2.0
"""By then what nobody is to hear would be heard."""


def main(range_: str, domain: str, *names: str) -> None:
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
        running = {name: Node(name, inside if name == "far" else [], range_, domain) for name in NODES}
        until = time.monotonic() + PATIENCE_S
        while any(not {*names} - {name} <= {*running[name].said["heard"]} for name in names):
            if time.monotonic() > until:
                break
            time.sleep(0.05)
        time.sleep(REST_S)
        said = {name: node.end() for name, node in running.items()}
        print(json.dumps({**said, "packets": count(packets)}))
    finally:
        if second is not None:
            second.kill()
            second.wait()


class Node:
    """A node in a process, and what it has said."""

    def __init__(self, name: str, inside: list[str], *arguments: str) -> None:
        others = [other for other in NODES if other != name]
        command = [*inside, sys.executable, str(HERE / "node.py"), name, *arguments, *others]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.said: dict[str, list[str]] = {"heard": [], "nodes": []}
        self._reading = threading.Thread(target=self._read)
        self._reading.start()

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            self.said = json.loads(line)

    def end(self) -> dict[str, list[str]]:
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._reading.join()
        self._process.wait()
        return self.said


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
