"""Conformance checks that every planner, controller and simulator must pass, built in or third-party."""

from trundle.testing.conformance import ConformanceError
from trundle.testing.controller import check_controller
from trundle.testing.planner import check_planner
from trundle.testing.simulator import check_simulator

__all__ = ["ConformanceError", "check_controller", "check_planner", "check_simulator"]
