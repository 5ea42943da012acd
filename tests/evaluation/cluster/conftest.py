"""Clusters on this machine. They are started only where there is no network but loopback: `make test-ray`."""

import fcntl
import os
import socket
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

SIOCGIFFLAGS = 0x8913
IFF_UP = 0x1


@pytest.fixture(scope="session")
def loopback() -> Iterator[None]:
    """Skip where Ray would open ports for others, or is not installed."""
    names = [name for _, name in socket.if_nameindex() if _is_up(name)]
    if names != ["lo"]:
        pytest.skip(f"needs a network namespace with lo alone, not {', '.join(names)}: make test-ray")
    pytest.importorskip("ray", reason="needs Ray: make test-ray")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("RAY_NODE_IP_ADDRESS", "127.0.0.1")
        path = [str(Path(__file__).parents[2]), *os.environ.get("PYTHONPATH", "").split(os.pathsep)]
        patch.setenv("PYTHONPATH", os.pathsep.join(filter(None, path)))
        yield


def _is_up(name: str) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        answer = fcntl.ioctl(any_socket, SIOCGIFFLAGS, struct.pack("16s16x", name.encode()))
    return bool(struct.unpack_from("H", answer, 16)[0] & IFF_UP)


@pytest.fixture
def pair(loopback: None) -> Iterator[Any]:
    """A cluster of a head without CPUs and two nodes, of which one is `first`."""
    with _cluster() as made:
        made.first = made.add_node(num_cpus=1)
        made.add_node(num_cpus=1)
        yield made


@pytest.fixture(scope="module")
def single(loopback: None) -> Iterator[Any]:
    """A cluster of a head without CPUs and one node."""
    with _cluster() as made:
        made.add_node(num_cpus=1)
        yield made


@contextmanager
def _cluster() -> Iterator[Any]:
    from ray.cluster_utils import Cluster

    made = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
    try:
        yield made
    finally:
        made.shutdown()
