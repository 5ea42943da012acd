"""Who may connect: the token, its cookie, and the Host and Origin of a request."""

from __future__ import annotations

import hashlib
import hmac
import ipaddress
import secrets
import socket
from collections.abc import Sequence
from http.cookies import CookieError, SimpleCookie
from urllib.parse import urlsplit

LOOPBACK = frozenset({"localhost", "127.0.0.1", "::1"})


def is_loopback(host: str) -> bool:
    """Return whether a host to bind to is this machine only."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


class Access:
    """Decides on each request by its headers alone.

    A page may come through a forwarded port (`ssh -L`), so any port is accepted; the names are checked, because a
    foreign name that is made to resolve to this machine (DNS rebinding) arrives in Host.

    Args:
        host: What the server is bound to.
        token: The secret of the printed address. By default, a new one is made.
    """

    def __init__(self, host: str, token: str | None = None) -> None:
        self.token = secrets.token_urlsafe(24) if token is None else token
        # Cookies are shared by all ports of a host: each server needs its own name.
        self.cookie = f"trundle-{hashlib.sha256(self.token.encode()).hexdigest()[:12]}"
        self._names = LOOPBACK | {host.lower()}
        self._any_address = False
        if not is_loopback(host):
            own = socket.gethostname().lower()
            self._names |= {own, own.partition(".")[0], f"{own.partition('.')[0]}.local"}
            self._any_address = host in ("", "0.0.0.0", "::")

    def has_token(self, given: str) -> bool:
        """Return whether this is the token, compared in constant time."""
        return hmac.compare_digest(given.encode(), self.token.encode())

    def has_cookie(self, cookies: Sequence[str]) -> bool:
        """Return whether the Cookie headers carry the token."""
        for header in cookies:
            try:
                found = SimpleCookie(header).get(self.cookie)
            except CookieError:
                continue
            if found is not None and self.has_token(found.value):
                return True
        return False

    def set_cookie(self) -> str:
        """Return the Set-Cookie header that stands for the token from now on."""
        return f"{self.cookie}={self.token}; Path=/; HttpOnly; SameSite=Strict"

    def allows_host(self, hosts: Sequence[str]) -> bool:
        """Return whether the one Host header names this server."""
        if len(hosts) != 1:
            return False
        name = _host_name(f"//{hosts[0]}")
        if name is None:
            return False
        return name in self._names or (self._any_address and _is_address(name))

    def allows_origin(self, origins: Sequence[str], host: str, *, required: bool) -> bool:
        """Return whether the page that sends the request came from this server: its Origin is the Host.

        Args:
            origins: The Origin headers.
            host: The Host header, which was allowed.
            required: Whether there must be one: browsers send it with every WebSocket, but not with every page.
        """
        if not origins:
            return not required
        if len(origins) != 1:
            return False
        scheme, _, rest = origins[0].partition("://")
        return scheme in ("http", "https") and rest.lower() == host.lower()


def _host_name(url: str) -> str | None:
    """Return the name in `//name:port`, in lower case, or None if it is not of that form."""
    try:
        parts = urlsplit(url)
        _ = parts.port  # raises if it is no port
    except ValueError:
        return None
    if parts.path or parts.query or parts.fragment or "@" in parts.netloc:
        return None
    return parts.hostname


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True
