"""Opening the page: the page itself, a server for it on a free port, and the browser of this screen."""

from __future__ import annotations

import os
import socket
import sys
import webbrowser
from typing import TYPE_CHECKING, Literal

from trundle.errors import InputError

if TYPE_CHECKING:
    from trundle.serve.hub import Hub
    from trundle.serve.server import Page, PageServer

_NOTEBOOKS = "http://localhost:* http://127.0.0.1:* vscode-webview: vscode-file:"
"""What may show the page of a view in a frame: a notebook of this machine, which knows the token."""


def make_page(mode: Literal["live", "view"]) -> Page:
    """Return the page in this mode; that of a view can be shown in a notebook, too."""
    from trundle import page
    from trundle.serve.server import Page

    framed = page.csp(ancestors=_NOTEBOOKS) if mode == "view" else None
    return Page(page.render({"mode": mode}, title="trundle"), page.csp(), framed)


def start_server(hub: Hub, page: Page, *, host: str = "127.0.0.1", port: int | None = None) -> PageServer:
    """Start a server on this port; by default on the usual one, or a free one where that is taken.

    Raises:
        InputError: If it cannot listen there.
    """
    from trundle.serve.server import PORT, PageServer

    if port is not None:
        return PageServer(hub, page, host=host, port=port)
    try:
        return PageServer(hub, page, host=host, port=PORT)
    except InputError:
        return PageServer(hub, page, host=host, port=0)


def is_remote() -> bool:
    """Return whether this is a shell by SSH, whose browser is on another machine."""
    return bool(os.environ.get("SSH_CONNECTION") or os.environ.get("SSH_TTY"))


def forwarding(port: int) -> str:
    """Return the command that forwards a port of this machine to one's own."""
    return f"ssh -L {port}:localhost:{port} {socket.gethostname()}"


def has_screen() -> bool:
    """Return whether this machine has a display, as far as the environment tells."""
    names = ("DISPLAY", "WAYLAND_DISPLAY")
    return sys.platform in ("darwin", "win32") or any(os.environ.get(name) for name in names)


def open_browser(address: str) -> bool:
    """Open an address in the browser of this screen; False if there is none.

    A browser in the terminal (lynx, w3m) is none: it cannot show the page, and would take the terminal.
    """
    if not has_screen():
        return False
    try:
        return webbrowser.open(address)
    except webbrowser.Error:
        return False
