"""`render`: the page as one HTML file, which loads nothing; `csp` is its content security policy."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping
from functools import cache
from html import escape
from importlib.resources import files
from typing import Any

from trundle.page.encoding import to_json

_ALWAYS = (
    "default-src 'none'",
    "img-src data: blob:",
    "base-uri 'none'",
    "form-action 'none'",
)


def render(boot: Mapping[str, Any], *, title: str) -> str:
    """Return the page with its style, its script and what it shows, in one file.

    Args:
        boot: What it shows: "mode" is "live", "view", "replay" or "report"; the rest depends on it.
        title: Title of the document.
    """
    # The only way out of a script element is a tag; \u003c is the same character to JSON.
    data = to_json(boot).replace("<", "\\u003c")
    meta = ""
    if boot.get("mode") not in ("live", "view"):  # of a file; a server sends it as a header
        meta = f'<meta http-equiv="Content-Security-Policy" content="{escape(csp(live=False))}">'
    return (
        '<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
        f"{meta}"
        '<meta name="viewport" content="width=device-width,initial-scale=1">'
        '<meta name="referrer" content="no-referrer"><meta name="color-scheme" content="light dark">'
        '<link rel="icon" href="data:,">'
        f"<title>{escape(title)}</title><style>{_asset('page.css')}</style></head>\n"
        f'<body><div id="app"></div><script type="application/json" id="boot">{data}</script>'
        f"<script>{_asset('page.js')}</script></body></html>\n"
    )


def csp(*, live: bool = True, ancestors: str = "'none'") -> str:
    """Return the content security policy of the page: its own script and style by hash, and no other host.

    Args:
        live: Whether a server sends the page: then it may talk to that server, and is framed by its ancestors alone.
        ancestors: Pages that may show it in a frame, as the policy's `frame-ancestors`.
    """
    parts = [*_ALWAYS, f"script-src {_hash('page.js')}", f"style-src {_hash('page.css')}"]
    if live:
        parts += ["connect-src 'self'", f"frame-ancestors {ancestors}"]
    return "; ".join(parts)


@cache
def _asset(name: str) -> str:
    return files("trundle.page").joinpath("assets", name).read_text(encoding="utf-8")


def _hash(name: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(_asset(name).encode()).digest()).decode()}'"
