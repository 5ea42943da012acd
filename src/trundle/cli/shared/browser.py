"""The page in the browser, shared by `trundle serve` and the verbs with --browser."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from typing import TYPE_CHECKING

from trundle.cli.shared import output
from trundle.serve.opening import forwarding, has_screen, is_remote, make_page, open_browser, start_server

if TYPE_CHECKING:
    from trundle.mission import Scenario
    from trundle.serve.hub import Hub
    from trundle.serve.server import PageServer

CLOSED_S = 5.0
"""A page that stays away for longer than this [s] after a run was closed, not reloaded."""

_LOOK_S = 0.2
NEVER_OPENED_S = 10.0
"""How long [s] a run is shown after its end if nobody has opened the page."""


@dataclass(frozen=True, slots=True)
class ServedPage:
    """A page that is being served.

    Attributes:
        hub: What it shows.
        server: What serves it.
    """

    hub: Hub
    server: PageServer


@contextmanager
def serving(
    base: Scenario | None, *, source: str | None = None, host: str = "127.0.0.1", port: int | None = None
) -> Iterator[ServedPage]:
    """Serve the page while the block runs.

    Args:
        base: The scenario that the choices of the page change. If None, the page offers no choices.
        source: What the page begins with.
        host: What to listen on.
        port: The port; by default the usual one, or a free one where that is taken.

    Raises:
        InputError: If it cannot listen there.
    """
    from trundle.errors import InputError
    from trundle.serve.choosing import Choices
    from trundle.serve.hub import Hub

    if port is not None and not 0 <= port <= 65535:
        raise InputError(f"--port {port}: give a port from 1 to 65535, or 0 for a free one")
    hub = Hub(choices=Choices(base), source=source)
    server = start_server(hub, make_page("live"), host=host, port=port)
    with server:
        yield ServedPage(hub, server)


def announce(page: ServedPage, *, opens: bool = True, quiet: bool = False) -> None:
    """Print the address on standard error, and open it where there is a browser."""
    print(f"The page: {page.server.address}", file=sys.stderr, flush=True)
    advise(page, opens=opens, quiet=quiet)


def advise(page: ServedPage, *, opens: bool, quiet: bool) -> None:
    """Open the page where there is a browser; say how to reach it where there is none.

    Args:
        page: The page.
        opens: Whether to open it.
        quiet: Whether to print no remarks.
    """
    from trundle.serve.access import is_loopback

    host, port = page.server.host, page.server.port
    if not is_loopback(host):
        output.remark(
            f"Whoever can reach {host} and has this address can drive; the connection is not encrypted", quiet=quiet
        )
    elif is_remote():
        output.remark(
            f"On your own machine: {forwarding(port)}, then open that address there",
            quiet=quiet,
        )
    if opens and not is_remote() and not open_browser(page.server.address):
        why = "No browser was found here" if has_screen() else "There is no display here, so no browser was opened"
        output.remark(f"{why}: open that address in one", quiet=quiet)


def linger(page: ServedPage, serve: Callable[[Callable[[], bool]], None], *, quiet: bool) -> None:
    """Keep the page after a run until it is closed, or Ctrl-C; if nobody opened it, only for a short time.

    Args:
        page: The page.
        serve: Carries out what the page asks for meanwhile, until the function that it gets is true.
        quiet: Whether to print no remarks.
    """
    ended = time.monotonic()

    def is_over() -> bool:
        hub = page.hub
        if len(hub):
            return False
        if hub.joined:
            return time.monotonic() - hub.left_s > CLOSED_S
        return time.monotonic() - ended > NEVER_OPENED_S

    output.remark("The run is over; close the page, or press Ctrl-C, to end", quiet=quiet)
    with suppress(KeyboardInterrupt):
        serve(is_over)


def wait_until(is_over: Callable[[], bool]) -> None:
    """Wait until `is_over` is true: for a page that can ask for nothing more."""
    while not is_over():
        time.sleep(_LOOK_S)
