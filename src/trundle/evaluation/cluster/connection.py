"""The exception of evaluations on a cluster."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType

from trundle.errors import InputError, TrundleError
from trundle.extras import missing_extra


class ClusterError(TrundleError):
    """A cluster that cannot be reached or used, or has no nodes left."""


AUTO = "auto"
"""The address that starts a cluster on this machine."""
_LOOPBACK = "127.0.0.1"
_ADDRESS = re.compile(r"(?P<host>\[[0-9a-fA-F:]+\]|[^:/\s]+):(?P<port>\d{1,5})")
_REACH_S = 5.0


@contextmanager
def connect(address: str) -> Iterator[ModuleType]:
    """Connect Ray to a cluster for the block; disconnecting ends what runs there for this process.

    A program that is connected already keeps its connection.

    Args:
        address: `host:port` of the head of the cluster that this machine is part of; or `auto`, which starts a cluster
            on this machine that only this machine can reach.

    Raises:
        InputError: If the address is none.
        ClusterError: If the cluster cannot be reached.
        MissingExtraError: If Ray is not installed.
    """
    ray = _import_ray()
    if ray.is_initialized():
        yield ray
        return
    quiet = {"log_to_driver": False, "logging_level": "ERROR"}
    if address != AUTO:
        check_reachable(address)
        check_health(address)
    with _keeping_sigterm():
        if address == AUTO:
            _start_here(ray, quiet)
        else:
            _join(ray, address, quiet)
    try:
        yield ray
    finally:
        ray.shutdown()


def check_cluster(address: str) -> None:
    """Refuse what `connect` would, as far as a moment tells.

    Raises:
        InputError: If the address is none.
        ClusterError: If nobody listens there.
        MissingExtraError: If Ray is not installed.
    """
    _import_ray()
    if address != AUTO:
        check_reachable(address)


def _import_ray() -> ModuleType:
    try:
        import ray  # pyright: ignore[reportMissingImports] - an extra
    except ImportError as error:
        raise missing_extra("an evaluation on a cluster", "Ray", "ray") from error
    return ray


def check_reachable(address: str) -> None:
    """Try whether somebody listens at an address.

    Raises:
        InputError: If the address is none.
        ClusterError: If nobody does.
    """
    match = _ADDRESS.fullmatch(address)
    if match is None:
        raise InputError(
            f"--ray {address!r} is no address: give auto, or host:port of the head of the cluster that this machine is "
            "part of"
        )
    try:
        socket.create_connection((match["host"].strip("[]"), int(match["port"])), timeout=_REACH_S).close()
    except (OSError, OverflowError) as error:
        raise ClusterError(
            f"cannot reach a Ray cluster at {address}: {error}; start one with `ray start --head`, which prints its "
            "address, or give --ray auto to use this machine alone"
        ) from error


def check_health(address: str, timeout_s: float = 20.0) -> None:
    """Ask Ray's command whether a cluster answers: its library would wait for minutes for one that does not.

    Raises:
        ClusterError: If none does.
    """
    command = [sys.executable, "-m", "ray.scripts.scripts", "health-check", "--address", address]
    try:
        answer = subprocess.run(command, capture_output=True, timeout=timeout_s, check=False)
    except subprocess.TimeoutExpired as error:
        raise ClusterError(f"what listens at {address} did not answer as a Ray cluster in {timeout_s:g} s") from error
    if answer.returncode != 0:
        raise ClusterError(
            f"what listens at {address} is no Ray cluster of this version, or it is not well; `ray status --address "
            f"{address}` says more"
        )


@contextmanager
def _keeping_sigterm() -> Iterator[None]:
    """Keep the handler of SIGTERM: Ray, when it starts a cluster, installs one that ends the program at once."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.getsignal(signal.SIGTERM)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _join(ray: ModuleType, address: str, quiet: dict[str, object]) -> None:
    try:
        ray.init(address=address, **quiet)
    except Exception as error:
        reason = str(error).strip().splitlines() or [type(error).__name__]
        raise ClusterError(f"cannot use the Ray cluster at {address}: {reason[0]}") from error


def _start_here(ray: ModuleType, quiet: dict[str, object]) -> None:
    """Start a cluster that is bound to loopback: the address of a node comes from the environment."""
    name = "RAY_NODE_IP_ADDRESS"
    before = os.environ.get(name)
    os.environ[name] = _LOOPBACK
    try:
        ray.init(address="local", include_dashboard=False, _node_ip_address=_LOOPBACK, **quiet)
    except Exception as error:
        raise ClusterError(f"cannot start Ray on this machine: {error}") from error
    finally:
        if before is None:
            del os.environ[name]
        else:
            os.environ[name] = before
