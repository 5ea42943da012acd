"""Addresses of clusters that cannot be used are said in one message."""

import socket
import sys

import pytest

from trundle.errors import InputError, MissingExtraError
from trundle.evaluation.cluster import ClusterError
from trundle.evaluation.cluster.connection import check_reachable, connect


@pytest.mark.parametrize("address", ["", "head", "head:port", "http://head:6379", "a b:1", "head:6379/x"])
def test_what_is_no_address_is_refused(address: str) -> None:
    with pytest.raises(InputError, match=r"is no address: give auto, host:port .*ray://host:port"):
        check_reachable(address)


@pytest.mark.parametrize("form", ["127.0.0.1:{}", "ray://localhost:{}"])
def test_an_address_where_nobody_listens_is_named_with_what_to_do(form: str) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = form.format(free.getsockname()[1])
        with pytest.raises(ClusterError, match=rf"cannot reach a Ray cluster at {address}: .*ray start --head.*auto"):
            check_reachable(address)


def test_ports_that_are_none_are_refused() -> None:
    with pytest.raises(ClusterError, match="cannot reach"):
        check_reachable("127.0.0.1:99999")


def test_without_ray_the_install_line_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(MissingExtraError, match=r"Ray.*trundle\[ray\]"), connect("auto"):
        pass
