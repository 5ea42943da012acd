"""Checks of maps: what is wrong with one, where, and what to do about it."""

from trundle.maps.check.check import check_grid, check_map
from trundle.maps.check.finding import KINDS, PLACEMENT_KINDS, Finding, Kind, MapReport, Severity

__all__ = ["KINDS", "PLACEMENT_KINDS", "Finding", "Kind", "MapReport", "Severity", "check_grid", "check_map"]
