"""Stand-ins for the Python of a ROS."""

import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from trundle.ros2.transport.rclpy import child

_START = f"""#!{sys.executable}
import importlib.util, json, os, signal, socket, sys, time
spec = importlib.util.spec_from_file_location("child", {child.__file__!r})
child = importlib.util.module_from_spec(spec)
spec.loader.exec_module(child)
sock = socket.socket(fileno=int(sys.argv[2]))
frames = child.read_frames(sock)
def send(kind, number, payload):
    sock.sendall(child.HEADER.pack(len(payload), kind, number) + payload)
def hello(distro="jazzy"):
    send(child.HELLO, 0, json.dumps({{"distro": distro, "rmw": "rmw_x_cpp"}}).encode())
def answer(value=None):
    kind, number, payload = next(frames)
    send(child.REPLY, number, json.dumps({{"value": value}}).encode())
    return json.loads(payload)
"""


@pytest.fixture
def stand_in(tmp_path: Path) -> Callable[[str], str]:
    """Makes a program that is started like the Python of a ROS, and speaks the protocol as its text says."""

    def make(text: str) -> str:
        path = tmp_path / f"python{len(list(tmp_path.iterdir()))}"
        path.write_text(_START + text)
        path.chmod(0o755)
        return str(path)

    return make
