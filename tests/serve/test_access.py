import pytest

from trundle.serve.access import Access, is_loopback


@pytest.mark.parametrize("host", ["127.0.0.1:8765", "localhost:9000", "[::1]:8765", "LOCALHOST:1", "127.0.0.1"])
def test_a_loopback_server_accepts_forwarded_ports_of_this_machine(host: str) -> None:
    assert Access("127.0.0.1").allows_host([host])


@pytest.mark.parametrize(
    "hosts",
    [
        [],
        ["evil.example:8765"],
        ["127.0.0.1.evil.example"],
        ["192.168.1.5:8765"],
        ["127.0.0.1:8765", "evil.example"],
        ["user@127.0.0.1"],
        ["127.0.0.1/x"],
        ["127.0.0.1:port"],
        [""],
        ["[::1"],
    ],
)
def test_other_names_are_refused_on_loopback(hosts: list[str]) -> None:
    assert not Access("127.0.0.1").allows_host(hosts)


def test_a_server_on_all_addresses_accepts_addresses_but_no_foreign_name() -> None:
    access = Access("0.0.0.0")
    assert access.allows_host(["192.168.1.5:8765"])
    assert access.allows_host(["localhost:8765"])
    assert not access.allows_host(["evil.example:8765"])


def test_a_server_on_one_address_accepts_that_one() -> None:
    access = Access("192.168.1.5")
    assert access.allows_host(["192.168.1.5:8765"])
    assert not access.allows_host(["192.168.1.6:8765"])


def test_an_origin_is_the_host_or_refused() -> None:
    access = Access("127.0.0.1")
    assert access.allows_origin(["http://localhost:9000"], "localhost:9000", required=True)
    assert access.allows_origin(["https://localhost:9000"], "localhost:9000", required=True)
    assert access.allows_origin([], "localhost:9000", required=False)
    for origin in ("http://localhost:9001", "http://evil.example", "null", "file://", "localhost:9000", ""):
        assert not access.allows_origin([origin], "localhost:9000", required=True), origin
    assert not access.allows_origin([], "localhost:9000", required=True)
    assert not access.allows_origin(["http://localhost:9000"] * 2, "localhost:9000", required=True)


def test_the_cookie_carries_the_token_under_a_name_of_this_server() -> None:
    access, other = Access("127.0.0.1"), Access("127.0.0.1")
    header = access.set_cookie()
    assert "HttpOnly" in header
    assert "SameSite=Strict" in header
    sent = header.partition(";")[0]
    assert access.has_cookie([sent])
    assert access.has_cookie([f"{other.set_cookie().partition(';')[0]}; {sent}"])
    assert not other.has_cookie([sent])
    assert not access.has_cookie([sent + "x"])
    assert not access.has_cookie(["\x00;=;;", ""])
    assert not access.has_cookie([f"{access.cookie}=ünicode"])


def test_tokens_are_long_and_new() -> None:
    first, second = Access("127.0.0.1").token, Access("127.0.0.1").token
    assert first != second
    assert len(first) >= 32


@pytest.mark.parametrize(
    ("host", "is_it"), [("localhost", True), ("127.0.0.5", True), ("::1", True), ("0.0.0.0", False)]
)
def test_is_loopback(host: str, is_it: bool) -> None:
    assert is_loopback(host) is is_it
