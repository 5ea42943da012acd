"""These tests are about what is read: in this process, which is quicker. tests/guard is about the child."""

from __future__ import annotations

import pytest

from support.usd_scenes import HEAD


@pytest.fixture(autouse=True)
def read_here(monkeypatch):
    monkeypatch.setenv("TRUNDLE_TRUSTED", "1")


@pytest.fixture
def write_usd(tmp_path):
    """Writes a scene in USD's text format and returns its path."""

    def write(text: str, name: str = "scene.usda", head: str = HEAD):
        # In USD a prim ends its line; the scenes of the tests leave these line ends out.
        (tmp_path / name).write_text(head + text.replace("}", "}\n"))
        return tmp_path / name

    return write
