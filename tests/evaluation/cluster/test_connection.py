"""Addresses of clusters that cannot be used are said in one message."""

import socket
import sys

import pytest

from trundle.errors import InputError, MissingExtraError
from trundle.evaluation.cluster import ClusterError
from trundle.evaluation.cluster.connection import check_health, check_reachable, connect


@pytest.mark.parametrize(
    "address", ["", "head", "head:port", "http://head:6379", "a b:1", "head:6379/x", "ray://head:10001"]
)
def test_what_is_no_address_is_refused(address: str) -> None:
    with pytest.raises(InputError, match=r"is no address: give auto, or host:port"):
        check_reachable(address)


@pytest.mark.parametrize("form", ["127.0.0.1:{}", "localhost:{}"])
def test_an_address_where_nobody_listens_is_named_with_what_to_do(form: str) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = form.format(free.getsockname()[1])
        with pytest.raises(ClusterError, match=rf"cannot reach a Ray cluster at {address}: .*ray start --head.*auto"):
            check_reachable(address)


@pytest.mark.ray
def test_what_listens_but_is_no_cluster_is_said(loopback: None) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        address = f"127.0.0.1:{other.getsockname()[1]}"
        with pytest.raises(ClusterError, match=rf"{address} did not answer as a Ray cluster in 5 s"):
            check_health(address, timeout_s=5.0)


def test_ports_that_are_none_are_refused() -> None:
    with pytest.raises(ClusterError, match="cannot reach"):
        check_reachable("127.0.0.1:99999")


def test_without_ray_the_install_line_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(MissingExtraError, match=r"Ray.*\[ray\]"), connect("auto"):
        pass
