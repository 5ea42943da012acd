"""Conformance checks that every agent, planner, controller and simulator must pass, built in or third-party."""

from trundle.testing.agent import check_agent
from trundle.testing.conformance import ConformanceError
from trundle.testing.controller import check_controller
from trundle.testing.planner import check_planner
from trundle.testing.simulator import check_simulator

__all__ = ["ConformanceError", "check_agent", "check_controller", "check_planner", "check_simulator"]
