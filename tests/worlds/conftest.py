"""These tests are about what is read: in this process, which is quicker. tests/guard is about the child."""

from __future__ import annotations

import pytest


@pytest.fixture(autouse=True)
def read_here(monkeypatch):
    monkeypatch.setenv("TRUNDLE_TRUSTED", "1")
