"""Fixtures of the tests of many robots."""

from support.warp_device import device  # noqa: F401 - a fixture
