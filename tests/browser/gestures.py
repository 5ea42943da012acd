"""What a hand does on the page."""

from __future__ import annotations

from typing import Any

import pytest

pytestmark = pytest.mark.browser


def middle(tab: Any, name: str = "#map") -> tuple[float, float]:
    box = tab.locator(name).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def drag(tab: Any, dx: float, dy: float, name: str = "#map") -> None:
    x, y = middle(tab, name)
    tab.mouse.move(x, y)
    tab.mouse.down()
    if dx or dy:
        tab.mouse.move(x + dx, y + dy, steps=3)
    tab.mouse.up()
