"""The page in a browser: a server that shows runs to many pages, and lets one of them drive; `show` for any loop."""

from __future__ import annotations

from typing import TYPE_CHECKING

from trundle.lazy import lazy_names

if TYPE_CHECKING:
    from trundle.serve.view import View, show

__getattr__ = lazy_names(__name__, {"View": "trundle.serve.view", "show": "trundle.serve.view"})

__all__ = ["View", "show"]
